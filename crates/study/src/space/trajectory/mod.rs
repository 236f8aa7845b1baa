//! `dwell kinematics`, `dwell statics` and `dwell kinetostatics` of scenes in space: the same tables, extrema and pages as in the plane.

mod columns;
mod evaluator;
mod figures;
mod page;
mod path;
mod reactions;
mod totals;

pub(super) use self::columns::all_columns;
pub(super) use self::evaluator::SpaceEvaluator;
pub(super) use self::figures::{figures, is_listed};
pub(super) use self::page::space_page;
pub(super) use self::reactions::JointReactions;
use super::explain::{explain_loads, explain_position};
use super::views::SpacePositions;
use crate::explain::{StudyError, scene_error};
use crate::number_format::digits;
use crate::output::symbol;
use crate::progress::{Progress, Step};
use crate::trajectory::compute::{
    Analysis, ComputedTrajectory, POSITIONS_PER_STEP, RowEvaluator as _, RowStorage, StopCause,
    Trajectory, TrajectoryResults,
};
use crate::trajectory::document::Document;
use crate::trajectory::figures::PictureSpan;
use crate::trajectory::output::{TrajectoryOutcome, outcome_of};
use dwell_geometry::space::{ActuatorKind, Plan};
use dwell_kinetostatics::KinetostaticsError;
use dwell_scene::SpaceScene;

/// Positions from which paths are drawn.
const DRAWN_POSITIONS: usize = 241;

/// Analyses a scene in space along its prescribed motion, its sweep, or the range of its only actuator, at `points` positions
/// (two or more) if given; curves show a part of it.
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be assembled, the scene gives no coordinates, or the first position cannot
/// be reached.
pub fn analyse_in_space(
    scene: &SpaceScene,
    analysis: Analysis,
    points: Option<usize>,
    span: PictureSpan,
    progress: Progress<'_>,
) -> Result<TrajectoryOutcome, StudyError> {
    let (reactions, model) = JointReactions::new(scene)?;
    let followed = path::followed_scene(scene, model.plan());
    let trajectory = Trajectory::new(&followed, analysis, points)?;
    trajectory.check_laws(&followed)?;
    let is_limited = scene.lists_reactions && analysis != Analysis::Kinematics;
    let all = all_columns(scene, &reactions, (analysis, trajectory.is_timed()));
    let mut columns = all.clone();
    columns.retain(|c| !is_limited || is_listed(c.quantity, &reactions));
    let written = (0..columns.len()).collect();
    let mut results = TrajectoryResults::of_columns(all, columns, written, is_limited);
    results.keep_rows_in(RowStorage::Bounded, trajectory.points)?;
    let open = reactions.indeterminate.iter();
    results.indeterminate = open.map(|r| scene.reaction_name(*r)).collect();
    let mut evaluator = SpaceEvaluator::new(scene, (&model, &reactions), analysis);
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
    let actuator = computed
        .trajectory
        .swept_actuator()
        .map(|k| &scene.mechanism.actuators[k]);
    let swept = actuator.map(|a| (a.name.as_str(), matches!(a.kind, ActuatorKind::Angle(_))));
    let run = space_page(scene, size, &computed, (&reactions, evaluator.clone()));
    let positions = drawn_positions(scene, &computed, evaluator, swept);
    let mut figures = vec![positions.figure()];
    figures.extend(self::figures(scene, swept, &computed, span)?);
    let document = Document::of_file(&scene.file, size, &computed);
    let pictures = (figures, positions.animation());
    let mut outcome = outcome_of(&scene.file, &computed, &document, pictures)?;
    outcome.run = Some(Box::new(run));
    Ok(TrajectoryOutcome {
        outcome,
        early_stop: computed.early_stop,
    })
}

/// Evaluates one row after another; why it ends early, if it does.
pub(super) fn add_rows(
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
pub(super) fn explain_stop(scene: &SpaceScene, plan: &Plan, cause: StopCause) -> StudyError {
    match cause {
        StopCause::NoSolution(KinetostaticsError::Position(error)) => {
            explain_position(scene, plan, &error)
        }
        StopCause::NoSolution(error) => explain_loads(scene, plan, &error),
        StopCause::OffTable { .. } | StopCause::Discontinuity { .. } => {
            scene_error::<String>(scene, "the trajectory cannot go on", "", [])
        }
    }
}

/// The mechanism along the part of a trajectory that was reached.
pub(super) fn drawn_positions<'a>(
    scene: &'a SpaceScene,
    computed: &ComputedTrajectory<'_>,
    mut evaluator: SpaceEvaluator<'_>,
    swept: Option<(&str, bool)>,
) -> SpacePositions<'a> {
    let trajectory = &computed.trajectory;
    let last = trajectory.fraction_at(computed.results.len().saturating_sub(1));
    let mut place = |fraction: f64| {
        let sample = trajectory.sample_at(fraction);
        evaluator
            .evaluate(&sample, trajectory.load_time(&sample))
            .ok()?;
        let at = match swept {
            Some((name, true)) => format!("{} = {:.1}°", symbol(name), sample.q[0].to_degrees()),
            Some((name, false)) => format!("{} = {} m", symbol(name), digits(sample.q[0], 4)),
            None => format!("time = {} s", digits(sample.t, 4)),
        };
        Some((evaluator.placements.clone(), at.replace('-', "−")))
    };
    let intervals = DRAWN_POSITIONS - 1;
    let all: Vec<_> = (0..=intervals)
        .filter_map(|k| place(last * k as f64 / intervals as f64))
        .collect();
    let (drawn, drawn_at) = all.first().cloned().unwrap_or_default();
    SpacePositions {
        scene,
        drawn,
        drawn_at,
        all,
        provenance: trajectory.method_text.clone(),
    }
}
