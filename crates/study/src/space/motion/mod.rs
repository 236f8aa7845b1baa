//! `dwell simulate` of scenes in space.

mod problem;
mod run;
mod summary;
mod tables;

use self::problem::SpaceMotionProblem;
use self::run::Run;
use super::trajectory::{
    SpaceEvaluator, add_rows, all_columns, drawn_positions, explain_stop, figures, is_listed,
    space_page,
};
use crate::explain::StudyError;
use crate::free_motion::compute::{MotionSolver, check_times};
use crate::progress::{Progress, no_progress};
use crate::trajectory::compute::{
    Analysis, ComputedTrajectory, FreeTrajectory, Quantity, RowStorage, Trajectory,
    TrajectoryResults, TrajectorySample,
};
use crate::trajectory::document::Document;
use crate::trajectory::figures::PictureSpan;
use crate::trajectory::output::{TrajectoryOutcome, outcome_of};
use dwell_findings::RecordedEvent;
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
    let problem = SpaceMotionProblem::new(scene)?;
    let duration = problem.duration()?;
    times.map_or(Ok(()), |times| check_times(times, duration))?;
    let run = problem.run(solver, duration)?;
    let reached = run.solution.steps.last().map_or(0.0, |step| step.t);
    if let (Some(error), true) = (&run.solution.error, reached == 0.0) {
        return Err(problem.explain(error));
    }
    let samples = match times {
        None => problem.samples(&run.solution),
        Some(times) => problem.samples_at(&run, times),
    };
    let samples = samples.map_err(|e| problem.explain(&e))?;
    let (mut computed, evaluator) = problem.rows(&run, samples, progress)?;
    let second = run.second.as_ref().filter(|_| times.is_none());
    let second = second.and_then(|second| problem.samples(second).ok());
    let second = second.and_then(|samples| problem.rows(&run, samples, &no_progress).ok());
    computed.set_errors(second.as_ref().map(|(computed, _)| computed));
    let shortfall = problem.shortfall(&run, solver);
    computed.early_stop = shortfall.or(computed.early_stop);
    let size = problem.output_model.plan().size();
    let page = space_page(
        scene,
        size,
        &computed,
        (&problem.reactions, evaluator.clone()),
    );
    let positions = drawn_positions(scene, &computed, evaluator, None);
    let mut all_figures = vec![positions.figure()];
    all_figures.extend(figures(scene, None, &computed, span)?);
    let document = Document::of_file(&scene.file, problem.output_model.plan().size(), &computed);
    let pictures = (all_figures, positions.animation());
    let mut outcome = outcome_of(&scene.file, &computed, &document, pictures)?;
    outcome.run = Some(Box::new(page));
    if !run.solution.event_occurrences.is_empty() {
        let name = format!("{}-motion-events.csv", scene.name);
        outcome
            .files
            .add(name, problem.event_table(&run.solution).csv()?);
    }
    let (summary, record) = problem.summary(&run, duration);
    outcome.summary += &summary;
    outcome.record.extend(record);
    let event = |occurrence: &dwell_dynamics::EventOccurrence| RecordedEvent {
        name: problem.spec.events[occurrence.event].name.clone(),
        t: occurrence.state.t,
    };
    outcome.record.events = run.solution.event_occurrences.iter().map(event).collect();
    Ok(TrajectoryOutcome {
        outcome,
        early_stop: computed.early_stop,
    })
}

impl SpaceMotionProblem<'_> {
    /// The rows of a motion.
    fn rows(
        &self,
        run: &Run,
        samples: Vec<TrajectorySample>,
        progress: Progress<'_>,
    ) -> Result<(ComputedTrajectory<'static>, SpaceEvaluator<'_>), StudyError> {
        let (scene, model) = (self.scene, &self.output_model);
        let end = samples.last().map_or(0.0, |sample| sample.t);
        let motion = FreeTrajectory {
            samples,
            extra_columns: self.extra_columns(),
            prescribed: self.spec.laws.iter().map(Option::is_some).collect(),
            charts: Vec::new(),
        };
        let mut all = all_columns(scene, &self.reactions, (Analysis::FreeMotion, true));
        all.extend(motion.extra_columns.iter().cloned());
        // No actuator drives a coordinate that is free.
        let is_free = |i: usize| self.spec.laws[i].is_none();
        all.retain(|c| !matches!(c.quantity, Quantity::ActuatorForce(i) if is_free(i)));
        let mut trajectory = Trajectory::of_free_motion(model.plan().range().period(), motion, end);
        trajectory.method_text.clone_from(&run.method_text);
        let is_limited = scene.lists_reactions;
        let mut columns = all.clone();
        columns.retain(|c| {
            let is_extra = matches!(c.quantity, Quantity::Extra(_));
            !is_limited || is_extra || is_listed(c.quantity, &self.reactions)
        });
        let written = (0..columns.len()).collect();
        let mut results = TrajectoryResults::of_columns(all, columns, written, is_limited);
        results.keep_rows_in(RowStorage::Bounded, trajectory.points)?;
        let open = self.reactions.indeterminate.iter();
        results.indeterminate = open.map(|r| scene.reaction_name(*r)).collect();
        let mut evaluator =
            SpaceEvaluator::new(scene, (model, &self.reactions), Analysis::FreeMotion);
        let stop = add_rows(&trajectory, &mut evaluator, &mut results, progress);
        let early_stop = stop.map(|cause| explain_stop(scene, model.plan(), cause));
        let early_stop = match early_stop {
            Some(error) if results.len() == 0 => return Err(error),
            early_stop => early_stop,
        };
        results.finish_rows()?;
        results.find_extrema(model.plan().size(), &trajectory, &[evaluator.clone()], None)?;
        let computed = ComputedTrajectory {
            table: results.table(),
            early_stop,
            notes: String::new(),
            trajectory,
            results,
        };
        Ok((computed, evaluator))
    }
}
