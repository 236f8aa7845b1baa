//! Writes the results along a trajectory: tables, figures, document and animation.

use super::figures::PictureSpan;
use super::{document, figures};
use crate::explain::StudyError;
use crate::output::{DistinctNames, Outcome, Picture};
use crate::progress::Progress;
use crate::trajectory::compute::{Analysis, ComputedTrajectory, RowStorage, compute_trajectory_in};
use dwell_report::{Figure, Files, TableExport as _, TableFormat};
use dwell_scene::Scene;

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
/// As [`compute_trajectory`](crate::compute_trajectory); [`StudyError::Scene`] where many rows cannot be stored.
pub fn analyse_trajectory(
    scene: &Scene,
    analysis: Analysis,
    points: Option<usize>,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    analyse_trajectory_within(scene, analysis, points, PictureSpan::default(), progress)
}

/// The same, with curves that show a part of the trajectory.
///
/// # Errors
/// As [`compute_trajectory`]; [`StudyError::Scene`] where the part is not within the trajectory.
pub fn analyse_trajectory_within(
    scene: &Scene,
    analysis: Analysis,
    points: Option<usize>,
    span: PictureSpan,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let computed = compute_trajectory_in(RowStorage::Bounded, scene, analysis, points, progress)?;
    let mut outcome = report(scene, &computed, span)?;
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
    span: PictureSpan,
) -> Result<Outcome, StudyError> {
    let (trajectory, results) = (&computed.trajectory, &computed.results);
    let analysis = trajectory.analysis.name();
    let name = |rest: &str| format!("{}-{analysis}{rest}", scene.name);
    let mut files = Files::new();
    match &results.long_rows {
        Some(long) => {
            files.add_long_table(&name(""), &long.table, &results.written, &TableFormat::ALL);
        }
        None => files.add_table(&name(""), &computed.table, &TableFormat::ALL)?,
    }
    let document = document::Document::new(scene, computed);
    files.add(name("-extrema.csv"), document.extrema_csv());
    let mut link_names = DistinctNames::default();
    for link in &results.sectioned_links {
        let of = link.file_name(scene.mechanism.body_name(link.request.body));
        let of = link_names.add(of);
        let file = |rest: &str| name(&format!("-internal-forces-{of}{rest}.csv"));
        files.add(file(""), link.table().csv()?);
        files.add(file(".envelope"), link.envelope_table().csv()?);
    }
    let (mut figures, left_out) = figures::trajectory_figures(scene, computed, span)?;
    let mut figure_names = DistinctNames::default();
    for figure in &mut figures {
        figure.name = figure_names.add(std::mem::take(&mut figure.name));
    }
    let file = |figure: &Figure| name(&format!("-{}.png", figure.name));
    let page = Some((name(".md"), document.page(&figures, &file)));
    let picture = |figure: Figure| {
        let is_main = is_main(trajectory.analysis, &figure.name);
        Picture::figure(scene, file(&figure), is_main, figure)
    };
    let mut pictures: Vec<Picture> = figures.into_iter().map(picture).collect();
    let animation = figures::animation(scene, computed)?;
    pictures.push(Picture::animation(scene, name("-mechanism.gif"), animation));
    let mut record = document.record();
    let note = left_out.map(|note| format!("  {note}\n"));
    Ok(Outcome {
        summary: document.summary(&mut record) + &note.unwrap_or_default(),
        record,
        files,
        pictures,
        page,
        ..Outcome::default()
    })
}

/// Whether a figure is drawn unless others are wanted: the mechanism, what the analysis is for, and internal forces,
/// which a scene requests one by one.
fn is_main(analysis: Analysis, figure: &str) -> bool {
    let own: &[&str] = match analysis {
        Analysis::Kinematics => &["angles", "travels"],
        Analysis::Statics | Analysis::Kinetostatics => &["actuator-forces", "reactions"],
        Analysis::FreeMotion => &["coordinates", "energies", "reactions"],
    };
    figure == "mechanism" || own.contains(&figure) || figure.starts_with("internal-forces")
}
