//! Stiffness, damping, and drives with next to no mass.

use super::grid::{Reading, Row, Stated, Told, decades, refused};
use super::moving::{free, kinetic, loaded, machine};
use super::shapes::{rotor, scotch_yoke, slider};
use super::truth::{elliptic_e, exponential, wide};
use crate::estimate;
use dwell_dynamics::{Method, Options, Orbit, State};
use dwell_geometry::{BodyId, Scalar, Vec2, Wide, vec2};
use dwell_kinetostatics::{Load, LoadKind, Magnitude, Mass};
use std::f64::consts::TAU;

/// Errors of these motions in tolerances: a few hundred steps, four tolerances each.
const TOLERANCES: f64 = 2000.0;
const BODIES: [BodyId; 2] = [BodyId(0), BodyId(1)];

/// Page of these rows, and its title.
const FAMILY: (&str, &str) = ("stiff", "Stiffness, damping and next to no mass");

pub(super) fn rows() -> Vec<Row> {
    vec![stiffness(), damping(), small_rotor(), light_crank()]
}

fn options() -> Options {
    Options::new(Method::Bdf, 1e-10)
}

fn load(kind: LoadKind, magnitude: f64) -> Load {
    Load {
        name: "load".into(),
        kind,
        magnitude: Magnitude::Constant(magnitude),
    }
}

/// Free at zero travel of the slider, from a point 2 m behind it.
fn spring(stiffness: f64) -> Load {
    let kind = LoadKind::Spring {
        bodies: BODIES,
        points: [vec2(-2.0, 0.0), Vec2::ZERO],
        free: 2.0,
    };
    load(kind, stiffness)
}

fn stiffness() -> Row {
    let run = |k: f64| -> Result<Vec<Told>, String> {
        let machine = machine(&slider(1.0), &[spring(k)])?;
        let frequency = wide(k).sqrt();
        let period = Wide::PI * wide(2.0) / frequency;
        let end = 2.3 * period.value();
        let twice = loaded(&machine, [1.0, 0.0], end, &options()).map_err(|e| e.to_string())?;
        let (sin, cos) = (frequency * wide(end)).sin_cos();
        let (q, q_error) = twice.last(|y| y[0], 16.0 * f64::EPSILON);
        let rounding = 16.0 * f64::EPSILON * frequency.value();
        let (v, v_error) = twice.last(|y| y[1], rounding);
        let start = State {
            t: 0.0,
            q: 1.0,
            q_dot: 0.0,
        };
        let orbit = |stretch: f64| {
            let q = start.q * stretch;
            Orbit::loaded(&machine, State { q, ..start })
        };
        let quadrature = orbit(1.0)
            .and_then(|own| Ok((own.period, estimate::of_period(&own, orbit)?)))
            .map_err(|e| e.to_string());
        Ok(vec![
            Ok(Reading::new(q, cos, q_error).of(1.0)),
            Ok(Reading::new(v, -(sin * frequency), v_error).of(frequency.value())),
            quadrature.map(|(got, error)| Reading::new(got, period, error)),
        ])
    };
    Row {
        family: FAMILY,
        key: "stiffness".into(),
        what: "Slider on a spring over 2.3 swings: stiffness".into(),
        parameter: ("stiffness", "N/m"),
        values: decades(0, 12),
        quantities: &["travel", "speed", "period by quadrature"],
        truth: "cos √k t, and 2π/√k",
        why: "a stiffness scales time: some hundred steps of 4 tolerances (1e-10); the quadrature keeps all but 16 \
              roundings of 2 m",
        stated: Box::new(|_, quantity| match quantity {
            2 => Stated::rounding(32.0, 1.0),
            _ => Stated::error(TOLERANCES * 1e-10, 1.0),
        }),
        run: Box::new(move |k| run(k).unwrap_or_else(|e| refused(&e, 3))),
    }
}

fn damping() -> Row {
    let run = |c: f64| -> Result<Vec<Told>, String> {
        let damper = LoadKind::Damper {
            bodies: BODIES,
            points: [vec2(-2.0, 0.0), Vec2::ZERO],
        };
        let machine = machine(&slider(1.0), &[spring(c), load(damper, c)])?;
        let twice = loaded(&machine, [1.0, 0.0], 1.0, &options()).map_err(|e| e.to_string())?;
        // q̈ + c q̇ + c q = 0: the slow root by the product of both.
        let (two, four) = (wide(2.0), wide(4.0));
        let root = (wide(c) * (wide(c) - four)).sqrt();
        let fast = -(wide(c) + root) / two;
        let slow = wide(c) / fast;
        let (one, other) = (exponential(slow), exponential(fast));
        let travel = (fast * one - slow * other) / (fast - slow);
        let speed = wide(c) * (one - other) / (fast - slow);
        let (q, q_error) = twice.last(|y| y[0], 16.0 * f64::EPSILON);
        let (v, v_error) = twice.last(|y| y[1], 16.0 * f64::EPSILON);
        Ok(vec![
            Ok(Reading::new(q, travel, q_error).of(1.0)),
            Ok(Reading::new(v, speed, v_error).of(1.0)),
        ])
    };
    Row {
        family: FAMILY,
        key: "damping".into(),
        what:
            "Slider between a spring and a damper of the same number: it creeps home within seconds"
                .into(),
        parameter: ("damping", "N s/m"),
        values: decades(1, 12),
        quantities: &["travel", "speed"],
        truth: "two exponentials, of which the fast one is gone after 1/c s",
        why: "the slow motion is the same for all: some hundred steps of 4 tolerances (1e-10)",
        stated: Box::new(|_, _| Stated::error(TOLERANCES * 1e-10, 1.0)),
        run: Box::new(move |c| run(c).unwrap_or_else(|e| refused(&e, 2))),
    }
}

