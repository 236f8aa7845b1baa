//! The estimated error of a motion, from a second run at a tenth of the tolerance.

use crate::estimate::{self, is_rounding};
use crate::explain::StudyError;
use crate::free_motion::compute::description::balance;
use crate::free_motion::compute::difference::pair_by_time;
use crate::free_motion::compute::{ChartedProblem, ComputedMotion, LARGE_ERROR, MotionOf};
use crate::number_format::digits;
use crate::ranges::extent;
use crate::trajectory::compute::TrajectorySample;
use dwell_dynamics::Options;
use dwell_findings::Record;
use dwell_kinetostatics::{MachineModel as _, ReducibleModel as _};

/// A sample of each of two runs at the same time.
type SamplePair<'a> = (&'a TrajectorySample, &'a TrajectorySample);

/// The largest error of a quantity over a motion, by the samples of two runs; `rounding` is what the second cannot show.
fn error_of(pairs: &[SamplePair<'_>], of: impl Fn(&TrajectorySample) -> f64, rounding: f64) -> f64 {
    let values = pairs.iter().map(|(a, b)| (of(a), of(b)));
    let (one, two): (Vec<f64>, Vec<f64>) = values.unzip();
    estimate::over_motion(&one, &two, rounding)
}

/// Whether a coordinate that changes by this is at rest as far as its tolerance can tell.
fn is_at_rest(change: f64, atol: f64) -> bool {
    change <= 100.0 * atol
}

/// Why a motion is no result whose coordinate has this error and changes by this, where it is not. What hardly moves may have an
/// error as large as its tolerance.
fn large_error((name, unit): (&str, &str), error: f64, change: f64, atol: f64) -> Option<String> {
    let is_large = error > LARGE_ERROR * change + 100.0 * atol;
    is_large.then(|| {
        let change = digits(change, 3);
        format!(
            "the estimated error of {name} is {error:.1e} {unit}, and it moves by {change} {unit}"
        )
    })
}

/// The same of an energy with this error.
fn large_energy_error(error: f64) -> String {
    format!("the estimated error of the energy is {error:.1e} of the largest kinetic energy")
}

/// What a second run, by [`estimate::comparison_options`], says of a motion: its estimated error over its duration, and why it is
/// no result: the error is large, or holds for a part of it only.
pub(crate) fn estimate_error<P: ChartedProblem>(
    problem: &P,
    motion: &MotionOf<P>,
    second: Option<MotionOf<P>>,
    options: &Options,
) -> Result<ComputedMotion<P::Chart>, StudyError> {
    if motion.end_time() == 0.0 {
        return Ok(ComputedMotion::default());
    }
    let samples_of_second = || problem.samples(second.as_ref()?).ok();
    let (samples, others) = rayon::join(|| problem.samples(motion), samples_of_second);
    let samples = samples.map_err(|e| problem.explain(&e))?;
    let finer = estimate::comparison_options(options);
    let refinement = if finer.method == options.method {
        "a tenth of the tolerance".to_owned()
    } else {
        format!("the same tolerance by {}", finer.method.name())
    };
    // The last samples may be missing if an event ends one of the runs earlier.
    let pairs: Vec<SamplePair<'_>> = pair_by_time(&samples, others.as_deref().unwrap_or(&[]));
    let Some((last, _)) = pairs.last() else {
        let text = format!("  no error estimate: a second run, at {refinement}, fails\n");
        let inaccuracy = "its error cannot be estimated: a second run fails".to_owned();
        return Ok(ComputedMotion {
            remarks: text,
            inaccuracy: Some(inaccuracy),
            evaluated: [Some(samples), None],
            ..ComputedMotion::default()
        });
    };
    // An event may end one of the runs a sample earlier.
    let left = samples.iter().filter(|sample| sample.t > last.t);
    let is_whole = left.count() < 2;
    let until = digits(last.t, 6);
    let part = match is_whole {
        true => "over the whole motion".to_owned(),
        false => format!("until t = {until} s"),
    };
    // Not of the rows alone: all of them may be at rest.
    let (energies, ..) = balance(problem, motion);
    let mut record = Record::default();
    let (stated, large) = errors(problem, &pairs, energies, options.atol, &mut record);
    record.add("error.known_until", "s", last.t);
    let text = format!("  estimated error {part}:{stated} from a second run at {refinement}\n");
    let ends = (!is_whole)
        .then(|| format!("its error is known until t = {until} s only, where a second run ends"));
    Ok(ComputedMotion {
        remarks: text,
        record,
        inaccuracy: large.or(ends),
        comparison: second,
        evaluated: [Some(samples), others],
        ..ComputedMotion::default()
    })
}

/// The error of each free coordinate, and of the kinetic energy if anything moves; and the first that is large, of the energies by
/// their balance.
fn errors<P: ChartedProblem>(
    problem: &P,
    pairs: &[SamplePair<'_>],
    [max_kinetic, max_potential]: [f64; 2],
    atol: f64,
    record: &mut Record,
) -> (String, Option<String>) {
    let (mut text, mut large, mut moves) = (String::new(), None, false);
    for &i in problem.machine().free() {
        let [from, to] = extent(pairs.iter().map(|(a, _)| a.coordinate(i)));
        let unknown = initial_speed_error(problem, i) * (to - from);
        let rounding = 4.0 * f64::EPSILON * from.abs().max(to.abs()) + unknown;
        let error = error_of(pairs, |s| s.coordinate(i), rounding);
        let (name, unit) = problem.named_coordinate(i);
        text += &format!(" {error:.1e} {unit} in {name},");
        record.add(format!("error.{name}"), unit, error);
        large = large.or_else(|| large_error((name, unit), error, to - from, atol));
        moves |= !is_at_rest(to - from, atol);
    }
    if !is_rounding(max_kinetic, max_potential) {
        let rounding = 4.0 * f64::EPSILON * max_kinetic;
        let error = error_of(pairs, |s| problem.energy_balance(s), rounding) / max_kinetic;
        // Two runs that lose their energy alike do not show it: that the balance is zero is known without the second.
        let balances = pairs.iter().map(|(s, _)| problem.energy_balance(s).abs());
        let imbalance = balances.fold(0.0, f64::max) / max_kinetic;
        // Runs whose energies balance may still differ in phase, and so in the kinetic energy itproblem.
        let kinetic = error_of(pairs, |s| s.extra_values[0], rounding) / max_kinetic;
        let stated = error.max(imbalance).max(kinetic);
        text += &format!(" {stated:.1e} of the largest kinetic energy,");
        record.add("error.kinetic_energy", "", stated);
        // Of what is at rest, the energy is that of its rounding.
        if moves && error > LARGE_ERROR {
            large.get_or_insert_with(|| large_energy_error(error));
        }
        if moves && imbalance > LARGE_ERROR {
            large.get_or_insert_with(|| {
                    format!("the energy balance closes to {imbalance:.1e} of the largest kinetic energy only")
                });
        }
    }
    (text, large)
}

/// The relative rounding error of the initial speed, from that of the only coordinate's inertia.
fn initial_speed_error<P: ChartedProblem>(problem: &P, coordinate: usize) -> f64 {
    let model = problem.machine().model();
    if model.actuators() != 1 {
        return f64::EPSILON;
    }
    let start = problem.spec().initial_coordinates[coordinate];
    match estimate::coefficients_with_errors(&model.without_reactions(), start) {
        Ok((at, error)) if at.m > 0.0 => 0.5 * error.m / at.m,
        _ => f64::EPSILON,
    }
}
