//! The free motion of scenes in space: its rows, what is said of it, and its page.

mod between_rows;
mod change_points;
#[cfg(feature = "output")]
mod output;
mod problem;
mod run;
mod summary;
mod tables;

#[cfg(feature = "output")]
pub use self::output::simulate_in_space;

use self::between_rows::MotionSampler;
pub(super) use self::problem::SpaceMotionProblem;
pub(super) use self::run::Run;
use super::trajectory::{
    SpaceEvaluator, add_rows, all_columns, explain_stop, is_listed, space_page,
};
use crate::explain::StudyError;
use crate::free_motion::compute::{MotionSolver, check_times};
use crate::progress::{Progress, no_progress};
use crate::trajectory::compute::{
    Analysis, ComputedTrajectory, FreeTrajectory, MotionBetweenRows, Quantity, RowStorage, Sampler,
    SecondRows, Trajectory, TrajectoryResults, TrajectorySample,
};
use dwell_dynamics::Orbit;
use dwell_findings::RecordedEvent;
use dwell_page::Page;
use dwell_scene::SpaceScene;

/// A free motion in space, up to where it ended.
pub struct FreeMotionInSpace {
    /// Coordinates, energies and forces at the samples, and why the motion ended early or misses the required accuracy.
    pub computed: ComputedTrajectory<'static>,
    /// By event that happened: its time, s, and its name.
    pub events: Vec<(f64, String)>,
    /// The estimated error, in the sense of [`MotionSolver::Accuracy`], where an accuracy was required.
    pub estimated_error: Option<f64>,
}

/// The free motion of a scene in space.
///
/// # Errors
/// [`StudyError`] when the scene has no motion, or its initial state cannot be evaluated. What ends it later is in
/// [`ComputedTrajectory::early_stop`].
pub fn compute_free_motion_in_space(
    scene: &SpaceScene,
    solver: &MotionSolver,
    progress: Progress<'_>,
) -> Result<FreeMotionInSpace, StudyError> {
    let problem = SpaceMotionProblem::new(scene)?.for_solver(solver);
    let (run, computed, _) = problem.simulate(solver, None, progress)?;
    let events = problem.recorded_events(&run).into_iter();
    let errors = run.accuracy.and_then(|_| problem.errors(&run));
    Ok(FreeMotionInSpace {
        computed,
        events: events.map(|event| (event.t, event.name)).collect(),
        estimated_error: errors.map(|errors| errors.largest),
    })
}

/// The orbit of the conservative free motion of one coordinate of a scene in space: its period and its energy.
///
/// # Errors
/// [`StudyError`] when the scene has no motion, or it is not conservative.
pub fn compute_period_in_space(scene: &SpaceScene) -> Result<Orbit, StudyError> {
    let problem = SpaceMotionProblem::new(scene)?;
    problem.orbit(1.0).map_err(|error| problem.explain(&error))
}

/// The free motion of a scene in space as a page, and why it ended early or misses the required accuracy.
///
/// # Errors
/// [`StudyError`] when the scene has no motion, or its initial state cannot be evaluated.
///
/// ```
/// use dwell_study::{MotionSolver, SolverSettings, free_motion_page_in_space, no_progress};
///
/// let text = r#"
/// bodies.ground.points = { O = [0, 0, 0] }
/// bodies.bob = { points = { O = [0, 0, 0] }, mass = 2.0, center = [0.5, 0, 0] }
/// joints.O = { revolute = ["ground.O", "bob.O"], axis = [0, 1, 0] }
/// actuators.phi = { angle = "O" }
/// assembly.phi = 0.0
/// loads.weight = { gravity = [0, 0, -9.81] }
/// motion.duration = 1.0
/// "#;
/// let scene = dwell_scene::SpaceScene::parse("pendulum.toml", text)?;
/// let solver = MotionSolver::Settings(SolverSettings::default());
/// let (page, early_stop) = free_motion_page_in_space(&scene, &solver, &no_progress)?;
/// assert!(page.drawing.is_some() && early_stop.is_none());
/// # Ok::<(), dwell_study::StudyError>(())
/// ```
pub fn free_motion_page_in_space(
    scene: &SpaceScene,
    solver: &MotionSolver,
    progress: Progress<'_>,
) -> Result<(Page, Option<StudyError>), StudyError> {
    let problem = SpaceMotionProblem::new(scene)?.for_solver(solver);
    let (run, computed, evaluator) = problem.simulate(solver, None, progress)?;
    let mut page = problem.page(&computed, evaluator);
    let (summary, record) = problem.summary(&run, problem.duration()?);
    page.printed = summary;
    page.numbers = record.numbers;
    page.events = problem.recorded_events(&run);
    Ok((page, computed.early_stop))
}

