//! A motion to a required accuracy, by the cheapest method whose error estimate meets it.
//!
//! 1. A conservative periodic motion is computed by quadrature, whatever its duration.
//! 2. A smooth motion is integrated by DOP853, a stiff one by BDF. A coarse run decides: by the fraction of its steps
//!    that stability limits, and by the cost of BDF for the same motion.
//! 3. If more evaluations are expected than building a table of the machine costs, the motion is integrated on a table.
//! 4. The tolerance is found by trial: each run is compared with the one before, at ten times its tolerance or more,
//!    over the whole motion, in coordinates, energy and reactions. That difference is the estimate; the finer run is
//!    kept.

use crate::estimate;
use crate::explain::{StudyError, explain_motion};
use crate::free_motion::compute::{ComputedMotion, Difference, FreeMotionProblem, SegmentedMotion};
use dwell_dynamics::{
    DynamicsError, Method, ObservedMachine, OdeState, Options, Orbit, ReducedState, Solution,
    Statistics, TabulatedMachine, solve_orbit, solve_system,
};
use dwell_kinetostatics::TableDomain;
use dwell_scene::Scene;

/// Tolerance of the coarse run.
const COARSE_TOLERANCE: f64 = 1e-4;
/// The finest tolerances: below them rounding is all that changes, and Newton's method cannot keep them.
const MIN_TOLERANCE: f64 = 1e-14;
const MIN_IMPLICIT_TOLERANCE: f64 = 1e-13;
/// Error of BDF relative to DOP853 at the same tolerance: 2 to 240 in ten revolutions of m = 2 + cos q, growing
/// with finer tolerances.
const BDF_ERROR_RATIO: f64 = 50.0;
/// First tolerance, relative to the required accuracy: an integrator's error is tens of times its tolerance.
const FIRST_TOLERANCE_RATIO: f64 = 1e-2;
/// Error aimed at after an error that was too large, relative to the required accuracy.
const TARGET_ERROR_RATIO: f64 = 0.2;
/// Smallest and largest factor of one refinement of the tolerance.
const TOLERANCE_FACTORS: [f64; 2] = [1e-4, 0.1];
/// The error of the finer run is a tenth to a half of the difference from the run before; the worst ratio measured
/// is 2.2 (nine cases, eleven accuracies each).
const SAFETY_FACTOR: f64 = 2.5;
/// Fraction of stiff steps above which stability, not accuracy, determines the cost.
const MAX_STIFF_FRACTION: f64 = 0.05;
/// Number of evaluations above which a table pays: building two to 1e-9 takes 2.4 to 9.4 ms under loads, which is up
/// to 20 000 evaluations of the machine, and saves 80 to 90 % of each (docs/performance.md).
const TABLE_BREAK_EVEN: f64 = 30_000.0;
/// Accuracy of a table relative to the tolerance, and its finest value.
const TABLE_TOLERANCE_RATIO: f64 = 0.1;
const MIN_TABLE_TOLERANCE: f64 = 1e-13;
/// Margin of a table of a limited range beyond the coarse run, relative to the range of that run.
const TABLE_MARGIN: f64 = 0.05;
/// Maximum number of steps of a coarse run.
const MAX_COARSE_STEPS: usize = 100_000;
/// Maximum number of runs.
const MAX_RUNS: usize = 6;

