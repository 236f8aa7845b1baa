//! A motion in space between its rows: at its steps, and at any time within a step.

use super::problem::SpaceMotionProblem;
use super::run::Run;
use crate::free_motion::compute::{StatesWithinSteps, exact_state};
use crate::trajectory::compute::{SamplePrecision, TrajectorySample};
use dwell_dynamics::{EventSide, MachineOde, MachineWorkspace, OdeState, Solution};
use dwell_kinetostatics::space::Model;

/// A motion at any of its times, with the working memory to compute it.
pub(super) struct MotionSampler<'m> {
    run: &'m Run,
    parts: Vec<PartSampler<'m>>,
}

/// The same of a part in one coordinate.
struct PartSampler<'m> {
    problem: &'m SpaceMotionProblem<'m>,
    solution: &'m Solution,
    ode: Option<MachineOde<'m, Model>>,
    workspace: MachineWorkspace<f64, Model>,
    within_steps: StatesWithinSteps<usize>,
}

impl<'m> MotionSampler<'m> {
    pub(super) fn new(problem: &'m SpaceMotionProblem<'_>, run: &'m Run) -> Self {
        let parts = problem.parts(&run.motion);
        let parts = parts.map(|(problem, solution)| PartSampler::new(problem, solution));
        Self {
            run,
            parts: parts.collect(),
        }
    }

    /// The motion at a time, s: from its orbit, or from the step before, which is integrated once more up to there. None where that is
    /// not possible.
    pub(super) fn sample_at(
        &mut self,
        t: f64,
        precision: SamplePrecision,
    ) -> Option<TrajectorySample> {
        let started = |part: &&mut PartSampler<'_>| {
            let start = part.solution.steps.first();
            start.is_some_and(|start| start.t <= t)
        };
        let part = self.parts.iter_mut().rev().find(started)?;
        part.sample_at(t, precision, self.run)
    }
}

impl<'m> PartSampler<'m> {
    fn new(problem: &'m SpaceMotionProblem<'m>, solution: &'m Solution) -> Self {
        let steps = &solution.steps;
        let ends = steps.first().zip(steps.last());
        let ode = ends.and_then(|(first, last)| {
            MachineOde::until(&problem.machine, first.t, &first.y, Some(last.t)).ok()
        });
        Self {
            problem,
            solution,
            ode,
            workspace: problem.machine.workspace(),
            within_steps: StatesWithinSteps::default(),
        }
    }

    fn sample_at(
        &mut self,
        t: f64,
        precision: SamplePrecision,
        run: &Run,
    ) -> Option<TrajectorySample> {
        let solution = self.solution;
        let steps = &solution.steps;
        let step = steps.partition_point(|step| step.t <= t).checked_sub(1)?;
        let begin = &*solution.modes.state_at(&steps[step], EventSide::After);
        let point = match &run.orbit {
            _ if begin.t == t => begin.clone(),
            Some((orbit, _)) => OdeState::from(orbit.state_at(t)),
            None => {
                let (ode, next) = (self.ode.as_mut()?, steps.get(step + 1)?);
                let states = &mut self.within_steps;
                match precision {
                    SamplePrecision::Interpolated => {
                        states.interpolated(ode, step, [begin, next], t)?
                    }
                    SamplePrecision::Exact => {
                        let before = states.before(&step, t);
                        exact_state(ode, &before.unwrap_or_else(|| begin.clone()), t)?
                    }
                }
            }
        };
        if self.problem.machine.is_in_fit_window(&point.y) {
            return None;
        }
        let along = (&solution.modes, EventSide::After);
        let sample = self.problem.sample(&point, along, &mut self.workspace);
        sample.ok()
    }
}
