//! The rows of a trajectory in space, and its page.

use super::columns::all_columns;
use super::evaluator::SpaceEvaluator;
use super::reactions::JointReactions;
use super::requested::{reject_unknown_variables, requested};
use super::rounding::RoundingInSpace;
use crate::explain::{NamedScene as _, StudyError, off_table_error, scene_error};
use crate::progress::Progress;
use crate::space::explain::{explain_loads, explain_position};
use crate::space::prepared::range_limits;
use crate::trajectory::compute::{
    Analysis, Column, ComputedTrajectory, FollowedScene, MotionBetweenRows, Quantity,
    RowEvaluator as _, RowStorage, StopCause, Trajectory, TrajectoryResults, TrajectorySample,
};
use dwell_geometry::space::{Coordinate, Plan};
use dwell_kinetostatics::KinetostaticsError;
use dwell_kinetostatics::space::Model;
use dwell_scene::SpaceScene;

/// Some columns of a scene in space along its prescribed motion, its sweep, or the range of its only actuator, among which is the
/// abscissa; and what evaluates further positions.
pub(crate) fn computed_rows<'a, 'm>(
    scene: &'a SpaceScene,
    of_model: (&'m JointReactions, &'m Model),
    (analysis, points): (Analysis, Option<usize>),
    is_wanted: &dyn Fn(Quantity) -> bool,
    progress: Progress<'_>,
) -> Result<(ComputedTrajectory<'a>, SpaceEvaluator<'m>), StudyError>
where
    'a: 'm,
{
    let plan = of_model.1.plan();
    reject_unknown_variables(scene, (of_model.0, plan))?;
    let followed = followed_scene(scene, plan);
    let trajectory = Trajectory::new(&followed, analysis, points)?;
    trajectory.check_laws(&followed)?;
    rows_along(scene, of_model, trajectory, is_wanted, progress)
}

/// What gives the coordinates that an analysis of a scene follows.
fn followed_scene<'a>(scene: &'a SpaceScene, plan: &Plan) -> FollowedScene<'a> {
    let actuators = 0..plan.actuators();
    let is_only = actuators.len() == 1;
    FollowedScene {
        file: &scene.file,
        prescribed: scene.prescribed.as_ref(),
        sweep: scene.sweep.as_ref(),
        coordinates: actuators.filter_map(|i| scene.actuator(i)).collect(),
        start: scene.assembly.q.clone(),
        period: plan.range().period(),
        default_limits: is_only.then(|| range_limits(scene, plan)),
    }
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
    let rounding = RoundingInSpace::new((model, reactions), (analysis, trajectory.points));
    let of = (&mut evaluators[..], rounding);
    let computed = computed_columns(scene, of_model, (trajectory, all), of, None, progress)?;
    let [evaluator] = evaluators;
    Ok((computed, evaluator))
}

/// The rows of those of all columns along a trajectory that a scene requests, each by the evaluator of its chart; some positions are
/// evaluated again for their rounding.
pub(crate) fn computed_columns<'a>(
    scene: &SpaceScene,
    (reactions, plan): (&JointReactions, &Plan),
    (trajectory, all): (Trajectory<'a>, Vec<Column>),
    (evaluators, mut rounding): (&mut [SpaceEvaluator<'_>], Option<RoundingInSpace<'_>>),
    between: Option<MotionBetweenRows<'_>>,
    progress: Progress<'_>,
) -> Result<ComputedTrajectory<'a>, StudyError> {
    let (columns, is_limited) = requested(scene, reactions, (trajectory.analysis, &all));
    let written = (0..columns.len()).collect();
    let mut results = TrajectoryResults::of_columns(all, columns, written, is_limited);
    results.keep_rows_in(RowStorage::Bounded, trajectory.points)?;
    let open = reactions.indeterminate.iter();
    results.indeterminate = open.map(|r| scene.reaction_name(*r)).collect();
    let of = (&mut *evaluators, rounding.as_mut());
    let stop = add_rows(&trajectory, of, &mut results, progress);
    results.rounding_error = rounding.map(|rounding| rounding.max_relative());
    let early_stop = stop.map(|(cause, at)| explain_end(scene, plan, cause, &at));
    let of = (plan.size(), &*evaluators);
    let early_stop = results.finish(&trajectory, early_stop, of, between)?;
    Ok(ComputedTrajectory {
        table: results.table(),
        early_stop,
        notes: String::new(),
        trajectory,
        results,
    })
}

/// Evaluates one row after another, each by the evaluator of its chart, and some for their rounding. Why it ends early, if it does, and
/// where the last row is, or the first that cannot be evaluated.
fn add_rows(
    trajectory: &Trajectory<'_>,
    (evaluators, mut rounding): (&mut [SpaceEvaluator<'_>], Option<&mut RoundingInSpace<'_>>),
    results: &mut TrajectoryResults,
    progress: Progress<'_>,
) -> Option<(StopCause, String)> {
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
            return Some((cause, at));
        }
        results.add_row(evaluator, &sample, (Vec::new(), evaluator.power_terms()));
        if let Some(rounding) = &mut rounding {
            let rest = vec![0.0; sample.q.len()];
            let at = sample.state(trajectory.analysis, &rest);
            let found = (&evaluator.pose, &evaluator.results);
            rounding.add_position((k, trajectory.load_time(&sample)), at, found);
        }
        trajectory.report(k, progress);
        last = Some(sample);
    }
    None
}

/// The error of rows that end early, in the names of the scene.
fn explain_end(scene: &SpaceScene, plan: &Plan, cause: StopCause, at: &str) -> StudyError {
    match cause {
        StopCause::NoSolution(KinetostaticsError::Position(error)) => {
            explain_position(scene, plan, &error)
        }
        StopCause::NoSolution(error) => explain_loads(scene, plan, &error),
        StopCause::OffTable { load, value } => {
            let magnitude = &scene.loads[load].magnitude;
            let coordinates = (|c| scene.name_of(c), |c: Coordinate| c.is_angle());
            off_table_error(scene, magnitude, coordinates, (load, value), at).unwrap_or_else(|| {
                let error = KinetostaticsError::MagnitudeNotFinite { load };
                explain_loads(scene, plan, &error)
            })
        }
        // Couplings stand in scenes of the plane alone.
        StopCause::Discontinuity { .. } => {
            scene_error::<String>(scene, "the trajectory cannot go on", "", [])
        }
    }
}
