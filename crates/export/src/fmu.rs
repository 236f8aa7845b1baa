//! FMUs: the exported C with an interface of the Functional Mock-up Interface, its description and its build description. An FMU
//! is complete as source; the caller may add a binary for its platform.

mod description;
mod model;
mod reference;
mod variables;

use crate::c::c_files;
use crate::export::Export;
use crate::identifiers::Identifiers;
use crate::template::lines_for;

/// A version of the Functional Mock-up Interface.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FmiVersion {
    /// FMI 2.0.
    Two,
    /// FMI 3.0.
    Three,
}

impl FmiVersion {
    /// Its folder of binaries for Linux on x86-64.
    pub fn linux_folder(self) -> &'static str {
        match self {
            Self::Two => "linux64",
            Self::Three => "x86_64-linux",
        }
    }
}

/// The files of an FMU, by their paths in it.
#[derive(Debug, Clone, PartialEq)]
pub struct FmuFiles {
    /// The name of its model, and of its library.
    pub identifier: String,
    /// Paths and texts; sources are under `sources/`.
    pub texts: Vec<(String, String)>,
    /// The sources to be compiled, in `sources/`.
    pub sources: Vec<String>,
}

/// The files of an FMU for model exchange and co-simulation, with the text of the scene and reference results. The export must be
/// in double precision.
pub fn fmu_files(export: &Export, version: FmiVersion, scene: &str) -> FmuFiles {
    let names = Identifiers::new(&export.machine);
    let identifier = names.prefix;
    let variables = variables::variables(export);
    let interface = match version {
        FmiVersion::Two => "fmi2.c",
        FmiVersion::Three => "fmi3.c",
    };
    let mut texts = vec![(
        "modelDescription.xml".to_owned(),
        description::model_description(export, version, &identifier, &variables),
    )];
    let mut source = |name: &str, text: String| texts.push((format!("sources/{name}"), text));
    for (name, text) in c_files(export) {
        source(&name, text);
    }
    source("model.h", model::model(export, &variables));
    source(interface, interface_of(version));
    if version == FmiVersion::Three {
        let text = description::build_description(&identifier, export.code.is_some());
        source("buildDescription.xml", text);
    }
    texts.extend(reference::reference_files(export, &variables, scene));
    FmuFiles {
        sources: vec![format!("{identifier}.c"), interface.to_owned()],
        identifier,
        texts,
    }
}

/// The interface of a version, by the template of both.
fn interface_of(version: FmiVersion) -> String {
    let names = match version {
        FmiVersion::Two => ["2", "fmi2Component", "FMUstate", "fmi2Byte", "Real"],
        FmiVersion::Three => ["3", "fmi3Instance", "FMUState", "uint8_t", "Float64"],
    };
    let template = lines_for(include_str!("fmu/interface.c"), names[0]);
    let places = ["@v@", "@instance@", "@state@", "@byte@", "@double@"];
    let names = places.into_iter().zip(names);
    names.fold(template, |text, (place, name)| text.replace(place, name))
}
