//! The free motion of scenes in space: its rows, what is said of it, and its page.

mod between_rows;
mod change_points;
mod charts;
mod problem;
mod run;
mod summary;
mod tables;

use self::between_rows::MotionSampler;
use self::charts::Motion;
pub(super) use self::problem::SpaceMotionProblem;
pub(super) use self::run::Run;
use super::trajectory::{
    SpaceEvaluator, all_columns, computed_columns, reject_unknown_variables, space_page,
};
use crate::explain::StudyError;
use crate::free_motion::compute::{
    MotionProblem as _, MotionSolver, check_times, free_trajectory, named_events,
};
use crate::progress::{Progress, no_progress};
use crate::trajectory::compute::{
    Analysis, ComputedTrajectory, MotionBetweenRows, Quantity, Sampler, SecondRows,
    TrajectorySample, extra_columns,
};
use dwell_findings::RecordedEvent;
use dwell_page::Page;

/// A motion and its rows.
pub(super) struct SimulatedMotion {
    pub(super) run: Run,
    pub(super) computed: ComputedTrajectory<'static>,
}

impl SpaceMotionProblem<'_> {
    /// The motion by a solver, with rows at wanted `times` (s, ascending) and at its end, or else equally spaced, their errors, and
    /// what evaluates further ones.
    pub(super) fn simulate(
        &self,
        solver: &MotionSolver,
        times: Option<&[f64]>,
        progress: Progress<'_>,
    ) -> Result<SimulatedMotion, StudyError> {
        reject_unknown_variables(self.scene(), (&self.reactions, self.output_model.plan()))?;
        let duration = self.duration()?;
        times.map_or(Ok(()), |times| check_times(times, duration))?;
        let mut run = self.run(solver, duration)?;
        if let (Some(error), true) = (run.motion.explained_error(self), run.motion.end() == 0.0) {
            return Err(error);
        }
        let samples = match times {
            None => self.samples(&run.motion),
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
        let (motion, text) = (&run.motion, &run.method_text);
        let mut computed = self.rows((motion, text), samples, between, progress)?;
        let whole = |second: &&Motion| times.is_none() && second.error().is_none();
        let second = run.second.as_ref().filter(whole);
        let second = second.and_then(|motion| {
            let samples = self.samples(motion).ok()?;
            self.rows((motion, text), samples, None, &no_progress).ok()
        });
        computed.set_errors(second.map(SecondRows::of).as_ref());
        if let Some(end) = computed.end_of_rows() {
            let second = run.second.as_mut();
            second
                .into_iter()
                .chain([&mut run.motion])
                .for_each(|motion| motion.end_at(end));
        }
        let shortfall = self.shortfall(&run, solver);
        computed.early_stop = computed.early_stop.or(shortfall);
        Ok(SimulatedMotion { run, computed })
    }

    /// What evaluates the samples of a motion, by chart.
    pub(in crate::space) fn evaluators<'p>(
        &'p self,
        motion: &'p Motion,
    ) -> Vec<SpaceEvaluator<'p>> {
        let all = (0..=motion.charts.len()).map(|chart| {
            let problem = motion.problem(self, chart);
            let model = (&problem.output_model, &self.reactions);
            SpaceEvaluator::new(problem.scene(), model, Analysis::FreeMotion)
        });
        all.collect()
    }

    /// The rows and the mechanism in them.
    pub(in crate::space) fn page(&self, simulated: &SimulatedMotion) -> Page {
        let SimulatedMotion { run, computed } = simulated;
        let size = self.output_model.plan().size();
        let evaluators = self.evaluators(&run.motion);
        space_page(self.scene(), size, computed, (&self.reactions, evaluators))
    }

    /// The events that happened, with their times.
    pub(in crate::space) fn recorded_events(&self, run: &Run) -> Vec<RecordedEvent> {
        let events = named_events(self, &run.motion.parts).into_iter();
        events.map(|(t, name)| RecordedEvent { name, t }).collect()
    }

    /// The rows of a motion.
    fn rows(
        &self,
        (motion, method_text): (&Motion, &str),
        samples: Vec<TrajectorySample>,
        between: Option<MotionBetweenRows<'_>>,
        progress: Progress<'_>,
    ) -> Result<ComputedTrajectory<'static>, StudyError> {
        let (scene, model) = (self.scene(), &self.output_model);
        let end = samples.last().map_or(0.0, |sample| sample.t);
        let period = model.plan().range().period();
        let computed = (samples, Vec::new(), method_text);
        let trajectory = free_trajectory(self, computed, (end, period));
        let of_model = (&self.reactions, model.plan());
        let mut all = all_columns(scene, of_model, (Analysis::FreeMotion, true));
        all.extend(extra_columns(scene, &self.machine));
        // No actuator drives a coordinate that is free.
        let is_free = |i: usize| self.spec.laws[i].is_none();
        all.retain(|c| !matches!(c.quantity, Quantity::ActuatorForce(i) if is_free(i)));
        let mut evaluators = self.evaluators(motion);
        let of = (&mut evaluators[..], None);
        computed_columns(scene, of_model, (trajectory, all), of, between, progress)
    }
}
