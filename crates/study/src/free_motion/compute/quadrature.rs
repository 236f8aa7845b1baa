//! A conservative periodic motion by quadrature, to a required accuracy.
//!
//! The rule has the fewest points with which the whole motion keeps the accuracy. Its error is the difference from the
//! motion by twice as many points, over the whole duration: an error of the period counts in every period. To that the
//! rounding of the initial state is added, which acts as a delay.

use crate::estimate;
use crate::free_motion::compute::refinement::MIN_TOLERANCE;
use crate::free_motion::compute::{ComputedMotion, Difference, FreeMotionProblem, SegmentedMotion};
use dwell_dynamics::{
    DynamicsError, Method, ObservedMachine, OdeState, Options, Orbit, OrbitSequence, ReducedState,
    Solution, solve_orbit,
};

/// The error of a rule is at most this many times its difference from the next: the error of that one is at most half
/// of it, and a thousandth where the rule resolves the motion.
const SAFETY_FACTOR: f64 = 2.0;

/// How much smaller the last coefficients of a rule must be that follows one which did not keep the accuracy.
const TAIL_RATIO: f64 = 0.01;

impl FreeMotionProblem<'_> {
    /// The motion by quadrature, if it is conservative and periodic.
    pub(super) fn by_quadrature(
        &self,
        accuracy: f64,
        duration: f64,
        sample_interval: f64,
    ) -> Option<ComputedMotion> {
        if self.spec.laws.iter().any(Option::is_some) {
            return None;
        }
        let start = self.initial_reduced_state();
        let mut sequence = OrbitSequence::loaded(&self.machine, start).ok()?;
        let exact = Orbit::loaded(&self.machine, start).ok()?;
        let perturbed = |factor: f64| {
            let q_dot = start.q_dot * factor;
            Orbit::loaded(&self.machine, ReducedState { q_dot, ..start })
        };
        let delay = estimate::of_period(&exact, perturbed).ok()? / exact.period;
        let along = |orbit: Orbit| self.along(orbit, accuracy, duration, sample_interval);
        let mut tail = accuracy;
        let mut orbit = sequence.next_orbit(tail).ok()?;
        let (motion, difference) = loop {
            let is_candidate = orbit.is_resolved || orbit.tail < tail;
            let finer = sequence.next_orbit(tail).ok()?;
            if !is_candidate {
                orbit = finer;
                continue;
            }
            let motion = along(orbit.clone())?;
            let rounding = self.rounding_difference(&motion, &orbit, delay).ok()?;
            let next = along(finer.clone())?;
            let truncation = self.difference(&motion, &next).ok()?;
            let difference = truncation.scaled(SAFETY_FACTOR).plus(&rounding);
            // More points than both need would change roundings only.
            if difference.largest() <= accuracy || (orbit.is_resolved && finer.is_resolved) {
                break (motion, difference);
            }
            tail *= TAIL_RATIO;
            orbit = finer;
        };
        let method_text = "quadrature".to_owned();
        let points = orbit.points;
        let how = format!("quadrature (conservative, periodic motion), {points} quadrature points");
        let found = ComputedMotion::to_accuracy(motion, method_text, accuracy, &how, &difference);
        Some(found)
    }

    /// The motion along an orbit.
    fn along(
        &self,
        orbit: Orbit,
        accuracy: f64,
        duration: f64,
        sample_interval: f64,
    ) -> Option<SegmentedMotion> {
        let outputs = ObservedMachine::new(&self.machine, &self.output_model);
        let options = Options {
            sample_interval: Some(sample_interval),
            rtol: accuracy,
            // What an event must pass its value by is relative to the motion, whatever its size.
            atol: f64::MIN_POSITIVE,
            ..Options::new(Method::Dop853, MIN_TOLERANCE)
        };
        let solution = solve_orbit(&orbit, outputs, duration, &options, &self.events()).ok()?;
        if let Some(DynamicsError::MaxStepsReached { .. }) = solution.error {
            return None;
        }
        Some(SegmentedMotion::along_orbit(orbit, solution))
    }

    /// The difference of a motion from the same with a delay, a fraction of the time.
    fn rounding_difference(
        &self,
        motion: &SegmentedMotion,
        orbit: &Orbit,
        delay: f64,
    ) -> Result<Difference, DynamicsError> {
        let shifted = |point: &OdeState| {
            let ReducedState { q, q_dot, .. } = orbit.state_at(point.t * (1.0 + delay));
            OdeState {
                t: point.t,
                y: vec![q, q_dot],
            }
        };
        let solutions = motion.segments.iter().map(|(_, solution)| solution);
        let samples = solutions.clone().flat_map(|s| &s.samples);
        let delayed = SegmentedMotion::single_segment(Solution {
            steps: solutions.flat_map(|s| s.steps.last().cloned()).collect(),
            samples: samples.map(shifted).collect(),
            ..Solution::default()
        });
        self.difference(motion, &delayed)
    }
}
