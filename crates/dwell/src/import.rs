//! Models of other programs.

use crate::error::Error;
use dwell_door::{Import, ImportOptions};
use std::path::Path;

/// Imports a model of another program: MJCF, URDF with the elements by which several programs close loops, SDF, ASMT, or a link of PMKS+.
/// [`Scene::parse`](crate::Scene::parse) reads the scene that it returns. Look at [`Import::losses`] first: these parts of the file are
/// not in the scene, although a motion or a force may depend on them.
///
/// # Errors
/// [`Error::Import`] if the file cannot be read, or says something that has no meaning.
///
/// ```
/// use dwell::{ImportOptions, Scene};
///
/// let import = dwell::import("../../validation/imported/m1-fourbar.xml", &ImportOptions::default())?;
/// assert_eq!(import.losses().count(), 0);
/// let four_bar = Scene::parse(&import.scene)?.assemble()?;
/// let forces = four_bar.inverse_dynamics(0.0, &[0.0], &[1.2], &[-0.7])?;
/// assert!((forces.actuator_force("q_A")? + 0.584460101605).abs() < 1e-11);
/// # Ok::<(), dwell::Error>(())
/// ```
pub fn import(path: impl AsRef<Path>, options: &ImportOptions) -> Result<Import, Error> {
    Ok(dwell_door::import(path.as_ref(), options)?)
}
