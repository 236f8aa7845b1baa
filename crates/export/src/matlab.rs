//! MATLAB and Octave: the cells as a file of level 5, a function that evaluates them and one that integrates.

mod functions;
mod level5;

use crate::export::Export;
use crate::identifiers::Identifiers;
use crate::machine::PartKind;
use crate::part::Column;
use functions::{evaluation, rates};
use level5::{MatFile, Matrix};

/// An export for MATLAB and Octave: names and bytes of its data and its functions. None of an exact export, which has no data.
pub fn matlab_files(export: &Export) -> Option<Vec<(String, Vec<u8>)>> {
    if export.code.is_some() {
        return None;
    }
    let name = Identifiers::new(&export.machine).prefix;
    Some(vec![
        (format!("{name}_data.mat"), data(export)),
        (format!("{name}.m"), evaluation(export, &name).into_bytes()),
        (format!("{name}_rates.m"), rates(export, &name).into_bytes()),
    ])
}

/// The names of the parts in the data.
const PARTS: [&str; 3] = ["motion", "reactions", "positions"];

/// Everything that the functions read, with units and origin.
fn data(export: &Export) -> Vec<u8> {
    let machine = &export.machine;
    let mut file = MatFile::new(&format!("dwell {}", machine.version));
    let mut text = |name: &str, value: &str| file.add(name, &Matrix::Text(value.to_owned()));
    text("title", &machine.title);
    text("scene_hash", &machine.scene_hash);
    text("dwell_version", &machine.version);
    text("coordinate", &machine.coordinate);
    text(
        "coordinate_unit",
        if machine.is_angle { "rad" } else { "m" },
    );
    text("m_unit", if machine.is_angle { "kg m2" } else { "kg" });
    let with_unit = |(name, unit): (&String, &str)| format!("{name} [{unit}]");
    let loads = machine.loads.iter().map(|load| (&load.name, load.unit));
    let loads: Vec<String> = loads.map(with_unit).collect();
    text("loads", &loads.join("; "));
    let reactions = machine.reactions.iter().map(|(name, unit)| (name, *unit));
    let reactions: Vec<String> = reactions.map(with_unit).collect();
    text("reaction_names", &reactions.join("; "));
    text("points", &machine.points.join("; "));
    let domain = machine.domain;
    file.add("domain", &row(vec![domain.from, domain.to]));
    file.add("revolutions", &row(vec![f64::from(domain.revolutions)]));
    file.add("accuracy", &row(vec![export.request.accuracy]));
    file.add("largest_error", &row(vec![export.measured.errors.max()]));
    for kind in PartKind::ALL {
        cells(export, kind, &mut file);
    }
    file.finish()
}

fn row(values: Vec<f64>) -> Matrix {
    Matrix::Numbers {
        columns: values.len(),
        values,
    }
}

/// The cells of a part.
fn cells(export: &Export, kind: PartKind, file: &mut MatFile) {
    let (part, name) = (&export.parts[kind as usize], PARTS[kind as usize]);
    // By column: its number in the cells, or zero and a constant.
    let columns = part.columns.iter().map(|(_, column)| match *column {
        Column::Tabulated(k) => ((k + 1) as f64, 0.0),
        Column::Constant(value) => (0.0, value),
    });
    let (places, constants) = columns.unzip();
    file.add(&format!("{name}_places"), &row(places));
    file.add(&format!("{name}_constants"), &row(constants));
    let index = part.index.iter().map(|&cell| f64::from(cell) + 1.0);
    file.add(&format!("{name}_index"), &row(index.collect()));
    file.add(
        &format!("{name}_bins_per_unit"),
        &row(vec![part.bins_per_unit]),
    );
    let cells = Matrix::Numbers {
        columns: part.stride(),
        values: part.cells.clone(),
    };
    file.add(&format!("{name}_cells"), &cells);
}
