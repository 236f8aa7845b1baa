//! A conservative periodic motion by quadrature, to a required accuracy.
//!
//! The rule has the fewest points with which the whole motion keeps the accuracy. Its error is the difference from the
//! motion by twice as many points, over the whole duration: an error of the period counts in every period. To that the
//! rounding of the initial state is added, which acts as a delay.

use crate::estimate;
use crate::free_motion::compute::description::imbalance;
use crate::free_motion::compute::difference::difference;
use crate::free_motion::compute::refinement::MIN_TOLERANCE;
use crate::free_motion::compute::{ChartedProblem, ComputedMotion, Difference, SegmentedMotion};
use dwell_dynamics::{
    DynamicsError, Method, ObservedMachine, OdeState, Options, Orbit, OrbitSequence, ReducedState,
    Solution, solve_orbit,
};

/// The error of a rule is at most this many times its difference from the next: the error of that one is at most half
/// of it, and a thousandth where the rule resolves the motion.
const SAFETY_FACTOR: f64 = 2.0;

/// Parts of a period at which motions are compared.
const COMPARED_PARTS: usize = 64;
/// How much smaller the last coefficients of a rule must be that follows one which did not keep the accuracy.
const TAIL_RATIO: f64 = 0.01;

/// Two computations of a motion along orbits: the first, the second, and what its difference shows.
struct ComparedOrbits<C> {
    motion: SegmentedMotion<C>,
    difference: Difference,
    comparison: SegmentedMotion<C>,
    points: usize,
}

/// A motion by quadrature over a duration, s.
struct Quadrature<'p, P> {
    problem: &'p P,
    accuracy: f64,
    duration: f64,
    sample_interval: f64,
    /// The part of all times by which the rounding of the start delays it.
    delay: f64,
}

/// The motion by quadrature, if it is conservative and periodic.
pub(super) fn by_quadrature<P: ChartedProblem>(
    problem: &P,
    accuracy: f64,
    duration: f64,
    sample_interval: f64,
) -> Option<ComputedMotion<P::Chart>> {
    if problem.spec().laws.iter().any(Option::is_some) {
        return None;
    }
    let exact = problem.orbit(1.0).ok()?;
    if problem.passes_close_branches(&exact) {
        return None;
    }
    let delay = estimate::of_period(&exact, |factor| problem.orbit(factor)).ok()? / exact.period;
    let quadrature = Quadrature {
        problem,
        accuracy,
        duration,
        sample_interval,
        delay,
    };
    let found = quadrature.by_fewest_points()?;
    let (difference, points) = (found.difference, found.points);
    let how = format!("quadrature (conservative, periodic motion), {points} quadrature points");
    let (remarks, record) = difference.remarks(accuracy, &how);
    Some(ComputedMotion {
        motion: found.motion,
        method_text: "quadrature".to_owned(),
        remarks,
        record,
        accuracy: Some([accuracy, difference.largest()]),
        comparison: Some(found.comparison),
        delay: Some(delay),
        ..ComputedMotion::default()
    })
}

