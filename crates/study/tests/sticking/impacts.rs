//! The effects of an impact on a mechanism: impulses in its pins, momentum of colliding masses.

use crate::{run, tolerance};
use dwell_dynamics::{ContactEvent, Method, StopChange};
use dwell_scene::PlaneScene;
use dwell_study::models::{build_machine, with_drive_loads};
use std::f64::consts::PI;

/// The times of the impacts, the impulses along their coordinates, the changes of speeds and the states behind.
fn impacts(run: &crate::Run) -> Vec<(f64, f64, Vec<f64>, Vec<f64>)> {
    let of_kind = |event: &ContactEvent| match event {
        ContactEvent::Stop {
            t,
            y,
            change: StopChange::Impact { impulse, changes },
            ..
        } => Some((*t, *impulse, changes.clone(), y.clone())),
        ContactEvent::Stop { .. } | ContactEvent::Friction { .. } | ContactEvent::Switch { .. } => {
            None
        }
    };
    run.events.iter().filter_map(of_kind).collect()
}

fn near(found: f64, expected: f64, allowed: f64) {
    let error = (found - expected).abs() / expected.abs().max(1.0);
    assert!(
        error <= allowed,
        "{found:?} is {error:.1e} from {expected:?}"
    );
}

/// A bar that turns between two stops strikes them every 2 rad over its speed, which shrinks by e each time: along its
/// coordinate by J (1 + e) ω, in its pin by m l (1 + e) ω across the bar.
#[test]
fn a_bar_between_two_stops_strikes_them_with_known_impulses() {
    let (mass, arm, inertia, e, speed) = (2.0, 0.3, 0.05, 0.5_f64, 4.0_f64);
    let text = format!(
        r#"
[bodies.ground]
points = {{ A = [0, 0] }}
[bodies.bar]
points = {{ A = [0, 0] }}
mass = {mass:?}
center = [{arm:?}, 0]
inertia = {inertia:?}
[joints]
pin = {{ revolute = ["ground.A", "bar.A"] }}
[actuators.phi]
angle = ["ground", "bar"]
[assembly]
phi = 0.0
[stops]
both = {{ coordinate = "phi", min = -1.0, max = 1.0, restitution = {e:?} }}
[requests]
reactions = ["pin.x", "pin.y"]
[motion]
initial-velocity = {speed:?}
duration = 3.0
"#
    );
    let about_pin = inertia + mass * arm * arm;
    let scene = PlaneScene::parse("scene.toml", &text).unwrap_or_else(|e| panic!("{e:?}"));
    let loaded = with_drive_loads(&scene).unwrap_or_else(|e| panic!("{e}"));
    let spec = scene.motion.as_ref().expect("a motion");
    let machine = build_machine(&loaded, spec, &scene.requests.reactions).expect("a machine");
    let mut workspace = machine.workspace();
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        let all = impacts(&run);
        // 1/4, then 2/2 and 2/1 later.
        assert_eq!(all.len(), 2, "{method:?}");
        let (mut time, mut before, mut side) = (1.0 / speed, speed, 1.0_f64);
        for (t, impulse, changes, y) in all {
            near(t, time, allowed);
            near(impulse, -side * about_pin * (1.0 + e) * before, allowed);
            let state = machine.evaluate(t, &y, &mut workspace).expect("a state");
            let pin = state.impulses(&changes).reactions;
            let change = -side * (1.0 + e) * before * mass * arm;
            let angle: f64 = side;
            near(pin[0].abs(), (change * angle.sin()).abs(), allowed);
            near(pin[1].abs(), (change * angle.cos()).abs(), allowed);
            before *= e;
            time += 2.0 / before;
            side = -side;
        }
    }
}

