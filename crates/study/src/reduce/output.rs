//! Writes the reduced parameters: table, figures, summary and interpolation table.

use super::{document, figures};
use crate::explain::StudyError;
use crate::output::{Outcome, signed_png};
use crate::reduce::compute::{Reduction, TableRequest, compute_reduction, tabulate};
use dwell_report::{Figure, Files, TableFormat};
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
    if let Some(unit_loads) = unit_loads {
        figures.push(figures::unit_loads(unit_loads, prepared, &curves.q));
    }
    let mut files = Files::new();
    let stem = format!("{}-reduced", scene.name);
    files.add_table(&stem, &reduction.table(), &TableFormat::ALL)?;
    for figure in &figures {
        let name = format!("{}-{}.png", scene.name, figure.name);
        files.add(name, signed_png(scene, figure)?);
    }
    let mut summary = document::summary(&reduction, note.as_deref());
    if let Some(request) = table {
        let tabulation = tabulate(prepared, &request)?;
        summary += &tabulation.summary;
        if let Some(text) = tabulation.text {
            files.add(format!("{}.table", scene.name), text);
        }
    }
    Ok(Outcome {
        summary,
        files,
        findings: Vec::new(),
    })
}
