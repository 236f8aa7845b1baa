//! Writes the results along a trajectory: tables, figures, document and animation.

use super::{document, figures};
use crate::explain::StudyError;
use crate::output::{Outcome, signed_gif, signed_png};
use crate::progress::{Progress, Step};
use crate::trajectory::compute::{Analysis, ComputedTrajectory, compute_trajectory};
use dwell_report::{Figure, Files, ReportError, TableExport as _, TableFormat};
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

/// Analyses a scene along its prescribed motion, its sweep, or the range of its only actuator, at
/// `points` positions (two or more) if given.
///
/// # Errors
/// As [`compute_trajectory`].
pub fn analyse_trajectory(
    scene: &Scene,
    analysis: Analysis,
    points: Option<usize>,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let computed = compute_trajectory(scene, analysis, points, progress)?;
    let mut outcome = report(scene, &computed, progress)?;
    outcome.summary += &computed.notes;
    Ok(TrajectoryOutcome {
        outcome,
        early_stop: computed.early_stop,
    })
}

/// Tables, figures and text of the results along a trajectory.
pub(crate) fn report(
    scene: &Scene,
    computed: &ComputedTrajectory<'_>,
    progress: Progress<'_>,
) -> Result<Outcome, StudyError> {
    let (trajectory, results) = (&computed.trajectory, &computed.results);
    let analysis = trajectory.analysis.name();
    let name = |rest: &str| format!("{}-{analysis}{rest}", scene.name);
    let mut files = Files::new();
    files.add_table(&name(""), &computed.table, &TableFormat::ALL)?;
    let document = document::Document::new(scene, computed);
    files.add(name("-extrema.csv"), document.extrema_csv());
    for link in &results.sectioned_links {
        let of = link.file_name(scene.mechanism.body_name(link.request.body));
        let file = |rest: &str| name(&format!("-internal-forces-{of}{rest}.csv"));
        files.add(file(""), link.table().csv()?);
        files.add(file("-envelope"), link.envelope_table().csv()?);
    }
    let (figures, left_out) = figures::trajectory_figures(scene, computed);
    let total = trajectory.progress_steps() + figures.len() + 1;
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
    let animation = figures::animation(scene, computed);
    files.add(name("-mechanism.gif"), signed_gif(scene, animation)?);
    progress(Step {
        total,
        done: "animation",
    });
    files.add(name(".md"), document.markdown(&figures, &file));
    let note = left_out.map(|note| format!("  {note}\n"));
    Ok(Outcome {
        summary: document.summary() + &note.unwrap_or_default(),
        files,
        findings: Vec::new(),
    })
}