impl<P: ChartedProblem> Quadrature<'_, P> {
    /// The motion by the rule of the fewest points that keeps the accuracy.
    fn by_fewest_points(&self) -> Option<ComparedOrbits<P::Chart>> {
        let (machine, start) = (self.problem.machine(), self.problem.initial_reduced_state());
        let mut sequence = OrbitSequence::loaded(machine, start).ok()?;
        let mut tail = self.accuracy;
        let mut orbit = sequence.next_orbit(tail).ok()?;
        loop {
            let is_candidate = orbit.is_resolved || orbit.tail < tail;
            let finer = sequence.next_orbit(tail).ok()?;
            if is_candidate {
                let compared = self.compared([&orbit, &finer])?;
                // More points than both need would change roundings only.
                let are_resolved = orbit.is_resolved && finer.is_resolved;
                if compared.difference.largest() <= self.accuracy || are_resolved {
                    return Some(compared);
                }
                tail *= TAIL_RATIO;
            }
            orbit = finer;
        }
    }

    /// The motions along two orbits, compared.
    fn compared(&self, [orbit, finer]: [&Orbit; 2]) -> Option<ComparedOrbits<P::Chart>> {
        let motion = self.along(orbit.clone())?;
        let next = self.along(finer.clone())?;
        let ends = [motion.end_time(), next.end_time()];
        let difference = self.orbit_difference([orbit, finer], ends).ok()?;
        // The compared times may miss a peak that a row or a step shows.
        let imbalance = SAFETY_FACTOR * imbalance(self.problem, &motion);
        // Both errors together, with the events and the end of the finer orbit.
        let mut comparison = delayed(&motion, finer, self.delay);
        for ((_, to), (_, from)) in comparison.segments.iter_mut().zip(next.segments) {
            to.event_occurrences = from.event_occurrences;
            to.steps = from.steps;
        }
        Some(ComparedOrbits {
            motion,
            difference: difference.with_imbalance(imbalance),
            comparison,
            points: orbit.points,
        })
    }

    /// The error of an orbit's rule, from a finer one, and of the rounding that delays it; `ends` are those of the two motions, s.
    fn orbit_difference(
        &self,
        [orbit, finer]: [&Orbit; 2],
        ends: [f64; 2],
    ) -> Result<Difference, DynamicsError> {
        let times = compared_times(orbit, ends[0]);
        let at_times = |orbit: &Orbit, end: f64, delay: f64| {
            let late = |&t: &f64| OdeState {
                t,
                ..OdeState::from(orbit.state_at(t * (1.0 + delay)))
            };
            compared_motion(times.iter().map(late).collect(), end)
        };
        let these = at_times(orbit, ends[0], 0.0);
        let late = at_times(orbit, ends[0], self.delay);
        let rounding = difference(self.problem, [&these, &late])?;
        let others = at_times(finer, ends[1], 0.0);
        let truncation = difference(self.problem, [&these, &others])?;
        Ok(truncation.scaled(SAFETY_FACTOR).plus(&rounding))
    }

    /// The motion along an orbit.
    fn along(&self, orbit: Orbit) -> Option<SegmentedMotion<P::Chart>> {
        let (events, output_model) = self.problem.events();
        let outputs = ObservedMachine::new(self.problem.machine(), output_model);
        let options = Options {
            sample_interval: Some(self.sample_interval),
            rtol: self.accuracy,
            // What an event must pass its value by is relative to the motion, whatever its size.
            atol: f64::MIN_POSITIVE,
            ..Options::new(Method::Dop853, MIN_TOLERANCE)
        };
        let solution = solve_orbit(&orbit, outputs, self.duration, &options, &events).ok()?;
        if let Some(DynamicsError::MaxStepsReached { .. }) = solution.error {
            return None;
        }
        Some(SegmentedMotion::along_orbit(orbit, solution))
    }
}

/// The instants of a motion on an orbit that is delayed by a fraction of the time.
fn delayed<C>(motion: &SegmentedMotion<C>, orbit: &Orbit, delay: f64) -> SegmentedMotion<C> {
    let shifted = |point: &OdeState| {
        let ReducedState { q, q_dot, .. } = orbit.state_at(point.t * (1.0 + delay));
        OdeState {
            t: point.t,
            y: vec![q, q_dot],
        }
    };
    let solutions = motion.segments.iter().map(|(_, solution)| solution);
    let samples = solutions.clone().flat_map(|s| &s.samples);
    SegmentedMotion::single_segment(Solution {
        steps: solutions.flat_map(|s| s.steps.last().cloned()).collect(),
        samples: samples.map(shifted).collect(),
        ..Solution::default()
    })
}

