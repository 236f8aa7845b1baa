//! Edges: the separatrix of a pendulum, and a start at a dead point.

use super::grid::{Reading, Row, Stated, Told, decades, refused};
use super::moving::{loaded, machine};
use super::shapes::{SliderCrank, rotor};
use super::truth::{arc_cosine, elliptic_k, exponential, wide};
use crate::estimate;
use dwell_dynamics::{Atlas, Machine, Method, Options, Orbit, Point, Site, State};
use dwell_geometry::{Scalar, Vec2, Wide, vec2};
use dwell_kinetostatics::{Load, LoadKind, Magnitude, Mass};
use std::f64::consts::PI;

/// Page of these rows, and its title.
const FAMILY: (&str, &str) = ("edges", "Separatrix and dead point");

pub(super) fn rows() -> Vec<Row> {
    vec![beside(-1.0), beside(1.0), separatrix(), dead_point()]
}

/// 1 kg on a massless bar of 1 m under 1 m/s²: q̈ = −sin q, with q = 0 at the bottom.
fn pendulum() -> Result<Machine, String> {
    let mass = Mass {
        mass: 1.0,
        center: vec2(1.0, 0.0),
        inertia: 0.0,
    };
    let weight = Load {
        name: "weight".into(),
        kind: LoadKind::Gravity {
            direction: Vec2::IDENTITY,
        },
        magnitude: Magnitude::Constant(1.0),
    };
    machine(&rotor(mass), &[weight])
}

/// Periods just below (−1) or above (+1) the energy that brings it to the top.
fn beside(side: f64) -> Row {
    let run = move |apart: f64| -> Result<Vec<Told>, String> {
        let machine = pendulum()?;
        let q_dot = 2.0 + side * apart;
        let half = wide(0.5 * q_dot);
        let one = wide(1.0);
        // k² = (q̇₀/2)² where it swings, its inverse where it turns; k′² by factors.
        let period = if side < 0.0 {
            wide(4.0) * elliptic_k(((one - half) * (one + half)).sqrt())
        } else {
            let complement = ((half - one) * (half + one)).sqrt() / half;
            wide(2.0) * elliptic_k(complement) / half
        };
        let start = State {
            t: 0.0,
            q: 0.0,
            q_dot,
        };
        let orbit = |stretch: f64| {
            let q_dot = start.q_dot * stretch;
            Orbit::loaded(&machine, State { q_dot, ..start })
        };
        let own = orbit(1.0).map_err(|e| e.to_string())?;
        let error = estimate::of_period(&own, orbit).map_err(|e| e.to_string())?;
        Ok(vec![Ok(Reading::new(own.period, period, error))])
    };
    let (key, what) = if side < 0.0 {
        (
            "swings",
            "Pendulum that swings: speed short of the separatrix",
        )
    } else {
        (
            "turns",
            "Pendulum that turns over: speed beyond the separatrix",
        )
    };
    Row {
        family: FAMILY,
        key: key.into(),
        what: what.into(),
        parameter: ("distance δ of the speed at the bottom from 2", "rad/s"),
        values: decades(-1, -15),
        quantities: &["period by quadrature"],
        truth: "complete elliptic integrals of the first kind, by the arithmetic-geometric mean",
        why: "the period grows as log 1/δ, and a speed known to its rounding moves it by 2 eps/δ; 16 roundings",
        stated: Box::new(|at, _| {
            let condition = 1.0 + 2.0 / (at * (32.0 / at).ln());
            Stated::rounding(16.0, condition)
        }),
        run: Box::new(move |at| run(at).unwrap_or_else(|e| refused(&e, 1))),
    }
}

/// On the separatrix: q = 4 atan eᵗ − π, from the bottom at 2 rad/s.
fn separatrix() -> Row {
    const TOLERANCE: f64 = 1e-12;
    let run = |end: f64| -> Result<Vec<Told>, String> {
        let machine = pendulum()?;
        let options = Options::new(Method::Tsit45, TOLERANCE);
        let twice = loaded(&machine, [0.0, 2.0], end, &options).map_err(|e| e.to_string())?;
        let grown = exponential(wide(end));
        let angle = wide(4.0) * grown.atan2(wide(1.0)) - Wide::PI;
        // q̇ = 2 / cosh t.
        let speed = wide(4.0) / (grown + wide(1.0) / grown);
        let rounding = 2.0 * f64::EPSILON * end.exp();
        let (q, q_error) = twice.last(|y| y[0], rounding);
        let (v, v_error) = twice.last(|y| y[1], rounding);
        Ok(vec![
            Ok(Reading::new(q, angle, q_error).of(PI)),
            Ok(Reading::new(v, speed, v_error).of(2.0)),
        ])
    };
    Row {
        family: FAMILY,
        key: "separatrix".into(),
        what: "Pendulum with the very energy of the top (1e-12 by Tsit45): time".into(),
        parameter: ("time t", "s"),
        values: (0..=9)
            .map(|k| 2.0_f64.powf(0.5 * f64::from(k)))
            .chain([32.0])
            .collect(),
        quantities: &["angle", "speed"],
        truth: "4 atan eᵗ − π",
        why: "whatever error there is grows as eᵗ towards the top: some hundred steps of 4 tolerances",
        stated: Box::new(|t, _| Stated::error(2000.0 * TOLERANCE * t.exp(), t.exp())),
        run: Box::new(move |at| run(at).unwrap_or_else(|e| refused(&e, 2))),
    }
}

