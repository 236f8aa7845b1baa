//! Writes the reduced parameters: table, figures, summary and interpolation table.

use super::{document, figures};
use crate::explain::StudyError;
use crate::output::{Outcome, signed_png};
use crate::reduce::compute::{Reduction, TableRequest, compute_reduction, tabulate};
use dwell_kinetostatics::Load;
use dwell_report::{Figure, TableFormat};
use dwell_scene::Scene;

/// The reduced parameters of a scene over its range, and an interpolation table if requested.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be assembled, a figure cannot be drawn or the table cannot be
/// built.
pub fn reduce(scene: &Scene, table: Option<TableRequest>) -> Result<Outcome, StudyError> {
    let reduction = compute_reduction(scene)?;
    let Reduction {
        prepared,
        curves,
        unit_loads,
        ..
    } = &reduction;
    let mut figures: Vec<Figure> = vec![figures::reduced(prepared, curves)];
    let (coefficients, note) = figures::coefficients(prepared, curves);
    figures.extend(coefficients);
    if let Some(unit_loads) = unit_loads
        && unit_loads.loads.iter().any(Load::does_work)
    {
        figures.push(figures::unit_loads(unit_loads, prepared, &curves.q));
    }
    let mut outcome = Outcome::default();
    let stem = format!("{}-reduced", scene.name);
    outcome
        .files
        .add_table(&stem, &reduction.table(), &TableFormat::ALL)?;
    for figure in &figures {
        let name = format!("{}-{}.png", scene.name, figure.name);
        outcome.files.add(name, signed_png(scene, figure)?);
    }
    outcome.summary = document::summary(&reduction, note.as_deref());
    if let Some(request) = table {
        let tabulation = tabulate(prepared, &request)?;
        outcome.summary += &tabulation.summary;
        if let Some(text) = tabulation.text {
            outcome
                .files
                .add(format!("{}.table", scene.name), text.into_bytes());
        }
    }
    Ok(outcome)
}
