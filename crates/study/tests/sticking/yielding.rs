//! End stops that yield: a spring and a damper that only push, against closed forms.

use crate::{run, tolerance};
use dwell_dynamics::{Method, StopChange};
use dwell_scene::PlaneScene;
use std::f64::consts::PI;

const G: f64 = 9.81;
const MASS: f64 = 2.0;

/// A ball at 1 m with a speed, under gravity g (m/s²) towards its stop; without it, across its guide.
fn ball(gravity: f64, stop: &str, motion: &str) -> String {
    let gravity = match gravity {
        0.0 => format!("[{G:?}, 0]"),
        gravity => format!("[0, -{gravity:?}]"),
    };
    format!(
        r#"
[bodies.ground]
points = {{ A = [0, 0] }}
[bodies.ball]
points = {{ A = [0, 0] }}
mass = {MASS:?}
center = [0, 0]
[joints]
line = {{ prismatic = ["ground.A", "ball.A"], axis = [0, 1] }}
[actuators.z]
length = "line"
[assembly]
z = 1.0
[loads]
weight = {{ gravity = {gravity} }}
[stops]
floor = {{ coordinate = "z", {stop} }}
[motion]
{motion}
"#
    )
}

fn near(found: f64, expected: f64, allowed: f64) {
    let error = (found - expected).abs() / expected.abs().max(1.0);
    assert!(
        error <= allowed,
        "{found:?} is {error:.1e} from {expected:?}"
    );
}

fn touches(change: &StopChange) -> bool {
    *change == StopChange::Touches
}

fn leaves(change: &StopChange) -> bool {
    *change == StopChange::Leaves
}

/// Without weight the contact lasts π/ω and returns the speed.
#[test]
fn a_spring_stop_returns_the_speed_after_half_a_period() {
    let stiffness = 5e3_f64;
    let text = ball(
        0.0,
        &format!("min = 0.0, stiffness = {stiffness:?}"),
        "initial-velocity = -2.0\nduration = 1.0",
    );
    let contact = PI * (MASS / stiffness).sqrt();
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        let (begins, ends) = (run.stops(touches), run.stops(leaves));
        assert_eq!((begins.len(), ends.len()), (1, 1), "{method:?}");
        near(begins[0], 0.5, allowed);
        near(ends[0], 0.5 + contact, allowed);
        near(run.end()[1], 2.0, 10.0 * allowed);
        near(run.end()[0], 2.0 * (0.5 - contact), 10.0 * allowed);
        assert!(
            run.energy_error() < 10.0 * allowed,
            "{:e}",
            run.energy_error()
        );
    }
}

/// With a damper it lets go where the force would pull, before the spring has its length again, and what it takes is its work.
#[test]
fn a_damped_stop_lets_go_where_its_force_ends() {
    let (stiffness, damping, speed) = (5e3_f64, 60.0_f64, 2.0_f64);
    let text = ball(
        0.0,
        &format!("min = 0.0, stiffness = {stiffness:?}, damping = {damping:?}"),
        "initial-velocity = -2.0\nduration = 1.5",
    );
    let decay = damping / (2.0 * MASS);
    let omega = (stiffness / MASS - decay * decay).sqrt();
    // δ = (v/ω) e^(−σt) sin ωt, and δ̈ = 0.
    let contact = (PI - (2.0 * decay * omega / (omega * omega - decay * decay)).atan()) / omega;
    let (sin, cos) = (omega * contact).sin_cos();
    let size = speed / omega * (-decay * contact).exp();
    let (depth, rebound) = (size * sin, -size * (omega * cos - decay * sin));
    assert!(depth > 0.0 && rebound > 0.0);
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        let (begins, ends) = (run.stops(touches), run.stops(leaves));
        assert_eq!((begins.len(), ends.len()), (1, 1), "{method:?}");
        near(ends[0], 0.5 + contact, allowed);
        near(run.end()[1], rebound, 10.0 * allowed);
        let free = 1.0 - contact;
        near(run.end()[0], -depth + rebound * free, 10.0 * allowed);
        assert!(
            run.energy_error() < 10.0 * allowed,
            "{:e}",
            run.energy_error()
        );
        let work = run.steps.last().expect("steps").y.last().copied();
        let lost = 0.5 * MASS * (rebound * rebound - speed * speed);
        near(work.expect("a work"), lost, 100.0 * allowed);
    }
}

/// Under its weight it bounces a thousand times on a spring: each contact lasts 2 (π − atan(v ω/g))/ω.
#[test]
fn a_ball_bounces_on_a_spring_a_thousand_times() {
    let stiffness = 2e4_f64;
    let omega = (stiffness / MASS).sqrt();
    let fall = (2.0 / G).sqrt();
    let contact = 2.0 * (PI - (G * fall * omega / G).atan()) / omega;
    let period = 2.0 * fall + contact;
    let motion = format!("duration = {:?}", 500.0 * period);
    let text = ball(G, &format!("min = 0.0, stiffness = {stiffness:?}"), &motion);
    let run = run(&text, Method::Dop853, 1e-13);
    let (begins, ends) = (run.stops(touches), run.stops(leaves));
    let error = (begins.last().expect("contacts") - fall - 499.0 * period).abs();
    println!(
        "{} contacts, {} evaluations, last {error:e} s, energy {:e}",
        begins.len(),
        run.evaluations,
        run.energy_error()
    );
    assert_eq!((begins.len(), ends.len()), (500, 500));
    assert!(error < 1e-11 * 500.0 * period);
    for (k, (begins, ends)) in begins.iter().zip(&ends).enumerate() {
        near(*begins, fall + k as f64 * period, 1e-10);
        near(ends - begins, contact, 1e-10);
    }
    assert!(run.energy_error() < 1e-10, "{:e}", run.energy_error());
}

/// A ball put on its spring stop stands there, a weight over a stiffness below its limit, or swings about that.
#[test]
fn a_ball_rests_on_a_spring_stop() {
    let stop = "min = 1.0, stiffness = 1e4, damping = 2e2";
    for method in Method::ALL {
        let [_, allowed] = tolerance(method);
        let run = run(&ball(G, stop, "duration = 3.0"), method, 1e-10);
        assert_eq!(run.stops(touches).len(), 1, "{method:?} {:?}", run.events);
        near(run.end()[0], 1.0 - MASS * G / 1e4, allowed.max(1e-8));
        assert!(run.end()[1].abs() < 1e-6);
    }
}

/// Careless keys of a stop that yields are refused with a place in the scene.
#[test]
fn careless_yielding_stops_are_refused() {
    for (stop, expected) in [
        ("min = 0.0, stiffness = 0.0", "stiffness"),
        ("min = 0.0, stiffness = 1e3, damping = -1.0", "damping"),
        (
            "min = 0.0, damping = 1.0",
            "a `damping` without `stiffness`",
        ),
        (
            "min = 0.0, stiffness = 1e3, restitution = 0.5",
            "both `restitution` and `stiffness`",
        ),
    ] {
        let text = ball(G, stop, "duration = 1.0");
        let error = PlaneScene::parse("scene.toml", &text).expect_err(stop);
        assert!(format!("{error:?}").contains(expected), "{error:?}");
    }
}