impl FreeMotionProblem<'_> {
    /// The motion to `accuracy`: rad (lengths: relative to the largest change), and relative to the largest kinetic
    /// energy and the largest reaction.
    pub(crate) fn to_accuracy(
        &self,
        scene: &Scene,
        accuracy: f64,
        duration: f64,
        sample_interval: f64,
    ) -> Result<ComputedMotion, StudyError> {
        if let Some(found) = self.by_quadrature(accuracy, duration, sample_interval) {
            return Ok(found);
        }
        let options_for = |method: Method, tolerance: f64| Options {
            sample_interval: Some(sample_interval),
            ..Options::new(method, tolerance)
        };
        let coarse_run = |method: Method| {
            let options = Options {
                max_steps: MAX_COARSE_STEPS,
                ..options_for(method, COARSE_TOLERANCE)
            };
            self.solve(scene, duration, &options)
        };
        let explicit = coarse_run(Method::Dop853)?;
        let (methods, expected_evaluations, reason) =
            self.rank_methods(&explicit, || coarse_run(Method::Bdf), accuracy)?;
        let mut candidates: Vec<(Method, bool)> = methods.map(|method| (method, false)).to_vec();
        if expected_evaluations > TABLE_BREAK_EVEN && self.stays_on_branch(&explicit) {
            candidates.insert(0, (methods[0], true));
        }
        let visited = visited_range(&explicit);
        // If the first method cannot reach the accuracy, the next may.
        let mut best: Option<(Refinement, Method, bool)> = None;
        let mut last = (candidates[0] == (Method::Dop853, false) && reached_end(&explicit))
            .then_some((COARSE_TOLERANCE, explicit));
        for (method, tabled) in candidates {
            let solve = |tolerance: f64| {
                let options = options_for(method, tolerance);
                if tabled {
                    self.solve_on_table(visited, duration, &options)
                } else {
                    self.solve(scene, duration, &options).map(Some)
                }
            };
            let Some(refinement) = self.refine(accuracy, method, last.take(), &solve)? else {
                continue;
            };
            let largest = refinement.difference.largest();
            let is_better =
                |(best, ..): &(Refinement, Method, bool)| largest < best.difference.largest();
            if best.as_ref().is_none_or(is_better) {
                best = Some((refinement, method, tabled));
            }
            if largest <= accuracy {
                break;
            }
        }
        let Some((refinement, method, tabled)) = best else {
            let error = DynamicsError::DurationTooShort;
            return Err(explain_motion(
                self.loaded_scene,
                self.output_model.plan(),
                &error,
            ));
        };
        let suffix = if tabled { " on a table" } else { "" };
        let method_text = format!(
            "{}{suffix}, tolerance {}",
            method.name(),
            two_digits(refinement.tolerance)
        );
        let remarks = format!(
            "  accuracy {}: {method_text}, {reason}; {} runs\n{}",
            two_digits(accuracy),
            refinement.runs,
            describe_difference(&refinement.difference)
        );
        Ok(ComputedMotion {
            motion: refinement.motion,
            method_text,
            remarks,
            accuracy: Some([accuracy, refinement.difference.largest()]),
        })
    }

    /// The methods to try, the cheaper first; the expected number of evaluations; and the reason.
    fn rank_methods(
        &self,
        explicit: &SegmentedMotion,
        implicit: impl FnOnce() -> Result<SegmentedMotion, StudyError>,
        accuracy: f64,
    ) -> Result<([Method; 2], f64, String), StudyError> {
        let statistics = explicit.statistics;
        let stiff_fraction = statistics.stiff_steps as f64 / (statistics.steps.max(1)) as f64;
        // The cost of accuracy grows as the root of the method's order; the cost of stability does not grow.
        let refinement_ratio = COARSE_TOLERANCE
            / (FIRST_TOLERANCE_RATIO * accuracy).clamp(MIN_TOLERANCE, COARSE_TOLERANCE);
        let by_explicit = statistics.evaluations as f64
            * (stiff_fraction + (1.0 - stiff_fraction) * refinement_ratio.powf(1.0 / 8.0));
        let smooth = [Method::Dop853, Method::Bdf];
        if reached_end(explicit) && stiff_fraction <= MAX_STIFF_FRACTION {
            return Ok((smooth, by_explicit, "the motion is smooth".to_owned()));
        }
        let implicit = implicit()?;
        let by_implicit = self.equivalent_evaluations(&implicit.statistics)
            * (BDF_ERROR_RATIO * refinement_ratio).powf(1.0 / 6.0);
        let reason = format!(
            "{:.0} % of the steps of a coarse run are stiff",
            100.0 * stiff_fraction
        );
        Ok(if reached_end(explicit) && by_explicit <= by_implicit {
            (smooth, by_explicit, reason)
        } else {
            ([Method::Bdf, Method::Dop853], by_implicit, reason)
        })
    }

    /// The work of BDF in evaluations: a column of a Jacobian is one in dual numbers, a step costs two more.
    fn equivalent_evaluations(&self, statistics: &Statistics) -> f64 {
        let columns = 4 * self.machine.free().len();
        (statistics.evaluations + columns * statistics.jacobians + 2 * statistics.steps) as f64
    }

    /// Whether a motion stays in its own coordinate and assembly mode, where a table applies.
    fn stays_on_branch(&self, coarse: &SegmentedMotion) -> bool {
        let is_single_segment = coarse.segments.len() == 1 && coarse.charts.len() <= 1;
        is_single_segment && reached_end(coarse) && self.machine.free() == [0]
    }

    /// The motion on a table whose accuracy follows the tolerance, so that the difference of two runs contains both
    /// errors. `None` if there is no such table, or the motion leaves it.
    fn solve_on_table(
        &self,
        visited: [f64; 2],
        duration: f64,
        options: &Options,
    ) -> Result<Option<SegmentedMotion>, StudyError> {
        let extent = match self.machine.model().plan().range().limits() {
            None => TableDomain::Full,
            Some((from, to)) => {
                let margin = TABLE_MARGIN * (visited[1] - visited[0]);
                TableDomain::Between(
                    (visited[0] - margin).max(from),
                    (visited[1] + margin).min(to),
                )
            }
        };
        let accuracy = (TABLE_TOLERANCE_RATIO * options.rtol).max(MIN_TABLE_TOLERANCE);
        let Ok(table) = TabulatedMachine::new(&self.machine, accuracy, extent) else {
            return Ok(None);
        };
        let start = self.initial_state();
        let explain =
            |e: &DynamicsError| explain_motion(self.loaded_scene, self.output_model.plan(), e);
        let mut ode = table.ode(start.t, &start.y).map_err(|e| explain(&e))?;
        let outputs = ObservedMachine::new(&self.machine, &self.output_model);
        let events = self.events();
        let solution = solve_system(&mut ode, outputs, &start, Some(duration), options, &events);
        let solution = solution.map_err(|e| explain(&e))?;
        Ok(solution
            .error
            .is_none()
            .then(|| SegmentedMotion::single_segment(solution)))
    }

    /// Repeats the motion at finer tolerances until two runs agree; keeps the last. `None` if a run cannot be made.
    fn refine(
        &self,
        accuracy: f64,
        method: Method,
        last: Option<(f64, SegmentedMotion)>,
        solve: &dyn Fn(f64) -> Result<Option<SegmentedMotion>, StudyError>,
    ) -> Result<Option<Refinement>, StudyError> {
        let explain =
            |e: &DynamicsError| explain_motion(self.loaded_scene, self.output_model.plan(), e);
        let min_tolerance = if method.is_implicit() {
            MIN_IMPLICIT_TOLERANCE
        } else {
            MIN_TOLERANCE
        };
        let first =
            (FIRST_TOLERANCE_RATIO * accuracy).clamp(10.0 * min_tolerance, COARSE_TOLERANCE);
        // The coarse run serves as the first comparison.
        let (mut tolerance, mut kept) = match last {
            Some((tolerance, motion)) if 0.1 * tolerance <= first => (tolerance, motion),
            _ => match solve(first)? {
                Some(motion) => (first, motion),
                None => return Ok(None),
            },
        };
        let mut next = (0.1 * tolerance).min(first).max(min_tolerance);
        let mut runs = 1;
        loop {
            let Some(motion) = solve(next)? else {
                return Ok(None);
            };
            let difference = self.difference(&kept, &motion).map_err(|e| explain(&e))?;
            let difference = difference.scaled(SAFETY_FACTOR);
            (tolerance, kept) = (next, motion);
            runs += 1;
            let largest = difference.largest();
            if largest <= accuracy || next <= 1.01 * min_tolerance || runs >= MAX_RUNS {
                return Ok(Some(Refinement {
                    tolerance,
                    motion: kept,
                    difference,
                    runs,
                }));
            }
            let [min_factor, max_factor] = TOLERANCE_FACTORS;
            let factor = if largest.is_finite() {
                TARGET_ERROR_RATIO * accuracy / largest
            } else {
                max_factor
            };
            next = (tolerance * factor.clamp(min_factor, max_factor)).max(min_tolerance);
        }
    }

    /// The motion by quadrature, if it is conservative and periodic.
    fn by_quadrature(
        &self,
        accuracy: f64,
        duration: f64,
        sample_interval: f64,
    ) -> Option<ComputedMotion> {
        if self.spec.laws.iter().any(Option::is_some) {
            return None;
        }
        let start = self.initial_reduced_state();
        let orbit = Orbit::loaded(&self.machine, start).ok()?;
        let outputs = ObservedMachine::new(&self.machine, &self.output_model);
        let options = Options {
            sample_interval: Some(sample_interval),
            ..Options::new(Method::Dop853, MIN_TOLERANCE)
        };
        let solution = solve_orbit(&orbit, outputs, duration, &options, &self.events()).ok()?;
        if solution.error.is_some() {
            return None;
        }
        let perturbed = |factor: f64| {
            let q_dot = start.q_dot * factor;
            Orbit::loaded(&self.machine, ReducedState { q_dot, ..start })
        };
        // The rounding of the initial state and the error of the rule act as a delay.
        let delay = estimate::of_period(&orbit, perturbed).ok()? / orbit.period;
        let motion = SegmentedMotion::single_segment(solution);
        let difference = self
            .difference(&motion, &time_scaled(&orbit, &motion, delay))
            .ok()?;
        let method_text = "quadrature".to_owned();
        let remarks = format!(
            "  accuracy {}: {method_text} (conservative, periodic motion), {} quadrature points\n{}",
            two_digits(accuracy),
            orbit.points,
            describe_difference(&difference)
        );
        Some(ComputedMotion {
            motion,
            method_text,
            remarks,
            accuracy: Some([accuracy, difference.largest()]),
        })
    }
}

