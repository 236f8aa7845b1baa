//! Singular cases: the separatrix of a pendulum, and a start at a dead point.

use super::closed_forms::{arc_cosine, dd, elliptic_k, exponential};
use super::mechanisms::{SliderCrank, mass, rotor, scene};
use super::run_pair::{RunPair, load, loaded_motion, machine, quadrature, sampled};
use super::series::{ParameterSeries, Requirement, RunResult, decades, scaled_cell};
use dwell_dynamics::{
    Atlas, Machine, MachineDescription, Method, OdeState, Options, Orbit, ReducedState,
};
use dwell_geometry::Vec2;
use dwell_kinetostatics::LoadKind;
use dwell_numerics::{DoubleDouble, Scalar};
use dwell_scene::PlaneScene;
use dwell_study::estimate;
use dwell_study::models::reduced_model;
use std::f64::consts::PI;

/// Figure of these rows, and its title.
const FIGURE: (&str, &str) = ("edges", "Separatrix and dead point");

pub(super) fn series() -> Vec<ParameterSeries> {
    vec![
        near_separatrix(-1.0),
        near_separatrix(1.0),
        separatrix(),
        dead_point(),
    ]
}

/// 1 kg on a massless bar of 1 m under 1 m/s²: q̈ = −sin q, with q = 0 at the bottom.
fn pendulum() -> Result<Machine, String> {
    let direction = Vec2::IDENTITY;
    let weight = load(LoadKind::Gravity { direction }, 1.0);
    machine(&rotor(&mass(1.0, [1.0, 0.0], 0.0)), &[weight])
}

/// Periods just below (−1) or above (+1) the energy of rest at the top.
fn near_separatrix(sign: f64) -> ParameterSeries {
    let run = move |distance: f64| -> RunResult {
        let machine = pendulum()?;
        let q_dot = 2.0 + sign * distance;
        let half = dd(0.5 * q_dot);
        let one = dd(1.0);
        // k² = (q̇₀/2)² of a libration, its inverse of a rotation; k′² by factors.
        let period = if sign < 0.0 {
            dd(4.0) * elliptic_k(((one - half) * (one + half)).sqrt())
        } else {
            let complement = ((half - one) * (half + one)).sqrt() / half;
            dd(2.0) * elliptic_k(complement) / half
        };
        let orbit = |stretch: f64| {
            let (t, q, q_dot) = (0.0, 0.0, q_dot * stretch);
            Orbit::loaded(&machine, ReducedState { t, q, q_dot })
        };
        Ok(vec![quadrature(orbit, period)])
    };
    let (key, what) = if sign < 0.0 {
        (
            "libration",
            "Pendulum in libration: speed short of the separatrix",
        )
    } else {
        (
            "rotation",
            "Pendulum in rotation: speed beyond the separatrix",
        )
    };
    ParameterSeries {
        figure: FIGURE,
        key: key.into(),
        description: what.into(),
        parameter: ("distance δ of the speed at the bottom from 2", "rad/s"),
        values: decades(-1, -15),
        quantities: &["period by quadrature"],
        reference: "complete elliptic integrals of the first kind, by the arithmetic-geometric mean",
        reason: "the period grows as log 1/δ, and a speed known to its rounding moves it by 2 eps/δ; 16 roundings",
        requirement: Box::new(|at, _| {
            let condition = 1.0 + 2.0 / (at * (32.0 / at).ln());
            Requirement::from_rounding(16.0, condition)
        }),
        run: Box::new(run),
    }
}

/// On the separatrix: q = 4 atan eᵗ − π, from the bottom at 2 rad/s.
fn separatrix() -> ParameterSeries {
    const TOLERANCE: f64 = 1e-12;
    let run = |end: f64| -> RunResult {
        let machine = pendulum()?;
        let options = Options::new(Method::Tsit45, TOLERANCE);
        let runs = loaded_motion(&machine, [0.0, 2.0], end, &options)?;
        let exp_t = exponential(dd(end));
        let angle = dd(4.0) * exp_t.atan2(dd(1.0)) - DoubleDouble::PI;
        // q̇ = 2 / cosh t.
        let speed = dd(4.0) / (exp_t + dd(1.0) / exp_t);
        let rounding = 2.0 * f64::EPSILON * end.exp();
        let end = |k: usize| runs.final_value(|y| y[k], rounding);
        let angle = scaled_cell(end(0), angle, PI);
        Ok(vec![angle, scaled_cell(end(1), speed, 2.0)])
    };
    ParameterSeries {
        figure: FIGURE,
        key: "separatrix".into(),
        description: "Pendulum on the separatrix (1e-12 by Tsit45): time".into(),
        parameter: ("time t", "s"),
        values: (0..=9)
            .map(|k| 2.0_f64.powf(0.5 * f64::from(k)))
            .chain([32.0])
            .collect(),
        quantities: &["angle", "speed"],
        reference: "4 atan eᵗ − π",
        reason: "whatever error there is grows as eᵗ towards the top: some hundred steps of 4 tolerances",
        requirement: Box::new(|t, _| {
            Requirement::from_error(2000.0 * TOLERANCE * t.exp(), t.exp())
        }),
        run: Box::new(run),
    }
}

