//! Models of other programs as scenes: MJCF, URDF with the elements by which several programs close loops, SDF, ASMT, and links of PMKS+.
//!
//! A reader of each format makes one model of bodies and joints; it is settled, and written as a commented scene, drawn in one frame: that of
//! the ground, in the pose of the file. Every element and attribute is read, or named with its line and with what leaving it out means.
//! Files are only read below the folder of the model; external entities of XML never are.
//!
//! ```
//! use dwell_door::{ImportOptions, import_text};
//!
//! let pendulum = r#"<mujoco><worldbody><body name="bob"><joint name="A" axis="0 1 0"/>
//!   <inertial pos="0 0 -1" mass="2" diaginertia="0.1 0.1 0.1"/></body></worldbody></mujoco>"#;
//! let options = ImportOptions { drives: vec!["A".to_owned()], ..ImportOptions::default() };
//! let import = import_text("pendulum.xml", pendulum, &options)?;
//! assert!(import.scene.contains("[bodies.bob]"));
//! assert_eq!(import.coverage.all, import.coverage.read + import.coverage.named);
//! # Ok::<(), dwell_door::DoorError>(())
//! ```

mod asmt;
mod error;
mod finding;
mod mjcf;
mod mobility;
mod model;
mod names;
mod options;
mod plane;
mod pmks;
mod pose;
mod robot;
mod scene;
mod settle;
mod source;
mod xml;

pub use error::{DoorError, Part};
pub use finding::{Effect, Finding};
pub use options::{Closing, Format, ImportOptions};
pub use xml::Coverage;

use sha2::{Digest as _, Sha256};
use std::path::Path;

/// An imported model.
#[derive(Debug, Clone)]
pub struct Import {
    /// The scene: TOML, with all findings as comments.
    pub scene: String,
    /// What became of the parts of the file, by their lines.
    pub findings: Vec<Finding>,
    /// The axes x, y and normal of a planar scene in those of the file.
    pub plane: Option<[[f64; 3]; 3]>,
    /// How many elements and attributes were read, and how many named.
    pub coverage: Coverage,
}

impl Import {
    /// The findings of parts that are left out although a motion or a force may depend on them.
    pub fn losses(&self) -> impl Iterator<Item = &Finding> {
        self.findings
            .iter()
            .filter(|one| one.effect == Effect::Changes)
    }
}

/// Imports a file, with the files that it includes from its own folder.
///
/// # Errors
/// [`DoorError`] if a file cannot be read, or has no meaning; with the place in the file.
pub fn import(path: &Path, options: &ImportOptions) -> Result<Import, DoorError> {
    let name = path.display().to_string();
    let text = source::read(path, &name)?;
    let folder = path.parent().unwrap_or(Path::new(""));
    source::import(&name, &text, options, Some(folder))
}

/// Imports a text; files that it includes are not read.
///
/// # Errors
/// [`DoorError`] if the text has no meaning; with the place in it.
pub fn import_text(name: &str, text: &str, options: &ImportOptions) -> Result<Import, DoorError> {
    source::import(name, text, options, None)
}

/// The comments at the head of a scene.
fn head(name: &str, text: &str, import: &Import, renamed: &[[String; 2]]) -> String {
    let hash = Sha256::digest(text.as_bytes());
    let hash: String = hash.iter().map(|byte| format!("{byte:02x}")).collect();
    let drawn =
        "Drawn in the frame of the ground, in m, kg, s and rad. A coordinate is 0 as drawn.";
    let mut lines = vec![format!("Imported from {name}"), format!("SHA-256 {hash}")];
    lines.push(drawn.to_owned());
    if let Some([x, y, normal]) = import.plane {
        let axes = format!("x is {x:?} of the file, y is {y:?}, the normal {normal:?}");
        lines.push(format!("Planar: {axes}."));
    }
    for [old, new] in renamed {
        lines.push(format!("renamed: {old} is {new}"));
    }
    lines.extend(import.findings.iter().map(ToString::to_string));
    let lines: Vec<String> = lines.iter().map(|line| scene::comment(line)).collect();
    lines.join("\n")
}