/// The result of a refinement.
struct Refinement {
    tolerance: f64,
    motion: SegmentedMotion,
    difference: Difference,
    runs: usize,
}

/// The interval of the coordinate that a motion of one degree of freedom visits.
fn visited_range(motion: &SegmentedMotion) -> [f64; 2] {
    let steps = motion.steps().filter_map(|(_, point)| point.y.first());
    steps.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &q| {
        [a.min(q), b.max(q)]
    })
}

/// Whether a motion reached its end.
fn reached_end(motion: &SegmentedMotion) -> bool {
    motion.failure.is_none()
}

/// The same motion, delayed by a fraction of the time.
fn time_scaled(orbit: &Orbit, motion: &SegmentedMotion, fraction: f64) -> SegmentedMotion {
    let shifted = |point: &OdeState| {
        let ReducedState { q, q_dot, .. } = orbit.state_at(point.t * (1.0 + fraction));
        OdeState {
            t: point.t,
            y: vec![q, q_dot],
        }
    };
    let solutions = motion.segments.iter().map(|(_, solution)| solution);
    SegmentedMotion::single_segment(Solution {
        steps: solutions
            .clone()
            .flat_map(|t| t.steps.last().cloned())
            .collect(),
        samples: solutions
            .flat_map(|t| t.samples.iter().map(shifted))
            .collect(),
        ..Solution::default()
    })
}

