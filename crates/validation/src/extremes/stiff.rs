//! Extreme stiffness, damping, and drives with almost no mass.

use super::closed_forms::{dd, elliptic_e, exponential};
use super::forms::{Form, FormModel};
use super::mechanisms::{mass, rotor, scotch_yoke, slider};
use super::run_pair::{free_motion, kinetic_energy, load, loaded_motion, machine, quadrature};
use super::series::{ParameterSeries, Requirement, RunResult, cell, decades, scaled_cell};
use dwell_dynamics::{Method, Options, Orbit, ReducedState};
use dwell_geometry::{BodyId, Vec2, vec2};
use dwell_kinetostatics::{Load, LoadKind};
use dwell_numerics::{DoubleDouble, Scalar};
use std::f64::consts::TAU;

/// Errors of these motions in tolerances: a few hundred steps, four tolerances each.
const ERROR_IN_TOLERANCES: f64 = 2000.0;
const BODIES: [BodyId; 2] = [BodyId(0), BodyId(1)];

/// Figure of these rows, and its title.
const FIGURE: (&str, &str) = ("stiff", "Stiffness, damping and next to no mass");

pub(super) fn series(form: Form) -> Vec<ParameterSeries> {
    vec![stiffness(), damping(), small_rotor(), light_crank(form)]
}

fn options() -> Options {
    Options::new(Method::Bdf, 1e-10)
}

/// Free at zero travel of the slider, from a point 2 m behind it.
fn spring(stiffness: f64) -> Load {
    let kind = LoadKind::spring(BODIES, [vec2(-2.0, 0.0), Vec2::ZERO], 2.0);
    load(kind, stiffness)
}

fn stiffness() -> ParameterSeries {
    let run = |k: f64| -> RunResult {
        let machine = machine(&slider(1.0), &[spring(k)])?;
        let frequency = dd(k).sqrt();
        let period = DoubleDouble::PI * dd(2.0) / frequency;
        let end = 2.3 * period.value();
        let runs = loaded_motion(&machine, [1.0, 0.0], end, &options())?;
        let (sin, cos) = (frequency * dd(end)).sin_cos();
        let travel = runs.final_value(|y| y[0], 16.0 * f64::EPSILON);
        let rounding = 16.0 * f64::EPSILON * frequency.value();
        let speed = runs.final_value(|y| y[1], rounding);
        let orbit = |stretch: f64| {
            let (t, q, q_dot) = (0.0, stretch, 0.0);
            Orbit::loaded(&machine, ReducedState { t, q, q_dot })
        };
        Ok(vec![
            scaled_cell(travel, cos, 1.0),
            scaled_cell(speed, -(sin * frequency), frequency.value()),
            quadrature(orbit, period),
        ])
    };
    ParameterSeries {
        figure: FIGURE,
        key: "stiffness".into(),
        description: "Slider on a spring over 2.3 oscillations: stiffness".into(),
        parameter: ("stiffness", "N/m"),
        values: decades(0, 12),
        quantities: &["travel", "speed", "period by quadrature"],
        reference: "cos √k t, and 2π/√k",
        reason: "a stiffness scales time: some hundred steps of 4 tolerances (1e-10); the quadrature keeps all but 16 \
              roundings of 2 m",
        requirement: Box::new(|_, quantity| match quantity {
            2 => Requirement::from_rounding(32.0, 1.0),
            _ => Requirement::from_error(ERROR_IN_TOLERANCES * 1e-10, 1.0),
        }),
        run: Box::new(run),
    }
}

fn damping() -> ParameterSeries {
    let run = |c: f64| -> RunResult {
        let damper = LoadKind::damper(BODIES, [vec2(-2.0, 0.0), Vec2::ZERO]);
        let machine = machine(&slider(1.0), &[spring(c), load(damper, c)])?;
        let runs = loaded_motion(&machine, [1.0, 0.0], 1.0, &options())?;
        // q̈ + c q̇ + c q = 0: the slow root by the product of both.
        let (two, four) = (dd(2.0), dd(4.0));
        let root = (dd(c) * (dd(c) - four)).sqrt();
        let fast = -(dd(c) + root) / two;
        let slow = dd(c) / fast;
        let (one, other) = (exponential(slow), exponential(fast));
        let travel = (fast * one - slow * other) / (fast - slow);
        let speed = dd(c) * (one - other) / (fast - slow);
        let end = |k: usize| runs.final_value(|y| y[k], 16.0 * f64::EPSILON);
        let travel = scaled_cell(end(0), travel, 1.0);
        Ok(vec![travel, scaled_cell(end(1), speed, 1.0)])
    };
    ParameterSeries {
        figure: FIGURE,
        key: "damping".into(),
        description:
            "Slider between a spring and a damper of the same number: it returns to rest within seconds"
                .into(),
        parameter: ("damping", "N s/m"),
        values: decades(1, 12),
        quantities: &["travel", "speed"],
        reference: "two exponentials, of which the fast one is gone after 1/c s",
        reason: "the slow motion is the same for all: some hundred steps of 4 tolerances (1e-10)",
        requirement: Box::new(|_, _| Requirement::from_error(ERROR_IN_TOLERANCES * 1e-10, 1.0)),
        run: Box::new(run),
    }
}