/// The times (s) at which two computations of a motion are compared: equal parts of the phase in the first period, and in
/// the last, where every delay is largest. Rows may all be at one phase.
fn compared_times(orbit: &Orbit, end: f64) -> Vec<f64> {
    let parts = orbit.times_of_parts(COMPARED_PARTS);
    let last_period = ((end / orbit.period).floor() - 1.0).max(0.0) * orbit.period;
    let in_last = parts.iter().map(|t| last_period + t);
    let mut times: Vec<f64> = parts.iter().copied().chain(in_last).collect();
    times.extend([0.0, end]);
    times.retain(|t| (0.0..=end).contains(t));
    times.sort_by(f64::total_cmp);
    times.dedup();
    times
}

/// The states of a motion at the times at which it is compared, and its end (s).
fn compared_motion<C>(samples: Vec<OdeState>, end: f64) -> SegmentedMotion<C> {
    let last = samples.last().map(|last| OdeState {
        t: end,
        y: last.y.clone(),
    });
    SegmentedMotion::single_segment(Solution {
        steps: last.into_iter().collect(),
        samples,
        ..Solution::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::free_motion::compute::{FreeMotionProblem, MotionProblem as _};
    use crate::models::with_drive_loads;
    use dwell_scene::PlaneScene;

    /// Rotations and librations, with and without loads.
    const CASES: [&str; 4] = [
        "pendulum-a01",
        "crank-rocker",
        "slotted-rocker",
        "single-dwell",
    ];

    /// The points, the estimate and the true error, against the fully resolved orbit, of a case over a number of
    /// periods. None of a motion without a period.
    fn errors(case: &str, periods: f64, accuracy: f64) -> Option<(usize, f64, f64)> {
        let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");
        let text = std::fs::read_to_string(format!("{cases}/{case}/scene.toml")).unwrap();
        let scene = PlaneScene::parse(case, &text).unwrap();
        let loaded_scene = with_drive_loads(&scene).unwrap();
        let motion = scene.motion.as_ref().unwrap();
        let problem = FreeMotionProblem::new(&scene, &loaded_scene, motion).unwrap();
        let orbit = Orbit::loaded(&problem.machine, problem.initial_reduced_state()).ok()?;
        let duration = periods * orbit.period;
        // No whole number of rows in a period.
        let interval = duration / 499.3;
        let found = by_quadrature(&problem, accuracy, duration, interval)?;
        let [_, estimate] = found.accuracy.unwrap();
        let points = found.motion.statistics.evaluations;
        let quadrature = Quadrature {
            problem: &problem,
            accuracy: 1e-12,
            duration,
            sample_interval: interval,
            delay: 0.0,
        };
        let exact = quadrature.along(orbit).unwrap();
        let off = difference(&problem, [&exact, &found.motion]).unwrap();
        let true_error = off.largest();
        Some((points, estimate, true_error))
    }

    #[test]
    fn val_accuracy_is_kept_with_few_points() {
        let mut compared = 0;
        for case in CASES {
            for periods in [0.7, 10.0, 1000.0] {
                let mut last_points = 0;
                for exponent in 2..=12 {
                    let accuracy = 10_f64.powi(-exponent);
                    let Some((points, estimate, true_error)) = errors(case, periods, accuracy)
                    else {
                        continue;
                    };
                    println!(
                        "{case} {periods} {accuracy:e}: {points} points, {true_error:.1e} of {estimate:.1e}"
                    );
                    assert!(
                        true_error <= estimate,
                        "{case}: {true_error:e} {estimate:e}"
                    );
                    // The roundings of a thousand periods are beyond the finest.
                    assert!(
                        estimate <= accuracy || estimate < 2e-13 * periods.max(10.0),
                        "{estimate:e}"
                    );
                    assert!(
                        true_error < 1e-13 || estimate < 100.0 * true_error,
                        "{estimate:e} {true_error:e}"
                    );
                    assert!(
                        points >= last_points,
                        "{case} {accuracy:e}: {points} after {last_points}"
                    );
                    last_points = points;
                    compared += 1;
                }
                let coarse = errors(case, periods, 1e-2).map_or(0, |(points, ..)| points);
                assert!(
                    last_points == 0 || last_points > coarse,
                    "{case}: {last_points} {coarse}"
                );
            }
        }
        assert!(compared > 90, "{compared}");
    }
}
