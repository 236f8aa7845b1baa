//! A computed motion between its samples: at its steps, and at any time within a step.

use crate::free_motion::compute::{FreeMotionProblem, SegmentedMotion};
use crate::trajectory::compute::TrajectorySample;
use dwell_dynamics::{
    Machine, MachineOde, Method, ObservedMachine, OdeState, Options, solve_system,
};
use dwell_geometry::body_states::CoordinateFunction;
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

    /// The state at a time (s), integrated from an earlier state.
    fn state_after(
        &self,
        machine: &Machine,
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
        let mut ode = MachineOde::new(machine, before.t, &before.y).ok()?;
        let observed = ObservedMachine::new(machine, &self.output_model);
        let part = solve_system(&mut ode, observed, before, Some(t), &options, &[]);
        part.ok()?.completed().ok()?.steps.pop()
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

    /// The motion at a time (s): from its orbit, or from the step before, which is integrated once more up to there.
    /// None where that is not possible.
    pub(crate) fn sample_at(&self, motion: &SegmentedMotion, t: f64) -> Option<TrajectorySample> {
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
        let machine = self.machine(motion, *chart);
        let point = match (before.t == t, &motion.orbit) {
            (true, _) => before.clone(),
            (false, Some(orbit)) => OdeState::from(orbit.state_at(t)),
            (false, None) => {
                let mut by_each = METHODS.iter();
                by_each.find_map(|options| self.state_after(machine, before, t, options))?
            }
        };
        if machine.is_in_fit_window(&point.y) {
            return None;
        }
        let mut workspace = machine.workspace();
        let mut sample = self
            .sample((*chart, machine, &mut workspace), &point)
            .ok()?;
        if let Some(steps) = motion.actuator_coordinates.steps.get(segment) {
            let mechanism = &self.loaded_scene.mechanism;
            let measured =
                CoordinateFunction::find(mechanism, mechanism.actuators[0].coordinate())?;
            let mut state = machine.evaluate(point.t, &point.y, &mut workspace).ok()?;
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
