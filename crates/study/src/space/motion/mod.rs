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
use self::run::Run;
use crate::explain::StudyError;
use crate::free_motion::compute::{
    ChartedProblem as _, DescribedMotion, FreeMotion, MotionDescription, MotionProblem as _,
    MotionSolver, SimulatedScene, check_times, free_trajectory, named_events,
};
use crate::progress::Progress;
use crate::trajectory::compute::{
    ComputedTrajectory, MotionBetweenRows, RowSource, Sampler, SecondRows, Trajectory,
    TrajectorySample, check_variables,
};
use dwell_scene::SpaceScene;

impl SimulatedScene for SpaceScene {
    fn simulate_then<R>(
        &self,
        solver: &MotionSolver,
        times: Option<&[f64]>,
        progress: Progress<'_>,
        then: impl FnOnce(&RowSource<'_, '_, Self>, DescribedMotion<'_>) -> R,
    ) -> Result<R, StudyError> {
        let problem = SpaceMotionProblem::new(self)?.for_solver(solver);
        problem.simulated(solver, times, progress, then)
    }
}

impl SpaceMotionProblem<'_> {
    /// Does something with the motion by a solver, as [`SimulatedScene::simulate_then`] does.
    fn simulated<R>(
        &self,
        solver: &MotionSolver,
        times: Option<&[f64]>,
        progress: Progress<'_>,
        then: impl FnOnce(&RowSource<'_, '_, SpaceScene>, DescribedMotion<'_>) -> R,
    ) -> Result<R, StudyError> {
        check_variables(self.scene(), &self.rows)?;
        let duration = self.duration()?;
        times.map_or(Ok(()), |times| check_times(times, duration))?;
        let mut run = self.run(solver, duration)?;
        if let (Some(error), true) = (
            self.explained_end(&run.motion),
            run.motion.end_time() == 0.0,
        ) {
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
            .steps_as_samples(&run.motion, 0)
            .map(|further| MotionBetweenRows {
                further,
                sampler: &sampler,
            });
        let (motion, text) = (&run.motion, &run.method_text);
        let source = self.row_source(motion);
        let trajectory = self.trajectory(samples, text);
        let mut computed = source.along(trajectory, between, progress)?;
        let whole = |second: &&Motion| times.is_none() && second.failure.is_none();
        let second = run.second.as_ref().filter(whole);
        let second = second.and_then(|motion| {
            let trajectory = self.trajectory(self.samples(motion).ok()?, text);
            SecondRows::new(&self.row_source(motion), &trajectory)
        });
        computed.set_errors(second.as_ref());
        if let Some(end) = computed.end_of_rows() {
            let second = run.second.as_mut();
            second
                .into_iter()
                .chain([&mut run.motion])
                .for_each(|motion| motion.end_at(end));
        }
        let shortfall = self.shortfall(&run, solver);
        computed.early_stop = computed.early_stop.or(shortfall);
        let source = self.row_source(&run.motion);
        Ok(then(&source, self.described(&run, computed, duration)))
    }

    /// A motion with its rows, and what is said of it.
    fn described<'m>(
        &'m self,
        run: &'m Run,
        computed: ComputedTrajectory<'static>,
        duration: f64,
    ) -> DescribedMotion<'m> {
        let motion = FreeMotion {
            computed,
            events: named_events(self, &run.motion.segments),
            estimated_error: run.accuracy.and_then(|_| self.largest_error(run)),
        };
        let description = Box::new(move || {
            let (summary, record) = self.summary(run, duration);
            MotionDescription {
                event_table: self.event_table(&run.motion),
                summary,
                record,
            }
        });
        DescribedMotion {
            motion,
            description,
        }
    }

    /// What the rows of a motion are evaluated of.
    fn row_source<'p>(&'p self, motion: &'p Motion) -> RowSource<'p, 'p, SpaceScene> {
        let charts = (0..=motion.charts.len()).map(|chart| {
            let problem = self.in_chart(motion, chart);
            (problem.scene(), &problem.rows)
        });
        RowSource {
            charts: charts.collect(),
            ..RowSource::new(self.scene(), &self.rows)
        }
    }

    /// A motion by its samples.
    fn trajectory(&self, samples: Vec<TrajectorySample>, method_text: &str) -> Trajectory<'static> {
        let end = samples.last().map_or(0.0, |sample| sample.t);
        let period = self.rows.model.plan().range().period();
        free_trajectory(self, (samples, true, method_text), (end, period))
    }
}
