//! The rows of a trajectory in space, and its page.

use super::columns::{all_columns, is_listed};
use super::evaluator::SpaceEvaluator;
use super::page::space_page;
use super::path::followed_scene;
use super::reactions::JointReactions;
use crate::explain::{StudyError, TableArgument, scene_error};
use crate::progress::{Progress, Step};
use crate::space::explain::{explain_loads, explain_position};
use crate::trajectory::compute::{
    Analysis, ComputedTrajectory, POSITIONS_PER_STEP, Quantity, RowEvaluator as _, RowStorage,
    StopCause, Trajectory, TrajectoryResults,
};
use dwell_geometry::space::Plan;
use dwell_kinetostatics::KinetostaticsError;
use dwell_kinetostatics::space::Model;
use dwell_page::Page;
use dwell_scene::SpaceScene;

/// The rows of a scene in space along its prescribed motion, its sweep, or the range of its only actuator, and what evaluates further
/// positions.
pub(super) fn compute<'a, 'm>(
    scene: &'a SpaceScene,
    (reactions, model): (&'m JointReactions, &'m Model),
    (analysis, points): (Analysis, Option<usize>),
    progress: Progress<'_>,
) -> Result<(ComputedTrajectory<'a>, SpaceEvaluator<'m>), StudyError>
where
    'a: 'm,
{
    let all = |_: Quantity| true;
    computed_rows(
        scene,
        (reactions, model),
        (analysis, points),
        &all,
        progress,
    )
}

/// The same with some columns alone, among which is the abscissa.
pub(crate) fn computed_rows<'a, 'm>(
    scene: &'a SpaceScene,
    (reactions, model): (&'m JointReactions, &'m Model),
    (analysis, points): (Analysis, Option<usize>),
    is_wanted: &dyn Fn(Quantity) -> bool,
    progress: Progress<'_>,
) -> Result<(ComputedTrajectory<'a>, SpaceEvaluator<'m>), StudyError>
where
    'a: 'm,
{
    let followed = followed_scene(scene, model.plan());
    let trajectory = Trajectory::new(&followed, analysis, points)?;
    trajectory.check_laws(&followed)?;
    rows_along(scene, (reactions, model), trajectory, is_wanted, progress)
}

/// The rows along a trajectory.
pub(crate) fn rows_along<'a, 'm>(
    scene: &'m SpaceScene,
    (reactions, model): (&'m JointReactions, &'m Model),
    trajectory: Trajectory<'a>,
    is_wanted: &dyn Fn(Quantity) -> bool,
    progress: Progress<'_>,
) -> Result<(ComputedTrajectory<'a>, SpaceEvaluator<'m>), StudyError> {
    let analysis = trajectory.analysis;
    let is_limited = scene.lists_reactions && analysis != Analysis::Kinematics;
    let mut all = all_columns(scene, reactions, (analysis, trajectory.is_timed()));
    all.retain(|column| is_wanted(column.quantity));
    let mut columns = all.clone();
    columns.retain(|c| !is_limited || is_listed(c.quantity, reactions));
    let written = (0..columns.len()).collect();
    let mut results = TrajectoryResults::of_columns(all, columns, written, is_limited);
    results.keep_rows_in(RowStorage::Bounded, trajectory.points)?;
    let open = reactions.indeterminate.iter();
    results.indeterminate = open.map(|r| scene.reaction_name(*r)).collect();
    let mut evaluator = SpaceEvaluator::new(scene, (model, reactions), analysis);
    let early_stop = add_rows(&trajectory, &mut evaluator, &mut results, progress)
        .map(|error| explain_stop(scene, model.plan(), error));
    let early_stop = match early_stop {
        Some(error) if results.len() == 0 => return Err(error),
        early_stop => early_stop,
    };
    results.finish_rows()?;
    let size = model.plan().size();
    results.find_extrema(size, &trajectory, &[evaluator.clone()], None)?;
    let computed = ComputedTrajectory {
        table: results.table(),
        early_stop,
        notes: String::new(),
        trajectory,
        results,
    };
    Ok((computed, evaluator))
}

/// An analysis of a scene in space along its prescribed motion, its sweep, or the range of its only actuator.
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be assembled, the scene gives no coordinates, or the first position cannot
/// be reached.
pub fn compute_trajectory_in_space<'a>(
    scene: &'a SpaceScene,
    analysis: Analysis,
    progress: Progress<'_>,
) -> Result<ComputedTrajectory<'a>, StudyError> {
    let (reactions, model) = JointReactions::new(scene)?;
    let (computed, _) = compute(scene, (&reactions, &model), (analysis, None), progress)?;
    Ok(computed)
}

/// The page of an analysis of a scene in space along its prescribed motion, its sweep, or the range of its only actuator, and why it
/// ended early, if it did.
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be assembled, the scene gives no coordinates, or the first position cannot
/// be reached.
///
/// ```
/// use dwell_study::{Analysis, no_progress, trajectory_page_in_space};
///
/// let scene = dwell_scene::SpaceScene::read("../../validation/spatial/rssr.toml")?;
/// let (page, early_stop) = trajectory_page_in_space(&scene, Analysis::Kinematics, &no_progress)?;
/// assert!(page.drawing.is_some_and(|drawing| drawing.view.is_some()) && early_stop.is_none());
/// # Ok::<(), dwell_study::StudyError>(())
/// ```
pub fn trajectory_page_in_space(
    scene: &SpaceScene,
    analysis: Analysis,
    progress: Progress<'_>,
) -> Result<(Page, Option<StudyError>), StudyError> {
    let (reactions, model) = JointReactions::new(scene)?;
    let (computed, evaluator) = compute(scene, (&reactions, &model), (analysis, None), progress)?;
    let size = model.plan().size();
    let page = space_page(scene, size, &computed, (&reactions, evaluator));
    Ok((page, computed.early_stop))
}

/// Evaluates one row after another; why it ends early, if it does.
pub(crate) fn add_rows(
    trajectory: &Trajectory<'_>,
    evaluator: &mut SpaceEvaluator<'_>,
    results: &mut TrajectoryResults,
    progress: Progress<'_>,
) -> Option<StopCause> {
    for k in 0..trajectory.points {
        let sample = trajectory.sample_at(trajectory.fraction_at(k));
        if let Err(cause) = evaluator.evaluate(&sample, trajectory.load_time(&sample)) {
            return Some(cause);
        }
        results.add_row(evaluator, &sample, (Vec::new(), evaluator.power_terms()));
        if k.is_multiple_of(POSITIONS_PER_STEP) {
            progress(Step {
                total: trajectory.progress_steps(),
                done: "positions",
            });
        }
    }
    None
}

/// The error where a trajectory cannot go on.
pub(crate) fn explain_stop(scene: &SpaceScene, plan: &Plan, cause: StopCause) -> StudyError {
    match cause {
        StopCause::NoSolution(KinetostaticsError::Position(error)) => {
            explain_position(scene, plan, &error)
        }
        StopCause::NoSolution(error) => explain_loads(scene, plan, &error),
        StopCause::OffTable { load, value } => {
            let magnitude = &scene.loads[load].magnitude;
            let argument = TableArgument::of(magnitude, |c| scene.name_of(c), |c| c.is_angle());
            match argument {
                Some(argument) => argument.error(scene, (load, value), "at one of the positions"),
                None => explain_loads(
                    scene,
                    plan,
                    &KinetostaticsError::MagnitudeNotFinite { load },
                ),
            }
        }
        // Couplings stand in scenes of the plane alone.
        StopCause::Discontinuity { .. } => {
            scene_error::<String>(scene, "the trajectory cannot go on", "", [])
        }
    }
}