fn small_rotor() -> Row {
    let run = |inertia: f64| -> Result<Vec<Told>, String> {
        let mass = Mass {
            inertia,
            ..Mass::default()
        };
        let loads = [
            load(LoadKind::Torque { bodies: BODIES }, 1.0),
            load(LoadKind::TorsionDamper { bodies: BODIES }, 1.0),
        ];
        let machine = machine(&rotor(mass), &loads)?;
        let twice = loaded(&machine, [0.0, 0.0], 1.0, &options()).map_err(|e| e.to_string())?;
        let faded = exponential(-(wide(1.0) / wide(inertia)));
        let speed = wide(1.0) - faded;
        let angle = wide(1.0) - wide(inertia) * speed;
        let (q, q_error) = twice.last(|y| y[0], 4.0 * f64::EPSILON);
        let (v, v_error) = twice.last(|y| y[1], 4.0 * f64::EPSILON);
        Ok(vec![
            Ok(Reading::new(q, angle, q_error).of(1.0)),
            Ok(Reading::new(v, speed, v_error).of(1.0)),
        ])
    };
    Row {
        family: FAMILY,
        key: "small-rotor".into(),
        what: "Rotor driven by 1 N m against 1 N m s: its inertia goes to nothing".into(),
        parameter: ("inertia", "kg m²"),
        values: decades(0, -15),
        quantities: &["angle", "speed"],
        truth: "1 − J (1 − e^(−1/J)) rad after 1 s",
        why: "what is left is the balance of both couples: some hundred steps of 4 tolerances (1e-10)",
        stated: Box::new(|_, _| Stated::error(TOLERANCES * 1e-10, 1.0)),
        run: Box::new(move |j| run(j).unwrap_or_else(|e| refused(&e, 2))),
    }
}

/// A Scotch yoke's crank carries next to nothing: m = J + sin² φ kg m², and the speed at the dead points is
/// as large as J is small.
fn light_crank() -> Row {
    const FROM: f64 = 1.125;
    let run = |inertia: f64| -> Result<Vec<Told>, String> {
        let model = scotch_yoke(inertia, 1.0).exact(&[])?;
        let (sin, _) = wide(FROM).sin_cos();
        let m = wide(inertia) + sin * sin;
        // ∮ √(J + sin² φ) dφ = 4 √(1 + J) E(k), k² = 1/(1 + J).
        let one = wide(1.0) + wide(inertia);
        let complement = (wide(inertia) / one).sqrt();
        let way = wide(4.0) * one.sqrt() * elliptic_e(wide(1.0) / one, complement);
        let period = way / m.sqrt();
        let start = State {
            t: 0.0,
            q: FROM,
            q_dot: 1.0,
        };
        let motion = free(&model, start, period.value(), &options()).map_err(|e| e.to_string());
        let ends = motion.map(|twice| {
            let angle = wide(FROM) + Wide::turns(1.0) + (wide(period.value()) - period);
            let energy = wide(0.5) * m;
            let (q, q_error) = twice.last(|y| y[0], 4.0 * f64::EPSILON * TAU);
            let rounding = 4.0 * f64::EPSILON * energy.value();
            let (e, e_error) = twice.last(|y| kinetic(&model, y), rounding);
            [
                Reading::new(q, angle, q_error).of(TAU),
                Reading::new(e, energy, e_error),
            ]
        });
        let orbit = |stretch: f64| {
            let q_dot = start.q_dot * stretch;
            Orbit::new(&model, State { q_dot, ..start })
        };
        let quadrature = orbit(1.0)
            .and_then(|own| Ok((own.period, estimate::of_period(&own, orbit)?)))
            .map_err(|e| e.to_string());
        let end = |k: usize| ends.clone().map(|both| both[k]);
        Ok(vec![
            end(0),
            end(1),
            quadrature.map(|(got, error)| Reading::new(got, period, error)),
        ])
    };
    Row {
        family: FAMILY,
        key: "light-crank".into(),
        what: "Scotch yoke without loads over one turn: the crank's inertia goes to nothing beside a slide of 1 kg"
            .into(),
        parameter: ("inertia of the crank", "kg m²"),
        values: decades(0, -15),
        quantities: &["angle", "energy", "period by quadrature"],
        truth: "the complete elliptic integral of the second kind, by the arithmetic-geometric mean",
        why: "the time of a turn hardly knows J: the steps of a turn (1e-10), and as many for each tenth of J, for they \
              grow geometrically from each dead point on. There the state passes within J s, so that its time would \
              have to be known to eps J: a condition of 1/J. The quadrature keeps all but 64 roundings",
        stated: Box::new(|inertia, quantity| match quantity {
            2 => Stated::rounding(64.0, 1.0),
            _ => {
                let decades = 1.0 - inertia.log10();
                Stated::error(decades * TOLERANCES * 1e-10, 1.0 / inertia)
            }
        }),
        run: Box::new(move |j| run(j).unwrap_or_else(|e| refused(&e, 3))),
    }
}
