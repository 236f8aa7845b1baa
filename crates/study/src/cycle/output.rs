//! Writes a steady cycle: tables, figure and summary.

use super::{document, figures};
use crate::cycle::compute::compute_cycle;
use crate::explain::StudyError;
use crate::models::SolverSettings;
use crate::output::{Outcome, signed_png};
use dwell_report::TableFormat;
use dwell_scene::Scene;

/// The steady cycle of a scene, and the flywheel for a target coefficient of speed fluctuation if given.
///
/// # Errors
/// [`StudyError`] when the free coordinate does not rotate fully, a load depends on time, or no steady cycle is found.
pub fn cycle(
    scene: &Scene,
    settings: &SolverSettings,
    fluctuation: Option<f64>,
) -> Result<Outcome, StudyError> {
    let results = compute_cycle(scene, settings, fluctuation)?;
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-cycle{rest}", scene.name);
    let files = &mut outcome.files;
    files.add_table(&name(""), &results.samples, &TableFormat::ALL)?;
    files.add_table(&name("-work"), &results.works, &[TableFormat::Csv])?;
    if let Some(samples) = &results.flywheel_samples {
        files.add_table(&name("-flywheel"), samples, &TableFormat::ALL)?;
    }
    let figure = figures::cycle(&results, settings);
    outcome.files.add(name(".png"), signed_png(scene, &figure)?);
    outcome.summary = document::summary(&results.prepared, &results.steady);
    if let Some((target, flywheel)) = &results.flywheel {
        outcome.summary += &document::flywheel_text(&results.prepared, *target, flywheel);
    }
    Ok(outcome)
}