fn small_rotor() -> ParameterSeries {
    let run = |inertia: f64| -> RunResult {
        let loads = [
            load(LoadKind::couple(BODIES), 1.0),
            load(LoadKind::rotational_damper(BODIES), 1.0),
        ];
        let machine = machine(&rotor(&mass(0.0, [0.0; 2], inertia)), &loads)?;
        let runs = loaded_motion(&machine, [0.0, 0.0], 1.0, &options())?;
        let decayed = exponential(-(dd(1.0) / dd(inertia)));
        let speed = dd(1.0) - decayed;
        let angle = dd(1.0) - dd(inertia) * speed;
        let end = |k: usize| runs.final_value(|y| y[k], 4.0 * f64::EPSILON);
        let angle = scaled_cell(end(0), angle, 1.0);
        Ok(vec![angle, scaled_cell(end(1), speed, 1.0)])
    };
    ParameterSeries {
        figure: FIGURE,
        key: "small-rotor".into(),
        description: "Rotor driven by 1 N m against 1 N m s: its inertia goes to nothing".into(),
        parameter: ("inertia", "kg m²"),
        values: decades(0, -15),
        quantities: &["angle", "speed"],
        reference: "1 − J (1 − e^(−1/J)) rad after 1 s",
        reason: "what is left is the balance of both couples: some hundred steps of 4 tolerances (1e-10)",
        requirement: Box::new(|_, _| Requirement::from_error(ERROR_IN_TOLERANCES * 1e-10, 1.0)),
        run: Box::new(run),
    }
}

/// A Scotch yoke whose crank has almost no inertia: m = J + sin² φ kg m², and the speed at the dead points grows as J
/// decreases.
fn light_crank(form: Form) -> ParameterSeries {
    const FROM: f64 = 1.125;
    let run = move |inertia: f64| -> RunResult {
        let model = FormModel::of(form, &scotch_yoke(inertia, 1.0), "", None)?;
        let (sin, _) = dd(FROM).sin_cos();
        let m = dd(inertia) + sin * sin;
        // ∮ √(J + sin² φ) dφ = 4 √(1 + J) E(k), k² = 1/(1 + J).
        let one = dd(1.0) + dd(inertia);
        let complement = (dd(inertia) / one).sqrt();
        let root_inertia_integral = dd(4.0) * one.sqrt() * elliptic_e(dd(1.0) / one, complement);
        let period = root_inertia_integral / m.sqrt();
        let at_speed = |q_dot: f64| {
            let (t, q) = (0.0, FROM);
            ReducedState { t, q, q_dot }
        };
        let options = Options::new(Method::Bdf, form.tolerance(1e-10));
        let motion = free_motion(&model, at_speed(1.0), period.value(), &options);
        let [angle, energy] = match motion {
            Ok(runs) => {
                let late = dd(period.value()) - period;
                let angle = dd(FROM) + DoubleDouble::from_revolutions(1.0) + late;
                let energy = dd(0.5) * m;
                let end_angle = runs.final_value(|y| y[0], 4.0 * f64::EPSILON * TAU);
                let rounding = 4.0 * f64::EPSILON * energy.value();
                let end_energy = runs.final_value(|y| kinetic_energy(&model, y), rounding);
                [scaled_cell(end_angle, angle, TAU), cell(end_energy, energy)]
            }
            Err(error) => [0; 2].map(|_| Err(error.to_string())),
        };
        let orbit = |stretch: f64| Orbit::new(&model, at_speed(stretch));
        Ok(vec![angle, energy, quadrature(orbit, period)])
    };
    ParameterSeries {
        figure: FIGURE,
        key: "light-crank".into(),
        description: "Scotch yoke without loads over one revolution: the crank's inertia vanishes against a slide of 1 kg"
            .into(),
        parameter: ("inertia of the crank", "kg m²"),
        values: decades(0, -15),
        quantities: &["angle", "energy", "period by quadrature"],
        reference: "the complete elliptic integral of the second kind, by the arithmetic-geometric mean",
        reason: "the time of a revolution hardly depends on J: its steps (1e-10), and as many for each tenth of J, for they \
              grow geometrically from each dead point on. There the state passes within J s, so that its time would \
              have to be known to eps J: a condition of 1/J. The quadrature keeps all but 64 roundings",
        requirement: Box::new(move |inertia, quantity| match quantity {
            2 => Requirement::from_rounding(64.0, 1.0),
            _ => {
                let errors = (1.0 - inertia.log10()) * ERROR_IN_TOLERANCES;
                Requirement::from_error(errors * form.tolerance(1e-10), 1.0 / inertia)
            }
        }),
        run: Box::new(run),
    }
}
