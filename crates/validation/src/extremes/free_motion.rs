//! Motions: speeds, tolerances, revolutions.

use super::closed_forms::{dd, four_bar, root_inertia_integral};
use super::forms::{Form, FormModel};
use super::mechanisms::CRANK_ROCKER;
use super::run_pair::{free_motion, kinetic_energy, wrapped_free_motion};
use super::series::{ParameterSeries, Requirement, RunResult, cell, decades, scaled_cell};
use dwell_dynamics::{Method, Options, ReducedState};
use dwell_numerics::{DoubleDouble, Scalar};
use std::f64::consts::TAU;
use std::sync::LazyLock;

/// The crank where the motions start, rad.
const START_ANGLE: f64 = 1.125;
/// Points of the rule for the period; with half as many, the result differs by 1e-28.
const QUADRATURE_POINTS: usize = 256;
/// Largest energy error of a step, in tolerances.
const ENERGY_ERROR_PER_STEP: f64 = 4.0;
/// Steps of a revolution at a tolerance of one.
const STEPS_PER_REVOLUTION: f64 = 8.0;

/// Revolutions after which the angle is wrapped: its rounding is then that of a hundred revolutions.
const MAX_UNWRAPPED_REVOLUTIONS: f64 = 100.0;

/// The results at the end of a motion.
const QUANTITIES: [&str; 2] = ["angle", "energy"];

/// m at the start, and the period at 1 rad/s there, of the crank-rocker's free motion: E_c is constant.
static REFERENCE_REVOLUTION: LazyLock<[DoubleDouble; 2]> = LazyLock::new(|| {
    let m = four_bar(&CRANK_ROCKER, dd(START_ANGLE)).m;
    let integral = root_inertia_integral(&CRANK_ROCKER, QUADRATURE_POINTS);
    [m, integral / m.sqrt()]
});

/// File name and title of the figure of these rows.
const FIGURE: (&str, &str) = ("motions", "Speeds and revolutions");
/// File name and title of the figure of the rows of tolerances.
const TOLERANCES_FIGURE: (&str, &str) = ("tolerances", "Tolerances");

pub(super) fn series(form: Form, slow: bool) -> Vec<ParameterSeries> {
    let mut series = vec![speeds(form), revolutions(form, slow)];
    series.extend(Method::ALL.map(|method| tolerances(form, method)));
    series
}

/// Order of the error estimate of a method's step control.
fn order(method: Method) -> f64 {
    match method {
        Method::Bdf => 5.0,
        Method::Esdirk34 => 3.0,
        Method::TrBdf2 => 2.0,
        Method::Tsit45 => 4.0,
        Method::Dop853 => 7.0,
    }
}

/// A revolution takes 8 tol^(−1/(p + 1)) steps, each with an energy error of some tolerances, always with the same
/// sign; the phase error is half of that, summed over the revolutions.
fn required(method: Method, tolerance: f64, revolutions: f64, quantity: usize) -> Requirement {
    let steps = STEPS_PER_REVOLUTION * tolerance.powf(-1.0 / (order(method) + 1.0));
    let energy = ENERGY_ERROR_PER_STEP * steps * (tolerance + f64::EPSILON) * revolutions;
    let phase = 0.5 * energy * revolutions.max(1.0);
    Requirement::from_error(if quantity == 0 { phase } else { energy }, revolutions)
}

