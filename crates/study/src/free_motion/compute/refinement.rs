//! A motion at finer and finer tolerances, until two runs agree.

use crate::explain::StudyError;
use crate::free_motion::compute::difference::difference_of;
use crate::free_motion::compute::{ChartedProblem, Difference, MotionOf, SegmentedMotion};
use dwell_dynamics::Method;

/// Tolerance of the coarse run.
pub(super) const COARSE_TOLERANCE: f64 = 1e-4;
/// The finest tolerances: below them only rounding changes, and Newton's method cannot meet them.
pub(super) const MIN_TOLERANCE: f64 = 1e-14;
const MIN_IMPLICIT_TOLERANCE: f64 = 1e-13;
/// First tolerance, relative to the required accuracy: an integrator's error is tens of times its tolerance.
pub(super) const FIRST_TOLERANCE_RATIO: f64 = 1e-2;
/// Error aimed at after an error that was too large, relative to the required accuracy.
const TARGET_ERROR_RATIO: f64 = 0.2;
/// Smallest and largest factor of one refinement of the tolerance.
const TOLERANCE_FACTORS: [f64; 2] = [1e-4, 0.1];
/// The error of the kept run, over its difference from the finer one, is above 5 only where both err alike to a fifth: of
/// 1218 errors of random machines of two seeds in none (the largest is 4.3); above 2.5 in three of 583.
const SAFETY_FACTOR: f64 = 5.0;
/// How many times as many steps a run at a tenth of the tolerance must take for the difference to be an error of all parts
/// of the motion: where switches and narrow features decide the steps, two runs err alike.
const INDEPENDENT_STEPS: f64 = 1.2;
/// The further factor to the next tolerance where they do.
const EQUAL_STEPS_FACTOR: f64 = 1e-2;
/// Maximum number of runs.
const MAX_RUNS: usize = 6;

/// How a motion may be computed: by a method, and on a table if the interval that it visits is given.
pub(super) type Candidate = (Method, Option<[f64; 2]>);

/// A motion at a tolerance.
pub(super) type Run<M> = (f64, M);

/// The result of a refinement.
pub(crate) struct Refinement<M> {
    /// The tolerance of the run that is kept.
    pub(crate) tolerance: f64,
    pub(crate) motion: M,
    /// The finer run with which it was compared.
    pub(crate) finer: M,
    /// The estimated error of what is kept.
    pub(crate) difference: Difference,
    pub(crate) runs: usize,
}

/// Repeats the motion at finer tolerances until two runs agree; keeps the one whose error their difference is: the
/// coarser. `None` if a run cannot be made.
pub(super) fn refine<P: ChartedProblem>(
    problem: &P,
    accuracy: f64,
    method: Method,
    last: Option<Run<MotionOf<P>>>,
    solve: &dyn Fn(f64) -> Result<Option<MotionOf<P>>, StudyError>,
) -> Result<Option<Refinement<MotionOf<P>>>, StudyError> {
    let min_tolerance = match method.is_implicit() {
        true => MIN_IMPLICIT_TOLERANCE,
        false => MIN_TOLERANCE,
    };
    let Some((mut kept, mut factor)) = first_run::<P>(accuracy, min_tolerance, last, solve)? else {
        return Ok(None);
    };
    let mut runs = 1;
    loop {
        let next = (kept.0 * factor).max(min_tolerance);
        let Some(motion) = solve(next)? else {
            return Ok(None);
        };
        let finer = (next, motion);
        runs += 1;
        let is_finest = next <= 1.01 * min_tolerance || runs >= MAX_RUNS;
        let is_independent = step_growth(&kept, &finer) >= INDEPENDENT_STEPS;
        if !is_independent && !is_finest {
            factor *= EQUAL_STEPS_FACTOR;
            continue;
        }
        let difference = difference_of(problem, [&kept.1, &finer.1])?;
        let least = if is_independent { 0.0 } else { next };
        let difference = difference.scaled(SAFETY_FACTOR).with_minimum(least);
        let largest = difference.largest();
        if largest <= accuracy || is_finest {
            let (tolerance, motion) = kept;
            return Ok(Some(Refinement {
                tolerance,
                motion,
                finer: finer.1,
                difference,
                runs,
            }));
        }
        let [min_factor, max_factor] = TOLERANCE_FACTORS;
        factor = match largest.is_finite() {
            true => TARGET_ERROR_RATIO * accuracy / largest,
            false => max_factor,
        };
        factor = factor.clamp(min_factor, max_factor);
        kept = finer;
    }
}

/// The first run of a refinement, and the factor to the tolerance of the next; `None` if it cannot be made.
type FirstRun<M> = Option<(Run<M>, f64)>;

/// Makes it.
fn first_run<P: ChartedProblem>(
    accuracy: f64,
    min_tolerance: f64,
    coarse: Option<Run<MotionOf<P>>>,
    solve: &dyn Fn(f64) -> Result<Option<MotionOf<P>>, StudyError>,
) -> Result<FirstRun<MotionOf<P>>, StudyError> {
    let [_, max_factor] = TOLERANCE_FACTORS;
    let first = (FIRST_TOLERANCE_RATIO * accuracy).clamp(10.0 * min_tolerance, COARSE_TOLERANCE);
    let coarse = match coarse {
        Some(run) if max_factor * run.0 <= first => return Ok(Some((run, max_factor))),
        coarse => coarse,
    };
    let run = solve(first)?.map(|motion| (first, motion));
    Ok(run.map(|run| {
        // From the coarse run it is known whether tolerances decide the steps.
        let is_limited = coarse.is_some_and(|coarse| {
            let decades = (coarse.0 / run.0).log10();
            step_growth(&coarse, &run) < INDEPENDENT_STEPS.powf(decades)
        });
        let further = if is_limited { EQUAL_STEPS_FACTOR } else { 1.0 };
        (run, further * max_factor)
    }))
}

/// The number of steps of a run over that of a coarser one.
fn step_growth<C>(coarser: &Run<SegmentedMotion<C>>, finer: &Run<SegmentedMotion<C>>) -> f64 {
    let [coarser, finer] = [coarser, finer].map(|(_, motion)| motion.statistics.steps as f64);
    finer / coarser.max(1.0)
}
