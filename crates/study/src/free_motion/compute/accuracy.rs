//! A motion to a required accuracy, by the cheapest method whose error estimate meets it.
//!
//! 1. A conservative periodic motion is computed by quadrature, whatever its duration.
//! 2. A smooth motion is integrated by DOP853, a stiff one by BDF. A coarse run decides: by the fraction of its steps
//!    that stability limits, and by the cost of BDF for the same motion.
//! 3. If more evaluations are expected than building a table of the machine costs, the motion is integrated on a table.
//! 4. The tolerance is found by trial: each run is compared with a finer one, at a tenth of its tolerance or less, over
//!    the whole motion, in coordinates, energy and reactions. The run whose error that difference shows is kept: of the
//!    finer run nothing is known but that it is better, ten or a hundred thousand times.

use crate::explain::StudyError;
use crate::free_motion::compute::quadrature::by_quadrature;
use crate::free_motion::compute::refinement::{
    COARSE_TOLERANCE, Candidate, FIRST_TOLERANCE_RATIO, MIN_TOLERANCE, Refinement, Run, refine,
};
use crate::free_motion::compute::{ChartedProblem, ComputedMotion, Difference, MotionOf};
use dwell_dynamics::{DynamicsError, Method, Options, Statistics};
use dwell_findings::Record;

/// Error of BDF relative to DOP853 at the same tolerance: 2 to 240 in ten revolutions of m = 2 + cos q, growing
/// with finer tolerances.
const BDF_ERROR_RATIO: f64 = 50.0;
/// Fraction of stiff steps above which stability, not accuracy, determines the cost.
const MAX_STIFF_FRACTION: f64 = 0.05;
/// Number of evaluations above which a table saves time: building two to 1e-9 takes 2.4 to 9.4 ms under loads, as long
/// as up to 20 000 evaluations of the machine, and saves 80 to 90 % of each (docs/performance.md).
const TABLE_BREAK_EVEN: f64 = 30_000.0;
/// Maximum number of steps of a coarse run.
const MAX_COARSE_STEPS: usize = 100_000;

/// A motion to an accuracy, by the method that was found.
struct FoundMotion<M> {
    found: Refinement<M>,
    method_text: String,
    /// How it was found.
    how: String,
}

/// The motion to `accuracy`: rad (lengths: relative to the largest change), and relative to the largest kinetic energy and the largest
/// reaction; by the cheapest method that reaches it, else by the one that comes nearest.
fn find_motion<P: ChartedProblem>(
    problem: &P,
    accuracy: f64,
    duration: f64,
    sample_interval: f64,
) -> Result<FoundMotion<MotionOf<P>>, StudyError> {
    let coarse_run = |method: Method| {
        let options = Options {
            max_steps: MAX_COARSE_STEPS,
            sample_interval: Some(sample_interval),
            ..Options::new(method, COARSE_TOLERANCE)
        };
        problem.by_method(duration, &options)
    };
    let explicit = coarse_run(Method::Dop853)?;
    let (methods, expected_evaluations, reason) =
        rank_methods(problem, &explicit, || coarse_run(Method::Bdf), accuracy)?;
    let mut candidates: Vec<Candidate> = methods.map(|method| (method, None)).to_vec();
    if expected_evaluations > TABLE_BREAK_EVEN
        && let Some(visited) = problem.range_for_table(&explicit)
    {
        candidates.insert(0, (methods[0], Some(visited)));
    }
    let is_comparable = candidates[0] == (Method::Dop853, None) && explicit.failure.is_none();
    let first = is_comparable.then_some((COARSE_TOLERANCE, explicit));
    let solve = |(method, visited): Candidate, tolerance: f64| {
        let options = Options {
            sample_interval: Some(sample_interval),
            ..Options::new(method, tolerance)
        };
        match visited {
            Some(visited) => problem.on_table(visited, duration, &options),
            None => problem.by_method(duration, &options).map(Some),
        }
    };
    let best = best_of(problem, &candidates, accuracy, first, &solve)?;
    let ((method, visited), found) =
        best.ok_or_else(|| problem.explain(&DynamicsError::DurationTooShort))?;
    let suffix = visited.map_or("", |_| " on a table");
    let reason = match method == methods[0] {
        true => reason,
        false => format!("as {} does not reach the accuracy", methods[0].name()),
    };
    let tolerance = two_digits(found.tolerance);
    let method_text = format!("{}{suffix}, tolerance {tolerance}", method.name());
    Ok(FoundMotion {
        how: format!("{method_text}, {reason}; {} runs", found.runs),
        found,
        method_text,
    })
}

