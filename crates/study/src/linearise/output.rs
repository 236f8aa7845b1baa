//! Writes a linearised motion: matrices, document and summary.

use super::document;
use crate::explain::StudyError;
use crate::linearise::compute::{OperatingPoint, compute_linearisation};
use crate::output::Outcome;
use dwell_report::npz;
use dwell_scene::Scene;

/// The motion of a scene linearised about a state.
///
/// # Errors
/// [`StudyError`] when no equilibrium is found, or the initial state cannot be evaluated.
pub fn linearise(scene: &Scene, point: OperatingPoint) -> Result<Outcome, StudyError> {
    let motion = compute_linearisation(scene, point)?;
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-linear.{rest}", scene.name);
    let (names, linear) = (&motion.names, &motion.linear);
    let arrays = document::arrays(names, linear, &motion.state);
    outcome.files.add(name("npz"), npz(&arrays)?);
    outcome.files.add(name("csv"), document::csv(names, linear));
    let page = document::document(names, scene, linear, &motion.state);
    outcome.files.add(name("md"), page);
    outcome.summary = document::summary(&motion);
    Ok(outcome)
}
