//! The rows of a trajectory in space, and its page.

use super::columns::all_columns;
use super::evaluator::{SpaceEvaluator, state_of};
use super::page::space_page;
use super::path::followed_scene;
use super::reactions::JointReactions;
use super::requested::{reject_unknown_variables, requested};
use super::rounding::RoundingInSpace;
use crate::explain::{StudyError, TableArgument, scene_error};
use crate::progress::{Progress, Step};
use crate::space::explain::{explain_loads, explain_position};
use crate::trajectory::compute::{
    Analysis, Column, ComputedTrajectory, MotionBetweenRows, POSITIONS_PER_STEP, Quantity,
    RowEvaluator as _, RowStorage, StopCause, Trajectory, TrajectoryResults, TrajectorySample,
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
    reject_unknown_variables(scene, (reactions, model.plan()))?;
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
    let of_model = (reactions, model.plan());
    let mut all = all_columns(scene, of_model, (analysis, trajectory.is_timed()));
    all.retain(|column| is_wanted(column.quantity));
    let mut evaluators = [SpaceEvaluator::new(scene, (model, reactions), analysis)];
    let of_evaluators = (&mut evaluators[..], None);
    let computed = rows_of(
        scene,
        (reactions, model),
        (trajectory, all),
        of_evaluators,
        progress,
    )?;
    let [evaluator] = evaluators;
    Ok((computed, evaluator))
}

/// The rows of some columns along a trajectory, by the evaluators of its charts.
pub(crate) fn rows_of<'a>(
    scene: &SpaceScene,
    (reactions, model): (&JointReactions, &Model),
    (trajectory, all): (Trajectory<'a>, Vec<Column>),
    (evaluators, between): (&mut [SpaceEvaluator<'_>], Option<MotionBetweenRows<'_>>),
    progress: Progress<'_>,
) -> Result<ComputedTrajectory<'a>, StudyError> {
    let analysis = trajectory.analysis;
    let (columns, is_limited) = requested(scene, reactions, (analysis, &all));
    let written = (0..columns.len()).collect();
    let mut results = TrajectoryResults::of_columns(all, columns, written, is_limited);
    results.keep_rows_in(RowStorage::Bounded, trajectory.points)?;
    let open = reactions.indeterminate.iter();
    results.indeterminate = open.map(|r| scene.reaction_name(*r)).collect();
    let mut rounding = RoundingInSpace::new((model, reactions), (analysis, trajectory.points));
    let stop = add_rows(
        &trajectory,
        (evaluators, rounding.as_mut()),
        &mut results,
        progress,
    );
    results.rounding_error = rounding.map(|rounding| rounding.max_relative());
    let early_stop = stop.map(|stop| stop.explain(scene, model.plan()));
    let early_stop = match early_stop {
        Some(error) if results.len() == 0 => return Err(error),
        early_stop => early_stop,
    };
    results.finish_rows()?;
    let size = model.plan().size();
    results.find_extrema(size, &trajectory, evaluators, between)?;
    Ok(ComputedTrajectory {
        table: results.table(),
        early_stop,
        notes: String::new(),
        trajectory,
        results,
    })
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
    let page = space_page(scene, size, &computed, (&reactions, vec![evaluator]));
    Ok((page, computed.early_stop))
}

/// Where rows end early, and why.
pub(crate) struct RowsEnd {
    cause: StopCause,
    /// Where the last row is, or the first that cannot be evaluated.
    at: String,
}

/// Evaluates one row after another, each by the evaluator of its chart, and some for their rounding; where and why it ends early, if it does.
fn add_rows(
    trajectory: &Trajectory<'_>,
    (evaluators, mut rounding): (&mut [SpaceEvaluator<'_>], Option<&mut RoundingInSpace<'_>>),
    results: &mut TrajectoryResults,
    progress: Progress<'_>,
) -> Option<RowsEnd> {
    let mut last: Option<TrajectorySample> = None;
    for k in 0..trajectory.points {
        let sample = trajectory.sample_at(trajectory.fraction_at(k));
        let before = last.as_ref().map(|last| last.chart);
        if let Some(before) = before.filter(|before| *before != sample.chart) {
            let rotations = evaluators[before].rotations.clone();
            evaluators[sample.chart].rotations = rotations;
        }
        let evaluator = &mut evaluators[sample.chart];
        if let Err(cause) = evaluator.evaluate(&sample, trajectory.load_time(&sample)) {
            let at = match &last {
                Some(last) => format!("soon after {}", evaluator.position_of(trajectory, last)),
                None => {
                    let position = evaluator.position_of(trajectory, &sample);
                    format!("at the first position, {position}")
                }
            };
            return Some(RowsEnd { cause, at });
        }
        results.add_row(evaluator, &sample, (Vec::new(), evaluator.power_terms()));
        if let Some(rounding) = &mut rounding {
            let rest = vec![0.0; sample.q.len()];
            let at = state_of(trajectory.analysis, &sample, &rest);
            let found = (&evaluator.pose, &evaluator.results);
            rounding.add_position((k, trajectory.load_time(&sample)), at, found);
        }
        if k.is_multiple_of(POSITIONS_PER_STEP) {
            progress(Step {
                total: trajectory.progress_steps(),
                done: "positions",
            });
        }
        last = Some(sample);
    }
    None
}

impl RowsEnd {
    /// The error, in the names of the scene.
    pub(crate) fn explain(&self, scene: &SpaceScene, plan: &Plan) -> StudyError {
        match self.cause {
            StopCause::NoSolution(KinetostaticsError::Position(error)) => {
                explain_position(scene, plan, &error)
            }
            StopCause::NoSolution(error) => explain_loads(scene, plan, &error),
            StopCause::OffTable { load, value } => {
                let magnitude = &scene.loads[load].magnitude;
                let argument = TableArgument::of(magnitude, |c| scene.name_of(c), |c| c.is_angle());
                match argument {
                    Some(argument) => argument.error(scene, (load, value), &self.at),
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
}