impl SpaceMotionProblem<'_> {
    /// The motion by a solver, with rows at wanted `times` (s, ascending) and at its end, or else equally spaced, their errors, and
    /// what evaluates further ones.
    pub(super) fn simulate(
        &self,
        solver: &MotionSolver,
        times: Option<&[f64]>,
        progress: Progress<'_>,
    ) -> Result<(Run, ComputedTrajectory<'static>, SpaceEvaluator<'_>), StudyError> {
        let duration = self.duration()?;
        times.map_or(Ok(()), |times| check_times(times, duration))?;
        let run = self.run(solver, duration)?;
        let reached = run.solution.steps.last().map_or(0.0, |step| step.t);
        if let (Some(error), true) = (&run.solution.error, reached == 0.0) {
            return Err(self.explain(error));
        }
        let samples = match times {
            None => self.samples(&run.solution),
            Some(times) => self.samples_at(&run, times),
        };
        let samples = samples.map_err(|e| self.explain(&e))?;
        let sampler = || -> Sampler<'_> {
            let mut sampler = MotionSampler::new(self, &run);
            Box::new(move |t, precision| sampler.sample_at(t, precision))
        };
        let between = self
            .steps_as_samples(&run)
            .map(|further| MotionBetweenRows {
                further,
                sampler: &sampler,
            });
        let (mut computed, evaluator) = self.rows(&run, samples, between, progress)?;
        let second = run.second.as_ref().filter(|_| times.is_none());
        let second = second.and_then(|second| self.samples(second).ok());
        let second = second.and_then(|samples| self.rows(&run, samples, None, &no_progress).ok());
        let second = second.map(|(computed, _)| SecondRows::of(computed));
        computed.set_errors(second.as_ref());
        let shortfall = self.shortfall(&run, solver);
        computed.early_stop = shortfall.or(computed.early_stop);
        Ok((run, computed, evaluator))
    }

    /// The rows and the mechanism in them.
    fn page(&self, computed: &ComputedTrajectory<'_>, evaluator: SpaceEvaluator<'_>) -> Page {
        let size = self.output_model.plan().size();
        space_page(self.scene, size, computed, (&self.reactions, evaluator))
    }

    /// The events that happened, with their times.
    fn recorded_events(&self, run: &Run) -> Vec<RecordedEvent> {
        let event = |occurrence: &dwell_dynamics::EventOccurrence| RecordedEvent {
            name: self.spec.events[occurrence.event].name.clone(),
            t: occurrence.state.t,
        };
        let contacts = self.contacts();
        let changes = contacts.occurrences(0, &run.solution).into_iter();
        let changes = changes.map(|change| RecordedEvent {
            name: contacts.name(change.number),
            t: change.state.t,
        });
        let own = run.solution.event_occurrences.iter().map(event);
        let mut all: Vec<_> = own.chain(changes).collect();
        all.sort_by(|one, other| one.t.total_cmp(&other.t));
        all
    }

    /// The rows of a motion.
    fn rows(
        &self,
        run: &Run,
        samples: Vec<TrajectorySample>,
        between: Option<MotionBetweenRows<'_>>,
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
        let evaluators = [evaluator.clone()];
        results.find_extrema(model.plan().size(), &trajectory, &evaluators, between)?;
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