/// The first candidate that reaches the accuracy, or else the one that comes nearest to it.
fn best_of<P: ChartedProblem>(
    problem: &P,
    candidates: &[Candidate],
    accuracy: f64,
    mut last: Option<Run<MotionOf<P>>>,
    solve: &dyn Fn(Candidate, f64) -> Result<Option<MotionOf<P>>, StudyError>,
) -> Result<Best<MotionOf<P>>, StudyError> {
    let mut best: Best<MotionOf<P>> = None;
    for &candidate in candidates {
        let by_candidate = |tolerance| solve(candidate, tolerance);
        let refined = refine(problem, accuracy, candidate.0, last.take(), &by_candidate)?;
        let Some(refinement) = refined else { continue };
        let largest = refinement.difference.largest();
        let is_better = |(_, best): &(_, Refinement<_>)| largest < best.difference.largest();
        if best.as_ref().is_none_or(is_better) {
            best = Some((candidate, refinement));
        }
        if largest <= accuracy {
            break;
        }
    }
    Ok(best)
}

/// The candidate that comes nearest, if any can be run.
type Best<M> = Option<(Candidate, Refinement<M>)>;

/// The methods to try, the cheaper first; the expected number of evaluations; and the reason.
fn rank_methods<P: ChartedProblem>(
    problem: &P,
    explicit: &MotionOf<P>,
    implicit: impl FnOnce() -> Result<MotionOf<P>, StudyError>,
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
    let reached = explicit.failure.is_none();
    let reason = |method| reason_for(method, stiff_fraction);
    if reached && stiff_fraction <= MAX_STIFF_FRACTION {
        return Ok((smooth, by_explicit, reason(Method::Dop853)));
    }
    let implicit = implicit()?;
    let freedoms = problem.machine().free().len();
    let by_implicit = equivalent_evaluations(&implicit.statistics, freedoms)
        * (BDF_ERROR_RATIO * refinement_ratio).powf(1.0 / 6.0);
    Ok(if reached && by_explicit <= by_implicit {
        (smooth, by_explicit, reason(Method::Dop853))
    } else {
        let methods = [Method::Bdf, Method::Dop853];
        (methods, by_implicit, reason(Method::Bdf))
    })
}

/// The work of BDF in evaluations: a column of a Jacobian is one in dual numbers, a step costs two more.
fn equivalent_evaluations(statistics: &Statistics, freedoms: usize) -> f64 {
    let columns = 4 * freedoms;
    (statistics.evaluations + columns * statistics.jacobians + 2 * statistics.steps) as f64
}

/// The motion to an accuracy, by quadrature or else as [`find_motion`] says.
pub(crate) fn to_accuracy<P: ChartedProblem>(
    problem: &P,
    accuracy: f64,
    duration: f64,
    sample_interval: f64,
) -> Result<ComputedMotion<P::Chart>, StudyError> {
    if let Some(found) = by_quadrature(problem, accuracy, duration, sample_interval) {
        return Ok(found);
    }
    let by_method = find_motion(problem, accuracy, duration, sample_interval)?;
    let found = by_method.found;
    let (remarks, mut record) = found.difference.remarks(accuracy, &by_method.how);
    record.add("tolerance", "", found.tolerance);
    Ok(ComputedMotion {
        method_text: by_method.method_text,
        remarks,
        record,
        accuracy: Some([accuracy, found.difference.largest()]),
        comparison: Some(found.finer),
        motion: found.motion,
        ..ComputedMotion::default()
    })
}

impl Difference {
    /// What is said of a motion with this error, how it was computed, and the numbers in it.
    pub(super) fn remarks(&self, accuracy: f64, how: &str) -> (String, Record) {
        let (coordinate, energy) = (self.coordinate, self.energy_error());
        let (required, reactions) = (two_digits(accuracy), self.reactions);
        let remarks = format!(
            "  accuracy {required}: {how}\n  estimated errors over the whole motion: {coordinate:.1e} in the coordinates, \
             {energy:.1e} of the largest kinetic energy, {reactions:.1e} of the largest reaction\n"
        );
        let mut record = Record::default();
        record.add("accuracy", "", accuracy);
        record.add("error.coordinates", "", coordinate);
        record.add("error.kinetic_energy", "", energy);
        record.add("error.reactions", "", reactions);
        (remarks, record)
    }
}

