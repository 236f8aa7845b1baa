//! `dwell simulate` of scenes in space: tables, figures, page and summary.

use super::{SimulatedMotion, SpaceMotionProblem};
use crate::explain::StudyError;
use crate::free_motion::compute::{MotionProblem as _, MotionSolver};
use crate::progress::Progress;
use crate::space::trajectory::{drawn_positions, figures};
use crate::trajectory::document::Document;
use crate::trajectory::figures::PictureSpan;
use crate::trajectory::output::{TrajectoryOutcome, outcome_of};
use dwell_report::TableExport as _;
use dwell_scene::SpaceScene;

/// The free motion of a scene in space, with rows at wanted `times` (s, ascending) and at its end, or else equally spaced;
/// curves show a part of it.
///
/// # Errors
/// [`StudyError`] when the scene has no motion, or its initial state cannot be evaluated. An error later in the motion, or an
/// accuracy that is not reached, is in [`TrajectoryOutcome::early_stop`].
pub fn simulate_in_space(
    scene: &SpaceScene,
    solver: &MotionSolver,
    times: Option<&[f64]>,
    span: PictureSpan,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let problem = SpaceMotionProblem::new(scene)?.for_solver(solver);
    let simulated = problem.simulate(solver, times, progress)?;
    let page = problem.page(&simulated);
    let SimulatedMotion { run, computed } = simulated;
    let evaluators = problem.evaluators(&run.motion);
    let positions = drawn_positions(scene, &computed, evaluators, None);
    let mut all_figures = vec![positions.figure()];
    all_figures.extend(figures(scene, None, &computed, span)?);
    let document = Document::of_file(&scene.file, problem.output_model.plan().size(), &computed);
    let pictures = (all_figures, positions.animation());
    let mut outcome = outcome_of(&scene.file, &computed, &document, pictures)?;
    outcome.run = Some(Box::new(page));
    let table = problem.event_table(&run.motion);
    if !table.rows.is_empty() {
        let name = format!("{}-motion-events.csv", scene.name);
        outcome.files.add(name, table.csv()?);
    }
    let (summary, record) = problem.summary(&run, problem.duration()?);
    outcome.summary += &summary;
    outcome.record.extend(record);
    outcome.record.events = problem.recorded_events(&run);
    Ok(TrajectoryOutcome {
        outcome,
        early_stop: computed.early_stop,
    })
}