/// Driven at the slider, which hardly moves when crank and rod are in line. Only the crank has mass, so it
/// rotates uniformly.
const DEAD_POINT_MECHANISM: SliderCrank = SliderCrank {
    lengths: [1.1, 2.3],
    height: 0.0,
    masses: [
        mass(0.0, [0.0; 2], 1.0),
        mass(0.0, [0.0; 2], 0.0),
        mass(0.0, [0.0; 2], 0.0),
    ],
    assembly: [0.0, 0.0],
};

const DEAD_POINT_TOLERANCE: f64 = 1e-10;

/// The travel after 2 s from a distance to the dead point.
fn from_dead_point(distance: f64) -> RunResult {
    let [crank, rod] = DEAD_POINT_MECHANISM.lengths.map(dd);
    let travel = (crank + rod - dd(distance)).value();
    let q = dd(travel);
    let angle = arc_cosine((q * q + crank * crank - rod * rod) / (dd(2.0) * crank * q));
    // Length of the rod along the guide.
    let rod_projection = |sin: DoubleDouble| ((rod + crank * sin) * (rod - crank * sin)).sqrt();
    let slope = |angle: DoubleDouble| {
        let (sin, cos) = angle.sin_cos();
        -(crank * sin + crank * crank * sin * cos / rod_projection(sin))
    };
    // About 1 rad/s of the crank, away from the dead point.
    let speed = slope(angle).value();
    let crank_velocity = dd(speed) / slope(angle);
    let mut slider_crank = DEAD_POINT_MECHANISM;
    slider_crank.assembly = [travel, angle.value()];
    let test = scene(&slider_crank.text(true))?;
    let end = 2.0;
    let options = sampled(&Options::new(Method::Bdf, DEAD_POINT_TOLERANCE), end);
    let runs = RunPair::of(&options, |options| {
        travel_history(&test, [travel, speed], end, options)
    })?;
    let (sin, cos) = (angle + crank_velocity * dd(end)).sin_cos();
    let reference = crank * cos + rod_projection(sin);
    // The relative error of the crank's speed is that of the square root of its inertia, over 2 s.
    let exact = reduced_model(&test, &[])?;
    let (at, error) = estimate::coefficients_with_errors(exact.model(), travel)?;
    let rounding = 2.0 * end * error.m / at.m + 4.0 * f64::EPSILON;
    let end_travel = runs.final_value(|y| y[0], rounding);
    Ok(vec![scaled_cell(end_travel, reference, 1.0)])
}

/// The travel of the slider at the samples of a motion from a state.
fn travel_history(
    test: &PlaneScene,
    state: [f64; 2],
    end: f64,
    options: &Options,
) -> Result<Vec<Vec<f64>>, Box<dyn std::error::Error>> {
    let assembly = test.assembly.to_configuration();
    let mut atlas = Atlas::new(MachineDescription {
        varying_inertias: &[],
        mechanism: &test.mechanism,
        masses: &test.masses,
        assembly: &assembly,
        loads: &[],
        drives: &[],
        reactions: &[],
    })?;
    let (t, y) = (0.0, state.to_vec());
    let motion = atlas.solve(&OdeState { t, y }, end, options, &[])?;
    if let Some(error) = motion.error {
        return Err(error.into());
    }
    let history = atlas.coordinate_history(&motion, atlas.actuator_coordinate())?;
    let samples = history.samples.iter().flatten();
    Ok(samples.map(|s| vec![s[0]]).collect())
}

fn dead_point() -> ParameterSeries {
    ParameterSeries {
        figure: FIGURE,
        key: "dead-point".into(),
        description: "Slider-crank started at the slider: distance from its dead point".into(),
        parameter: ("distance δ", "m"),
        values: decades(-1, -15),
        quantities: &["travel after 2 s"],
        reference: "the crank rotates uniformly: closed form of the travel in 32 digits",
        reason: "the travel at the start is known to 3 eps, and the crank's speed there to 3 eps/δ; some hundred steps of \
              4 tolerances (1e-10), magnified by the coordinate's fold, 1/√δ",
        requirement: Box::new(|at, _| {
            let condition = 3.0 / at;
            let error = 2000.0 * DEAD_POINT_TOLERANCE / at.sqrt() + 16.0 * f64::EPSILON * condition;
            Requirement::from_error(error, condition)
        }),
        run: Box::new(from_dead_point),
    }
}
