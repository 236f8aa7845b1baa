//! Writes the results along a trajectory: tables, figures, document and animation.

use super::{document, figures};
use crate::explain::StudyError;
use crate::models::loaded_model;
use crate::output::{Outcome, signed_gif, signed_png};
use crate::progress::{Progress, Step};
use crate::trajectory::compute::{
    Analysis, Trajectory, TrajectoryResults, check_variables, evaluate_trajectory, selected_columns,
};
use dwell_kinetostatics::Model;
use dwell_report::TableExport as _;
use dwell_report::{Column, Figure, Files, ReportError, Table, TableFormat};
use dwell_scene::Scene;
use rayon::prelude::*;

/// The outcome of an analysis along a trajectory.
#[derive(Debug)]
pub struct TrajectoryOutcome {
    /// The results, up to where the trajectory ended.
    pub outcome: Outcome,
    /// Why it ended early, if it did.
    pub early_stop: Option<StudyError>,
}

/// Positions per progress step.
const POSITIONS_PER_STEP: usize = 500;

/// Analyses a scene along its prescribed motion, its sweep, or the range of its only actuator, at
/// `points` positions (two or more) if given.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be assembled, the scene defines no actuator
/// coordinates, a requested column does not exist, or the first position cannot be reached.
pub fn analyse_trajectory(
    scene: &Scene,
    analysis: Analysis,
    points: Option<usize>,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let model = loaded_model(scene)?;
    let notes = check_variables(scene, &model)?;
    let trajectory = Trajectory::new(scene, model.plan(), analysis, points)?;
    let mut results = evaluate_and_report(scene, &model, &trajectory, analysis, progress)?;
    results.outcome.summary += &notes;
    Ok(results)
}

/// Evaluates a scene along a trajectory, and writes tables, figures and text.
///
/// # Errors
/// [`StudyError`] where not even the first position can be reached.
pub(crate) fn evaluate_and_report(
    scene: &Scene,
    model: &Model,
    trajectory: &Trajectory<'_>,
    analysis: Analysis,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let steps = trajectory.points.div_ceil(POSITIONS_PER_STEP);
    let on_position = |k: usize| {
        if k.is_multiple_of(POSITIONS_PER_STEP) {
            progress(Step {
                total: steps + 1,
                done: "positions",
            });
        }
    };
    let results = evaluate_trajectory(scene, model, trajectory, analysis, &on_position)?;
    let early_stop = results.early_stop.as_ref();
    let early_stop = early_stop.map(|stop| stop.explain(scene, model.plan(), trajectory));
    let selected = selected_columns(scene, &results.columns);
    let name = |rest: &str| format!("{}-{}{rest}", scene.name, analysis.name());
    let mut files = Files::new();
    files.add_table(&name(""), &table(&results, &selected), &TableFormat::ALL)?;
    let document = document::Document::new(scene, &results, trajectory, analysis, &selected);
    files.add(name("-extrema.csv"), document.extrema_csv());
    for link in &results.sectioned_links {
        let of = link.file_name(scene.mechanism.body_name(link.request.body));
        let file = |rest: &str| name(&format!("-internal-forces-{of}{rest}.csv"));
        files.add(file(""), link.table().csv()?);
        files.add(file("-envelope"), link.envelope_table().csv()?);
    }
    let (figures, left_out) = figures::trajectory_figures(scene, &results, trajectory, analysis);
    let total = steps + figures.len() + 1;
    let file = |figure: &Figure| name(&format!("-{}.png", figure.name));
    let drawn = figures.par_iter().map(|figure| {
        let bytes = signed_png(scene, figure)?;
        progress(Step {
            total,
            done: &figure.name,
        });
        Ok((file(figure), bytes))
    });
    for (path, bytes) in drawn.collect::<Result<Vec<_>, ReportError>>()? {
        files.add(path, bytes);
    }
    let animation = figures::animation(scene, &results, trajectory);
    files.add(name("-mechanism.gif"), signed_gif(scene, animation)?);
    progress(Step {
        total,
        done: "animation",
    });
    files.add(name(".md"), document.markdown(&figures, &file));
    let note = left_out.map(|note| format!("  {note}\n"));
    let outcome = Outcome {
        summary: document.summary() + &note.unwrap_or_default(),
        files,
        findings: Vec::new(),
    };
    Ok(TrajectoryOutcome {
        outcome,
        early_stop,
    })
}

/// The selected columns as a table.
fn table(results: &TrajectoryResults, selected: &[usize]) -> Table {
    let column = |&k: &usize| {
        let column = &results.columns[k];
        Column::new(column.name.clone(), column.unit)
    };
    let row = |row: &Vec<f64>| selected.iter().map(|&k| row[k]).collect();
    Table {
        columns: selected.iter().map(column).collect(),
        rows: results.rows.iter().map(row).collect(),
    }
}