/// One block runs into the end of its slot in another: their momentum stays, their relative speed turns.
#[test]
fn two_masses_that_strike_each_other_keep_their_momentum() {
    let (first, second, e, speed) = (3.0, 2.0, 0.6, 2.0);
    let text = format!(
        r#"
[bodies.ground]
points = {{ A = [0, 0] }}
[bodies.frame]
points = {{ A = [0, 0] }}
mass = {first:?}
center = [0, 0]
[bodies.block]
points = {{ A = [0, 0] }}
mass = {second:?}
center = [0, 0]
[joints]
track = {{ prismatic = ["ground.A", "frame.A"], axis = [1, 0] }}
slot = {{ prismatic = ["frame.A", "block.A"], axis = [1, 0] }}
[actuators.s]
length = "track"
[actuators.u]
length = "slot"
[assembly]
s = 0.0
u = 0.0
[stops]
end = {{ coordinate = "u", min = -1.0, max = 1.0, restitution = {e:?} }}
[motion]
initial-velocity = {{ s = 0.0, u = {speed:?} }}
duration = 10.0
"#
    );
    let momentum = second * speed;
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        let all = impacts(&run);
        let (mut time, mut relative) = (1.0 / speed, speed);
        assert!(all.len() >= 3, "{method:?} {}", all.len());
        for (t, impulse, _, y) in all {
            near(t, time, 10.0 * allowed);
            let [s, u] = [y[2], y[3]];
            assert!((first * s + second * (s + u) - momentum).abs() < 1e-12 * momentum);
            let reduced = first * second / (first + second);
            near(
                impulse.abs(),
                (reduced * (1.0 + e) * relative).abs(),
                allowed,
            );
            relative *= -e;
            near(u, relative, allowed);
            time += 2.0 / relative.abs();
        }
    }
}

/// Carlson's symmetric elliptic integral of the first kind, by duplication (Carlson, Numer. Math. 33, 1979).
fn carlson_rf(mut x: f64, mut y: f64, mut z: f64) -> f64 {
    loop {
        let mean = (x + y + z) / 3.0;
        let [u, v, w] = [x, y, z].map(|part| 1.0 - part / mean);
        if u.abs().max(v.abs()).max(w.abs()) < 1e-3 {
            let (e2, e3) = (u * v - w * w, u * v * w);
            let series = 1.0 - e2 / 10.0 + e3 / 14.0 + e2 * e2 / 24.0 - 3.0 * e2 * e3 / 44.0;
            return series / mean.sqrt();
        }
        let lambda = (x * y).sqrt() + (y * z).sqrt() + (z * x).sqrt();
        [x, y, z] = [x, y, z].map(|part| 0.25 * (part + lambda));
    }
}

/// The time (s) in which a pendulum of 1 m falls from rest at an amplitude to an angle, both from the vertical:
/// √(l/g) (K(k) − F(φ, k)) with k = sin(amplitude/2), k sin φ = sin(angle/2).
fn time_of_fall(amplitude: f64, angle: f64, gravity: f64) -> f64 {
    let k = (0.5 * amplitude).sin();
    let sine = (0.5 * angle).sin() / k;
    let complete = carlson_rf(0.0, 1.0 - k * k, 1.0);
    let part = sine * carlson_rf(1.0 - sine * sine, 1.0 - (k * sine).powi(2), 1.0);
    (complete - part) / gravity.sqrt()
}

/// A pendulum under gravity falls from 2 rad on a stop at 0.3 rad, and rises after each impact to the amplitude that
/// the restitution leaves: cos θ₁ = cos θₛ − e² (cos θₛ − cos θ₀).
#[test]
fn a_bouncing_pendulum_has_the_times_of_elliptic_integrals() {
    const G: f64 = 9.81;
    let (amplitude, stop, e) = (2.0_f64, 0.3_f64, 0.7_f64);
    // The complete integral at k = sin 45° is Γ(1/4)²/(4√π).
    let known = time_of_fall(PI / 2.0, 0.0, 1.0);
    near(known, 1.854_074_677_301_371_9, 1e-15);
    let text = format!(
        r#"
[bodies.ground]
points = {{ O = [0, 0] }}
[bodies.bob]
points = {{ O = [0, 0] }}
mass = 3.0
center = [1, 0]
[joints]
O = {{ revolute = ["ground.O", "bob.O"] }}
[actuators.p]
angle = ["ground", "bob"]
[assembly]
p = {amplitude:?}
[loads]
weight = {{ gravity = [{G:?}, 0] }}
[stops]
buffer = {{ coordinate = "p", min = {stop:?}, restitution = {e:?} }}
[motion]
duration = 4.0
"#
    );
    let mut expected = vec![time_of_fall(amplitude, stop, G)];
    let mut cosine = amplitude.cos();
    for _ in 0..4 {
        cosine = stop.cos() - e * e * (stop.cos() - cosine);
        let flight = 2.0 * time_of_fall(cosine.acos(), stop, G);
        expected.push(expected[expected.len() - 1] + flight);
    }
    assert!(expected[4] < 4.0, "{expected:?}");
    for method in Method::ALL {
        let [rtol, allowed] = tolerance(method);
        let run = run(&text, method, rtol);
        let found = impacts(&run);
        for (k, time) in expected.iter().enumerate() {
            println!("{method:?} {k} {:e}", found[k].0 - time);
            near(found[k].0, *time, 20.0 * allowed);
        }
    }
}
