//! Writes equilibria: table, figure and summary.

use super::{document, figures};
use crate::equilibria::compute::compute_equilibria;
use crate::explain::StudyError;
use crate::output::{Outcome, signed_png};
use dwell_report::TableExport as _;
use dwell_scene::Scene;

/// The equilibria of a scene: with one coordinate all of its range, with several the one that
/// Newton's method finds from the start.
///
/// # Errors
/// [`StudyError`] when a load depends on time, every position is an equilibrium, or none is found from
/// the start.
pub fn equilibria(scene: &Scene) -> Result<Outcome, StudyError> {
    let results = compute_equilibria(scene)?;
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-equilibria.{rest}", scene.name);
    outcome.files.add(name("csv"), results.table.csv()?);
    if let Some((curves, marked)) = &results.curves {
        let figure = figures::equilibria(&results.prepared, curves, &results.found, marked);
        outcome.files.add(name("png"), signed_png(scene, &figure)?);
    }
    outcome.summary = document::summary(&results.prepared, &results.found, results.interval);
    Ok(outcome)
}
