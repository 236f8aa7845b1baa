//! The error that is estimated of a result, and reported with it.
//!
//! - An evaluation: its difference from the same evaluation in numbers of two words, and the rounding of the
//!   constants that the model was compiled to.
//! - A motion: its difference from a second run, at a tenth of the tolerance, times a measured factor.
//! - A period by quadrature: its change where the start is changed by its rounding, and what the series leaves.

use dwell_dynamics::{DynamicsError, Method, Options, Orbit};
use dwell_geometry::{PlaceError, Scalar, Wide};
use dwell_kinetostatics::{Coefficients, Model};

/// A run at a tenth of the tolerance has 1/14 (order 5) to a third (order 1 or 2) of the error, so that the
/// difference of both is at least 0.67 of it; the integrators' own irregularity takes up the rest.
const SAFETY: f64 = 2.5;
/// Below this tolerance a second run by the same method would only show the same rounding.
const FINEST: f64 = 2e-14;
/// Roundings, in last places, of the products and sums of masses and lengths that a model is compiled to.
const COMPILED: f64 = 2.0;

/// How a motion is run again to learn its error: at a tenth of the tolerance; where that is out of reach, by
/// the other kind of method.
pub fn second(options: &Options) -> Options {
    if options.absolute.min(options.relative) > FINEST {
        return Options {
            relative: 0.1 * options.relative,
            absolute: 0.1 * options.absolute,
            ..*options
        };
    }
    let method = match options.method {
        Method::Tsit45 => Method::Bdf,
        _ => Method::Tsit45,
    };
    Options { method, ..*options }
}

/// The error of a quantity at the end of a motion, from its values in both runs at the same times: the
/// largest difference in the last eighth of them, for at one time it may be small by chance. `rounding` is what
/// no second run can show, in the quantity's unit.
pub fn of_motion(first: &[f64], again: &[f64], rounding: f64) -> f64 {
    let recent = (first.len() - first.len() / 8).saturating_sub(1);
    let apart = first
        .iter()
        .zip(again)
        .skip(recent)
        .map(|(a, b)| (a - b).abs());
    SAFETY * apart.fold(0.0, f64::max) + rounding
}

/// The rounding error of a value, by the same in two words; `size` is what its terms are made of.
pub fn of_value(value: f64, finer: Wide, size: f64) -> f64 {
    (Wide::lift(value) - finer).hi.abs() + COMPILED * f64::EPSILON * value.abs().max(size)
}

/// The reduced coefficients at `q` (rad or m), and the estimated rounding error of each.
///
/// # Errors
/// [`PlaceError`] when there is no pose at `q`.
pub fn reduced(model: &Model, q: f64) -> Result<(Coefficients, Coefficients), PlaceError> {
    let (mut plain, mut finer) = (model.coefficients::<f64>(), model.coefficients::<Wide>());
    model.reduce(q, &mut model.workspace(), &mut plain)?;
    model.reduce(Wide::lift(q), &mut model.workspace(), &mut finer)?;
    let list = |of: &[f64], finer: &[Wide]| {
        let size = of.iter().fold(0.0_f64, |size, v| size.max(v.abs()));
        let pairs = of.iter().zip(finer);
        pairs.map(|(&v, &w)| of_value(v, w, size)).collect()
    };
    let errors = Coefficients {
        m: of_value(plain.m, finer.m, 0.0),
        half_dm: of_value(plain.half_dm, finer.half_dm, 0.0),
        a: list(&plain.a, &finer.a),
        b: list(&plain.b, &finer.b),
    };
    Ok((plain, errors))
}

/// The error of an orbit's period, s: what it changes by where the speed at the start is changed by a few
/// roundings either way (`at` is the orbit at so many times the speed), and what its series leaves.
///
/// # Errors
/// Where the changed start has no such orbit: within its rounding it creeps up to a summit.
pub fn of_period(
    orbit: &Orbit,
    at: impl Fn(f64) -> Result<Orbit, DynamicsError>,
) -> Result<f64, DynamicsError> {
    const ROUNDINGS: f64 = 2.0;
    let mut moved = 0.0_f64;
    for side in [-1.0, 1.0] {
        let beside = at(1.0 + side * ROUNDINGS * f64::EPSILON)?;
        moved = moved.max((beside.period - orbit.period).abs());
    }
    // Roundings of a sum add up as the root of its terms.
    let summed = ROUNDINGS + 0.5 * (orbit.points as f64).sqrt();
    let own = (orbit.rounding + summed * f64::EPSILON) * orbit.period;
    Ok(moved + own)
}
