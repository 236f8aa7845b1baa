//! Writes the results along a trajectory: tables, figures, document and animation.

use super::figures::PictureSpan;
use super::{document, figures};
use crate::explain::StudyError;
use crate::output::{DistinctNames, Outcome, Picture};
use crate::page::plane_page;
use crate::trajectory::compute::{Analysis, ComputedTrajectory};
use dwell_report::{Animation, Figure, Files, TableExport as _, TableFormat};
use dwell_scene::{PlaneScene, SceneFile};

/// The outcome of an analysis along a trajectory.
#[derive(Debug)]
pub struct TrajectoryOutcome {
    /// The results, up to where the trajectory ended.
    pub outcome: Outcome,
    /// Why it ended early, if it did.
    pub early_stop: Option<StudyError>,
}

impl From<Outcome> for TrajectoryOutcome {
    fn from(outcome: Outcome) -> Self {
        let early_stop = None;
        Self {
            outcome,
            early_stop,
        }
    }
}

/// Tables, figures and text of the results along a trajectory.
pub(crate) fn report(
    scene: &PlaneScene,
    computed: &ComputedTrajectory<'_>,
    span: PictureSpan,
) -> Result<Outcome, StudyError> {
    let results = &computed.results;
    let analysis = computed.trajectory.analysis.name();
    let name = |rest: &str| format!("{}-{analysis}{rest}", scene.name);
    let mut files = Files::new();
    let mut link_names = DistinctNames::default();
    for link in &results.sectioned_links {
        let link_name = link.file_name(scene.mechanism.body_name(link.request.body));
        let stem = link_names.add(link_name);
        let file = |rest: &str| name(&format!("-internal-forces-{stem}{rest}.csv"));
        files.add(file(""), link.table().csv()?);
        files.add(file(".envelope"), link.envelope_table().csv()?);
    }
    let (figures, left_out) = figures::trajectory_figures(scene, computed, span)?;
    let animation = figures::animation(scene, computed)?;
    let document = document::Document::new(scene, computed);
    let mut outcome = outcome_of(&scene.file, computed, &document, figures, animation)?;
    outcome.run = Some(Box::new(plane_page(scene, computed)));
    outcome.files.extend("", files);
    outcome.summary += &left_out.map_or_else(String::new, |note| format!("  {note}\n"));
    Ok(outcome)
}

/// The tables of a trajectory in the plane or in space, its figures with its animation, its page and its numbers.
///
/// # Errors
/// [`StudyError::Report`] where a table cannot be written.
pub(crate) fn outcome_of(
    scene: &SceneFile,
    computed: &ComputedTrajectory<'_>,
    document: &document::Document<'_>,
    mut figures: Vec<Figure>,
    animation: Animation,
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
    files.add(name("-extrema.csv"), document.extrema_csv());
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
    pictures.push(Picture::animation(scene, name("-mechanism.gif"), animation));
    let mut record = document.record();
    Ok(Outcome {
        summary: document.summary(&mut record),
        record,
        files,
        pictures,
        page,
        ..Outcome::default()
    })
}

/// Whether a figure is drawn by default: the mechanism, the main results of the analysis, and internal forces, which a
/// scene requests one by one.
fn is_main(analysis: Analysis, figure: &str) -> bool {
    let own: &[&str] = match analysis {
        Analysis::Kinematics => &["angles", "travels", "rotations"],
        Analysis::Statics | Analysis::Kinetostatics => &["actuator-forces", "reactions"],
        Analysis::FreeMotion => &["coordinates", "energies", "reactions"],
    };
    figure == "mechanism" || own.contains(&figure) || figure.starts_with("internal-forces")
}