/// Why a method is chosen, where so many steps of a coarse run of DOP853 were stiff: stiffness is the reason only where it
/// decided.
fn reason_for(method: Method, stiff_fraction: f64) -> String {
    let is_stiff = stiff_fraction > MAX_STIFF_FRACTION;
    let percent = 100.0 * stiff_fraction;
    let stiff = format!("{percent:.0} % of the steps of a coarse run are stiff");
    match (method.is_implicit(), is_stiff) {
        (false, true) => format!("{stiff}, but BDF is expected to cost more"),
        (false, false) => "the motion is smooth".to_owned(),
        (true, true) => stiff,
        (true, false) => "a coarse run of DOP853 does not reach the end".to_owned(),
    }
}

/// A number with two significant digits.
pub(crate) fn two_digits(value: f64) -> String {
    let short = format!("{value:.1e}");
    short.replace(".0e", "e")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::free_motion::compute::difference::difference;
    use crate::free_motion::compute::{FreeMotionProblem, MotionProblem as _};
    use crate::models::with_drive_loads;
    use dwell_scene::PlaneScene;

    fn text(case: &str) -> String {
        let cases = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");
        std::fs::read_to_string(format!("{cases}/{case}/scene.toml")).unwrap()
    }

    /// The accuracy is reached for every case, with and without loads, compared with a method that was not
    /// selected. The reference's own error is that of a tenth of its tolerance.
    #[test]
    fn val_what_is_promised_is_kept() {
        for case in CASES {
            let scene = PlaneScene::parse(case, &text(case)).unwrap();
            let loaded_scene = with_drive_loads(&scene).unwrap();
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
                problem.solve(duration, &options).unwrap()
            };
            let reference = by(1e-13);
            // A tenth of the tolerance has a tenth of the error, here with as much again to spare.
            let reference_error = 0.2
                * difference(&problem, [&reference, &by(1e-12)])
                    .unwrap()
                    .largest();
            for exponent in 2..13 {
                let accuracy = 10_f64.powi(-exponent);
                let found = to_accuracy(&problem, accuracy, duration, sample_interval).unwrap();
                let off = difference(&problem, [&reference, &found.motion]).unwrap();
                let off = off.largest();
                let [_, estimate] = found.accuracy.unwrap();
                println!(
                    "{case} {accuracy:e}: {off:.1e} of {estimate:.1e}, floor {reference_error:.1e}"
                );
                assert!(
                    off <= estimate.max(reference_error),
                    "{case} {accuracy:e}: {off:e} {estimate:e} {reference_error:e}"
                );
                // What cannot be promised is beyond the digits of a motion that multiplies every rounding.
                assert!(
                    estimate <= accuracy || accuracy < 1e-9,
                    "{case}: {estimate:e}"
                );
            }
        }
    }

    /// The method that is selected for `text`; its result must agree with a reference to the accuracy.
    fn picked_method(text: &str, accuracy: f64, duration: f64, reference: (Method, f64)) -> String {
        let scene = PlaneScene::parse("scene", text).unwrap();
        let loaded_scene = with_drive_loads(&scene).unwrap();
        let problem =
            FreeMotionProblem::new(&scene, &loaded_scene, scene.motion.as_ref().unwrap()).unwrap();
        let sample_interval = duration / 200.0;
        let found = to_accuracy(&problem, accuracy, duration, sample_interval).unwrap();
        let options = Options {
            sample_interval: Some(sample_interval),
            ..Options::new(reference.0, reference.1)
        };
        let reference = problem.solve(duration, &options).unwrap();
        let off = difference(&problem, [&reference, &found.motion]).unwrap();
        let off = off.largest();
        let [accuracy, estimate] = found.accuracy.unwrap();
        println!("{off:e} {estimate:e} {}", found.remarks);
        assert!(
            off <= estimate && estimate <= accuracy,
            "{off:e} {estimate:e}"
        );
        found.method_text
    }

    /// DOP853 is never chosen because of stiffness, and BDF never for want of it.
    #[test]
    fn stiffness_is_the_reason_only_where_it_decided() {
        for stiff_fraction in [0.0, 0.04, 0.06, 0.9] {
            let reason = reason_for(Method::Dop853, stiff_fraction);
            let expected = match stiff_fraction > MAX_STIFF_FRACTION {
                true => "but BDF is expected to cost more",
                false => "smooth",
            };
            assert!(reason.ends_with(expected), "{stiff_fraction}: {reason}");
        }
        assert_eq!(
            reason_for(Method::Bdf, 0.9),
            "90 % of the steps of a coarse run are stiff"
        );
        let unfinished = reason_for(Method::Bdf, 0.01);
        assert!(!unfinished.contains("stiff"), "{unfinished}");
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
               brake = { rotational-damper = [\"ground\", \"crank\"], damping = 2000 }\n";
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