/// Driven at the slider, which hardly moves where crank and rod are in line. All mass is the crank's, so that
/// this turns evenly.
const STRETCHED: SliderCrank = SliderCrank {
    lengths: [1.1, 2.3],
    height: 0.0,
    masses: [
        Mass {
            mass: 0.0,
            center: Vec2::ZERO,
            inertia: 1.0,
        },
        Mass {
            mass: 0.0,
            center: Vec2::ZERO,
            inertia: 0.0,
        },
        Mass {
            mass: 0.0,
            center: Vec2::ZERO,
            inertia: 0.0,
        },
    ],
    start: [0.0, 0.0],
};

fn dead_point() -> Row {
    const TOLERANCE: f64 = 1e-10;
    let run = |apart: f64| -> Result<Vec<Told>, String> {
        let [crank, rod] = STRETCHED.lengths.map(wide);
        let travel = (crank + rod - wide(apart)).value();
        let q = wide(travel);
        let angle = arc_cosine((q * q + crank * crank - rod * rod) / (wide(2.0) * crank * q));
        // How far the rod reaches along the guide.
        let reach = |sin: Wide| ((rod + crank * sin) * (rod - crank * sin)).sqrt();
        let slope = |angle: Wide| {
            let (sin, cos) = angle.sin_cos();
            -(crank * sin + crank * crank * sin * cos / reach(sin))
        };
        // About 1 rad/s of the crank, away from the dead point.
        let speed = slope(angle).value();
        let turning = wide(speed) / slope(angle);
        let mut parts = STRETCHED;
        parts.start = [travel, angle.value()];
        let shape = parts.shape(true);
        let site = Site {
            mechanism: &shape.mechanism,
            masses: &shape.masses,
            start: &shape.start,
            loads: &[],
            drives: &[],
            reactions: &[],
        };
        let end = 2.0;
        let run = |options: &Options| -> Result<Vec<f64>, String> {
            let mut atlas = Atlas::new(site).map_err(|e| e.to_string())?;
            let start = Point {
                t: 0.0,
                y: vec![travel, speed],
            };
            let journey = atlas
                .follow(&start, end, options, &[])
                .map_err(|e| e.to_string())?;
            if let Some(error) = &journey.failed {
                return Err(error.to_string());
            }
            let tracked = atlas
                .track(&journey, atlas.own())
                .map_err(|e| e.to_string())?;
            Ok(tracked.samples.iter().flatten().map(|s| s[0]).collect())
        };
        let options = Options {
            every: Some(end / 64.0),
            ..Options::new(Method::Bdf, TOLERANCE)
        };
        let (first, again) = (run(&options)?, run(&estimate::second(&options))?);
        let turned = angle + turning * wide(end);
        let (sin, cos) = turned.sin_cos();
        let truth = crank * cos + reach(sin);
        let got = first.last().copied().unwrap_or(f64::NAN);
        // The crank's speed is as well known as the root of its inertia, and turns it for 2 s.
        let exact = shape.exact(&[])?;
        let (at, error) = estimate::reduced(exact.model(), travel).map_err(|e| e.to_string())?;
        let rounding = 2.0 * end * error.m / at.m + 4.0 * f64::EPSILON;
        let error = estimate::of_motion(&first, &again, rounding);
        Ok(vec![Ok(Reading::new(got, truth, error).of(1.0))])
    };
    Row {
        family: FAMILY,
        key: "dead-point".into(),
        what: "Slider-crank started at the slider: distance from its dead point".into(),
        parameter: ("distance δ", "m"),
        values: decades(-1, -15),
        quantities: &["travel after 2 s"],
        truth: "the crank turns evenly: closed form of the travel in 32 digits",
        why: "the travel at the start is known to 3 eps, and the crank's speed there to 3 eps/δ; some hundred steps of \
              4 tolerances (1e-10), magnified by the coordinate's fold, 1/√δ",
        stated: Box::new(|at, _| {
            let condition = 3.0 / at;
            let error = 2000.0 * TOLERANCE / at.sqrt() + 16.0 * f64::EPSILON * condition;
            Stated::error(error, condition)
        }),
        run: Box::new(move |at| run(at).unwrap_or_else(|e| refused(&e, 1))),
    }
}
