//! A computed motion between its samples: at its steps, and at any time within a step.

use crate::free_motion::compute::tables::sliding_at;
use crate::free_motion::compute::{FreeMotionProblem, SegmentedMotion};
use crate::trajectory::compute::TrajectorySample;
use dwell_dynamics::{
    DenseOutput, MachineOde, MachineWorkspace, Method, OdeState, Options, StepControl, integrate,
};
use dwell_geometry::body_states::CoordinateFunction;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::collections::btree_map::Entry;
use std::f64::consts::TAU;

/// Highest number of steps that are evaluated like samples.
const MAX_STEPS: usize = 50_000;
/// Method, tolerance and highest number of steps from the beginning of a step to a time within it; the second where a
/// stiff motion needs too many of the first.
const METHODS: [(Method, f64, usize); 2] =
    [(Method::Dop853, 1e-12, 200), (Method::Bdf, 1e-10, 20_000)];

impl FreeMotionProblem<'_> {
    /// The motion at its steps; none if there are too many of them.
    pub(crate) fn steps_as_samples(
        &self,
        motion: &SegmentedMotion,
    ) -> Option<Vec<(f64, TrajectorySample)>> {
        if motion.steps().count() > MAX_STEPS {
            return None;
        }
        let coordinates = &motion.actuator_coordinates.steps;
        self.evaluated(motion, |solution| &solution.steps, coordinates)
            .ok()
    }

    /// Whether a time (s) is in a step that begins or ends within the window of a change point's fit.
    pub(crate) fn is_in_fit_window(&self, motion: &SegmentedMotion, t: f64) -> bool {
        let is_fit = |(chart, step): (usize, &OdeState)| {
            self.machine(motion, chart).is_in_fit_window(&step.y)
        };
        let before = motion.steps().filter(|(_, step)| step.t <= t).last();
        let after = motion.steps().find(|(_, step)| step.t >= t);
        before.is_some_and(is_fit) || after.is_some_and(is_fit)
    }

    /// A motion at any of its times.
    pub(crate) fn sampler<'m>(&'m self, motion: &'m SegmentedMotion) -> MotionSampler<'m> {
        MotionSampler {
            problem: self,
            motion,
            machines: RefCell::new(BTreeMap::new()),
        }
    }
}

/// A motion at any of its times, with the working memory to compute it, by chart.
pub(crate) struct MotionSampler<'m> {
    problem: &'m FreeMotionProblem<'m>,
    motion: &'m SegmentedMotion,
    machines: RefCell<BTreeMap<usize, (MachineOde<'m>, MachineWorkspace)>>,
}

impl<'m> MotionSampler<'m> {
    /// The motion at a time (s): from its orbit, or from the step before, which is integrated once more up to there.
    /// None where that is not possible.
    pub(crate) fn sample_at(&self, t: f64) -> Option<TrajectorySample> {
        let (problem, motion) = (self.problem, self.motion);
        let holds = |steps: &[OdeState]| {
            let ends = steps.first().zip(steps.last());
            ends.is_some_and(|(first, last)| first.t <= t && t <= last.t)
        };
        let mut segments = motion.segments.iter().enumerate();
        let (segment, (chart, solution)) = segments.find(|(_, (_, s))| holds(&s.steps))?;
        let k = solution
            .steps
            .partition_point(|step| step.t <= t)
            .checked_sub(1)?;
        let before = &solution.steps[k];
        let machine = problem.machine(motion, *chart);
        let mut machines = self.machines.borrow_mut();
        let (ode, workspace) = match machines.entry(*chart) {
            Entry::Occupied(known) => known.into_mut(),
            Entry::Vacant(new) => {
                // At rest the energies show nothing of the works that come: steps would follow their rounding.
                let end = Some(motion.end_time());
                let ode = MachineOde::until(machine, before.t, &before.y, end).ok()?;
                new.insert((ode, machine.workspace()))
            }
        };
        let point = match (before.t == t, &motion.orbit) {
            (true, _) => before.clone(),
            (false, Some(orbit)) => OdeState::from(orbit.state_at(t)),
            (false, None) => {
                let mut by_each = METHODS.iter();
                by_each.find_map(|options| state_after(ode, before, t, options))?
            }
        };
        if machine.is_in_fit_window(&point.y) {
            return None;
        }
        let sliding = sliding_at(solution, t);
        let place = (*chart, machine, &mut *workspace);
        let mut sample = problem.sample(place, &point, sliding).ok()?;
        if let Some(steps) = motion.actuator_coordinates.steps.get(segment) {
            let mechanism = &problem.loaded_scene.mechanism;
            let measured =
                CoordinateFunction::find(mechanism, mechanism.actuators[0].coordinate())?;
            let mut state = machine.evaluate(point.t, &point.y, workspace).ok()?;
            let mut now = state.bodies().coordinate(measured);
            if let CoordinateFunction::Angle(_) = measured {
                let [q, q_dot, _] = *steps.get(k)?;
                let near = q + 0.5 * (q_dot + now[1]) * (t - before.t);
                now[0] += TAU * ((near - now[0]) / TAU).round();
            }
            sample.actuator_coordinate = Some(now);
        }
        Some(sample)
    }
}

/// The state at a time (s), integrated from an earlier state.
fn state_after(
    ode: &mut MachineOde<'_>,
    before: &OdeState,
    t: f64,
    &(method, tolerance, max_steps): &(Method, f64, usize),
) -> Option<OdeState> {
    // Within a step nothing switches, and nothing varies faster than it: it need not be searched again, which would take
    // most of the time.
    let options = Options {
        max_steps,
        max_step: Some(t - before.t),
        ..Options::new(method, tolerance)
    };
    let mut go_on = |_: &OdeState, _: &OdeState, _: DenseOutput<'_>| Ok(StepControl::Continue);
    let part = integrate(ode, before, Some(t), &options, &mut go_on).ok()?;
    part.error.is_none().then_some(part.state)
}