/// Some revolutions from an initial speed, to the same position again.
fn solve_revolutions(
    model: &FormModel,
    speed: f64,
    revolutions: f64,
    options: &Options,
) -> RunResult {
    let [m, period] = *REFERENCE_REVOLUTION;
    let parts = (revolutions / MAX_UNWRAPPED_REVOLUTIONS).max(1.0);
    let advance = DoubleDouble::from_revolutions(revolutions / parts);
    let exact_duration = period * dd(revolutions / parts) / dd(speed);
    let duration = exact_duration.value();
    let start = ReducedState {
        t: 0.0,
        q: START_ANGLE,
        q_dot: speed,
    };
    let mut angle = dd(START_ANGLE);
    let runs = if parts > 1.0 {
        wrapped_free_motion(model, start, parts as usize, duration, advance, options)?
    } else {
        angle += advance;
        free_motion(model, start, duration, options)?
    };
    // The end in double precision differs slightly from the end of the revolutions.
    let angle = angle + (dd(duration) - exact_duration) * dd(speed) * dd(parts);
    // Each part loses one unit in the last place of the angle and of the time.
    let rounding = 2.0 * f64::EPSILON * (advance.value() + angle.value()) * parts.sqrt();
    let end_angle = runs.final_value(|y| y[0], rounding);
    let energy = dd(0.5) * m * dd(speed) * dd(speed);
    let rounding = 4.0 * f64::EPSILON * energy.value();
    let end_energy = runs.final_value(|y| kinetic_energy(model, y), rounding);
    let angle = scaled_cell(end_angle, angle, TAU);
    Ok(vec![angle, cell(end_energy, energy)])
}

/// A row of motions of the crank-rocker: speed, revolutions and options by value.
fn base_series(
    form: Form,
    values: Vec<f64>,
    motion: impl Fn(f64) -> (f64, f64, Options) + Send + Sync + Clone + 'static,
) -> ParameterSeries {
    let model = FormModel::of(form, &CRANK_ROCKER.text(), "", None).map_err(|e| e.to_string());
    let motion_of = motion.clone();
    ParameterSeries {
        figure: FIGURE,
        key: String::new(),
        description: String::new(),
        parameter: ("", ""),
        values,
        quantities: &QUANTITIES,
        reference: "the period by quadrature of a closed form in 32 digits: the crank is where it was, at the same energy",
        reason: "",
        requirement: Box::new(move |at, quantity| {
            let (_, revolutions, options) = motion_of(at);
            required(options.method, options.rtol, revolutions, quantity)
        }),
        run: Box::new(move |at| {
            let (speed, revolutions, options) = motion(at);
            let model = model.as_ref().map_err(String::as_str)?;
            solve_revolutions(model, speed, revolutions, &options)
        }),
    }
}

fn speeds(form: Form) -> ParameterSeries {
    let options = Options::new(Method::Bdf, form.tolerance(1e-10));
    ParameterSeries {
        figure: FIGURE,
        key: "speed".into(),
        description: "Free motion of a four-bar over one revolution: its speed".into(),
        parameter: ("speed at the start", "rad/s"),
        reason: "without loads a speed only scales time: one revolution at 1e-10, whatever the speed; its steps, \
              4 tolerances each",
        ..base_series(form, decades(-9, 9), move |speed| (speed, 1.0, options))
    }
}

fn tolerances(form: Form, method: Method) -> ParameterSeries {
    let name = method.name();
    let mut values = decades(-2, -14);
    values.retain(|&tolerance| tolerance == form.tolerance(tolerance));
    ParameterSeries {
        figure: TOLERANCES_FIGURE,
        key: format!("tolerance-{}", name.to_lowercase()),
        description: format!("Free motion of a four-bar over one revolution by {name}: tolerance"),
        parameter: ("tolerance", ""),
        reason: "a revolution takes 8 tol^(−1/(p + 1)) steps of the order p that step control sees, each errs by 4 tolerances \
              and a rounding at most",
        ..base_series(form, values, move |tolerance| {
            (1.0, 1.0, Options::new(method, tolerance))
        })
    }
}

fn revolutions(form: Form, slow: bool) -> ParameterSeries {
    let options = Options::new(Method::Tsit45, form.tolerance(1e-12));
    let max_exponent = if slow { 5 } else { 3 };
    ParameterSeries {
        figure: FIGURE,
        key: "revolutions".into(),
        description: "Free motion of a four-bar at 1e-12 by Tsit45: revolutions".into(),
        parameter: ("revolutions n", ""),
        reason: "the energy error has the same sign in each of the n revolutions, and the angle errs by half of that, summed over them: n²/2 times the energy error of one revolution",
        ..base_series(form, decades(0, max_exponent), move |revolutions| {
            (1.0, revolutions, options)
        })
    }
}