fn describe_difference(difference: &Difference) -> String {
    let Difference {
        coordinate,
        energy,
        reactions,
        ..
    } = difference;
    format!(
        "  estimated errors over the whole motion: {coordinate:.1e} in the coordinates, {energy:.1e} of the largest \
         kinetic energy, {reactions:.1e} of the largest reaction\n"
    )
}

/// A number with two significant digits.
fn two_digits(value: f64) -> String {
    let short = format!("{value:.1e}");
    short.replace(".0e", "e")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

    use super::*;
    use dwell_dynamics::loads_with_drives;

    fn text(case: &str) -> String {
        let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");
        std::fs::read_to_string(format!("{cases}/{case}/scene.toml")).unwrap()
    }

    /// With the loads through which the drives act.
    fn with_drive_loads(scene: &Scene) -> Scene {
        let mut loaded_scene = scene.clone();
        loaded_scene.loads =
            loads_with_drives(&scene.mechanism, &scene.loads, &scene.drives).unwrap();
        loaded_scene
    }

    /// What is promised is kept, for every case that moves under loads and for free ones, against a method
    /// that was not picked. The truth's own error is that of a tenth of its tolerance.
    #[test]
    fn val_what_is_promised_is_kept() {
        for case in CASES {
            let scene = Scene::parse(case, &text(case)).unwrap();
            let loaded_scene = with_drive_loads(&scene);
            let problem =
                FreeMotionProblem::new(&scene, &loaded_scene, scene.motion.as_ref().unwrap())
                    .unwrap();
            let duration = problem.duration().unwrap();
            let sample_interval = duration / 200.0;
            let by = |tolerance: f64| {
                let options = Options {
                    sample_interval: Some(sample_interval),
                    ..Options::new(Method::Tsit45, tolerance)
                };
                problem.solve(&scene, duration, &options).unwrap()
            };
            let reference = by(1e-13);
            // A tenth of the tolerance has a tenth of the error, here with as much again to spare.
            let reference_error = 0.2
                * problem
                    .difference(&reference, &by(1e-12))
                    .unwrap()
                    .largest();
            for exponent in 2..13 {
                let accuracy = 10_f64.powi(-exponent);
                let found = problem
                    .to_accuracy(&scene, accuracy, duration, sample_interval)
                    .unwrap();
                let difference = problem
                    .difference(&reference, &found.motion)
                    .unwrap()
                    .largest();
                let [_, estimate] = found.accuracy.unwrap();
                println!(
                    "{case} {accuracy:e}: {difference:.1e} of {estimate:.1e}, floor {reference_error:.1e}"
                );
                assert!(
                    difference <= estimate.max(reference_error),
                    "{case} {accuracy:e}: {difference:e} {estimate:e} {reference_error:e}"
                );
                // What cannot be promised is beyond the digits of a motion that multiplies every rounding.
                assert!(
                    estimate <= accuracy || accuracy < 1e-9,
                    "{case}: {estimate:e}"
                );
            }
        }
    }

    /// What is picked for `text` to an accuracy, which must be kept against `truth`.
    fn picked_method(text: &str, accuracy: f64, duration: f64, reference: (Method, f64)) -> String {
        let scene = Scene::parse("scene", text).unwrap();
        let loaded_scene = with_drive_loads(&scene);
        let problem =
            FreeMotionProblem::new(&scene, &loaded_scene, scene.motion.as_ref().unwrap()).unwrap();
        let sample_interval = duration / 200.0;
        let found = problem
            .to_accuracy(&scene, accuracy, duration, sample_interval)
            .unwrap();
        let options = Options {
            sample_interval: Some(sample_interval),
            ..Options::new(reference.0, reference.1)
        };
        let reference = problem.solve(&scene, duration, &options).unwrap();
        let difference = problem
            .difference(&reference, &found.motion)
            .unwrap()
            .largest();
        let [accuracy, estimate] = found.accuracy.unwrap();
        println!("{difference:e} {estimate:e} {}", found.remarks);
        assert!(
            difference <= estimate && estimate <= accuracy,
            "{difference:e} {estimate:e}"
        );
        found.method_text
    }

    /// Forty seconds under a force, a couple and a motor.
    #[test]
    fn a_long_motion_goes_on_a_table() {
        let text = text("four-bar").replace("duration = 0.6", "duration = 40");
        let method_text = picked_method(&text, 1e-8, 40.0, (Method::Tsit45, 1e-12));
        assert!(method_text.contains("on a table"), "{method_text}");
    }

    /// A crank in thick oil: its speed settles within milliseconds of each change of the couple.
    #[test]
    fn what_is_stiff_goes_by_bdf() {
        let text = text("crank-rocker").replace("periods = 10", "duration = 2")
            + "\n[loads]\npush = { torque = [\"ground\", \"crank\"], magnitude = \"2000*sin(3*t)\" }\n\
               brake = { torsion-damper = [\"ground\", \"crank\"], constant = 2000 }\n";
        let method_text = picked_method(&text, 1e-6, 2.0, (Method::Esdirk34, 1e-11));
        assert!(method_text.starts_with("BDF"), "{method_text}");
    }

    const CASES: [&str; 9] = [
        "andrews",
        "slider-crank-friction",
        "double-pendulum",
        "five-bar",
        "boom",
        "n-four-bar-a02",
        "crank-rocker",
        "pendulum-a01",
        "single-dwell",
    ];
}
