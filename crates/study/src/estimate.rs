//! Error estimates of results.
//!
//! - An evaluation: its difference from the same evaluation in double-double arithmetic, plus the rounding of the
//!   compiled constants.
//! - A motion: its difference from a second run at a tenth of the tolerance, times a measured factor.
//! - A period by quadrature: its change under the rounding of the initial state, plus the tail of the series.

use dwell_dynamics::{DynamicsError, Method, Options, Orbit};
use dwell_geometry::PositionError;
use dwell_kinetostatics::{Coefficients, ReducibleModel};
use dwell_numerics::{DoubleDouble, Scalar};

/// A run at a tenth of the tolerance has 1/14 (order 5) to a third (order 1 or 2) of the error, so the difference of
/// both is at least 0.67 of it; the rest covers the irregularity of the integrators.
const SAFETY_FACTOR: f64 = 2.5;
/// Below this tolerance a second run by the same method would only show the same rounding.
const MIN_TOLERANCE: f64 = 2e-14;
/// Rounding of the compiled products and sums of masses and lengths, in units in the last place.
const COMPILED_ROUNDINGS: f64 = 2.0;

/// Options of the second run that estimates an error: a tenth of the tolerance; if that is out of reach, the other
/// kind of method.
pub fn comparison_options(options: &Options) -> Options {
    if options.atol.min(options.rtol) > MIN_TOLERANCE {
        return Options {
            rtol: 0.1 * options.rtol,
            atol: 0.1 * options.atol,
            ..*options
        };
    }
    let method = match options.method {
        Method::Tsit45 => Method::Bdf,
        Method::Bdf | Method::Esdirk34 | Method::TrBdf2 | Method::Dop853 => Method::Tsit45,
    };
    Options { method, ..*options }
}

/// The error of a quantity at the end of a motion, from its values in both runs at the same times: the largest
/// difference in the last eighth of them, since at one time it may be small by chance. `rounding` is the error that a
/// second run cannot show, in the quantity's unit.
pub fn of_motion(first: &[f64], second: &[f64], rounding: f64) -> f64 {
    let recent = (first.len() - first.len() / 8).saturating_sub(1);
    let second = second.get(recent..).unwrap_or_default();
    over_motion(&first[recent..], second, rounding)
}

/// The largest error of a quantity over a motion, as [`of_motion`] finds it at the end.
pub fn over_motion(first: &[f64], second: &[f64], rounding: f64) -> f64 {
    let differences = first.iter().zip(second).map(|(a, b)| (a - b).abs());
    SAFETY_FACTOR * differences.fold(0.0, f64::max) + rounding
}

/// The error of a number that two runs yield, the second at a tenth of the tolerance.
pub(crate) fn of_number(first: f64, second: f64) -> f64 {
    SAFETY_FACTOR * (first - second).abs() + 4.0 * f64::EPSILON * first.abs()
}

/// The rounding error of a value, from the same value in double-double; `size` is the magnitude of its terms.
pub fn of_value(value: f64, finer: DoubleDouble, size: f64) -> f64 {
    (DoubleDouble::from_f64(value) - finer).hi.abs()
        + COMPILED_ROUNDINGS * f64::EPSILON * value.abs().max(size)
}

/// An error relative to a scale; 0 if there is no error, whatever the scale.
pub(crate) fn relative(error: f64, scale: f64) -> f64 {
    if error == 0.0 { 0.0 } else { error / scale }
}

/// A quantity below this fraction of the reference of its unit is zero within rounding.
pub(crate) const ZERO_RATIO: f64 = 1e-12;

/// Whether a quantity whose largest value is `size` is zero within rounding; `reference` is the size of quantities of
/// its unit.
pub(crate) fn is_rounding(size: f64, reference: f64) -> bool {
    size <= ZERO_RATIO * reference
}

/// The scale of the relative error of a quantity: its largest value, or the reference where that is only rounding.
pub(crate) fn error_scale(size: f64, reference: f64) -> f64 {
    if is_rounding(size, reference) {
        reference
    } else {
        size
    }
}

/// The difference in an energy balance beyond the rounding of its sum, J. With a potential energy of 10 J, for example, the kinetic
/// energy of a small oscillation, 5e-8 J, has only eight digits.
pub(crate) fn beyond_rounding(difference: f64, kinetic: f64, potential: f64) -> f64 {
    (difference - 4.0 * f64::EPSILON * (kinetic + potential)).max(0.0)
}

/// The reduced coefficients at `q` (rad or m), and the estimated rounding error of each.
///
/// # Errors
/// [`PositionError`] when there is no pose at `q`.
pub fn coefficients_with_errors<M: ReducibleModel>(
    model: &M,
    q: f64,
) -> Result<(Coefficients, Coefficients), PositionError> {
    let reactions = model.reaction_count();
    let (mut values, mut finer) = (
        Coefficients::buffer(reactions),
        Coefficients::buffer(reactions),
    );
    model.reduce_at(q, &mut model.pass_workspace(), &mut values)?;
    let exact_q = DoubleDouble::from_f64(q);
    model.reduce_at(exact_q, &mut model.pass_workspace(), &mut finer)?;
    let list = |of: &[f64], finer: &[DoubleDouble]| {
        let size = of.iter().fold(0.0_f64, |size, v| size.max(v.abs()));
        let pairs = of.iter().zip(finer);
        pairs.map(|(&v, &w)| of_value(v, w, size)).collect()
    };
    let errors = Coefficients {
        m: of_value(values.m, finer.m, 0.0),
        half_dm: of_value(values.half_dm, finer.half_dm, 0.0),
        a: list(&values.a, &finer.a),
        b: list(&values.b, &finer.b),
    };
    Ok((values, errors))
}

/// The error of an orbit's period, s: its change when the initial speed changes by a few roundings either way (`at`
/// is the orbit at this multiple of the speed), plus the tail of its series.
///
/// # Errors
/// If the changed initial state has no such orbit: within rounding the motion is asymptotic to an equilibrium.
pub fn of_period(
    orbit: &Orbit,
    at: impl Fn(f64) -> Result<Orbit, DynamicsError>,
) -> Result<f64, DynamicsError> {
    const ROUNDINGS: f64 = 2.0;
    let mut change = 0.0_f64;
    for side in [-1.0, 1.0] {
        let perturbed = at(1.0 + side * ROUNDINGS * f64::EPSILON)?;
        change = change.max((perturbed.period - orbit.period).abs());
    }
    // Rounding errors of a sum grow as the square root of the number of terms.
    let summed = ROUNDINGS + 0.5 * (orbit.points as f64).sqrt();
    let series_error = (orbit.tail + summed * f64::EPSILON) * orbit.period;
    Ok(change + series_error)
}
