//! Conservative motions by quadrature, against elliptic functions and integrators.

use crate::machine::{final_state, machine, parse};
use dwell_dynamics::{
    DynamicsError, Machine, Method, MotionClass, Orbit, ReducedState, Stability, equilibria,
    motion_class,
};
use dwell_geometry::vec2;
use dwell_kinetostatics::{Load, LoadKind, Magnitude};
use dwell_tests::fixtures::{model_for, scene};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

const G: f64 = 9.81;

fn pendulum() -> Machine {
    machine(&scene("pendulum-a01"), &[], &[])
}

fn from(q: f64, q_dot: f64) -> ReducedState {
    ReducedState { t: 0.0, q, q_dot }
}

/// The complete elliptic integral of the first kind, modulus k, by the arithmetic-geometric mean.
fn complete_elliptic(k: f64) -> f64 {
    let (mut a, mut b) = (1.0_f64, ((1.0 - k) * (1.0 + k)).sqrt());
    while (a - b).abs() > 1e-15 * a {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    PI / (a + b)
}

/// The amplitude am(u, k), by the same mean.
fn amplitude(u: f64, k: f64) -> f64 {
    let (mut a, mut b) = (vec![1.0_f64], ((1.0 - k) * (1.0 + k)).sqrt());
    let mut c = vec![k];
    while c[c.len() - 1].abs() > 1e-16 {
        let last = a[a.len() - 1];
        a.push(0.5 * (last + b));
        c.push(0.5 * (last - b));
        b = (last * b).sqrt();
    }
    let n = a.len() - 1;
    let mut phi = f64::from(1_u32 << n) * a[n] * u;
    for i in (1..=n).rev() {
        phi = 0.5 * (phi + (c[i] / a[i] * phi.sin()).asin());
    }
    phi
}

/// A01 at time t, released level on the left: x and y. sin(θ/2) = k sn(K − ω₀ t), θ from the bottom.
fn a01(t: f64) -> [f64; 2] {
    let k = FRAC_PI_2.sin() * (0.25 * PI).sin();
    let quarter = complete_elliptic(k);
    let u = (quarter - G.sqrt() * t) % (4.0 * quarter);
    let half = (k * amplitude(u, k).sin()).asin();
    [-(2.0 * half).sin(), -(2.0 * half).cos()]
}

#[test]
fn val_pendulum_a01() {
    let machine = pendulum();
    let orbit = Orbit::loaded(&machine, from(PI, 0.0)).expect("an orbit");
    // 50 digits: 2.3678419475762374493 s.
    let period = 2.367_841_947_576_237_4;
    assert!(
        (orbit.period / period - 1.0).abs() < 4e-15,
        "{}",
        orbit.period
    );
    assert!((period * G.sqrt() / (4.0 * complete_elliptic(0.5_f64.sqrt())) - 1.0).abs() < 1e-15);
    let MotionClass::Libration {
        turning_points: [a, b],
    } = orbit.motion_class
    else {
        panic!("{:?}", orbit.motion_class)
    };
    assert!(a == PI && (b - TAU).abs() < 2e-15, "{a} {b}");
    // The energy of A01 is zero; what it exchanges is m g l.
    assert!(orbit.energy.abs() < 1e-14 && (orbit.max_kinetic / G - 1.0).abs() < 1e-3);
    let difference = |q: f64, t: f64| {
        let [x, y] = a01(t);
        (q.cos() - x).hypot(q.sin() - y)
    };
    let mut worst = 0.0_f64;
    for i in 0..=1000 {
        let t = 2.0 * f64::from(i) + 0.123;
        worst = worst.max(difference(orbit.state_at(t).q, t));
    }
    println!("quadrature {worst:e} m");
    // A rounding of the period in each of 845 swings, at up to 4.4 m/s.
    assert!(worst < 2e-11, "{worst:e}");
    let y = machine.initial_state(&[PI], &[0.0]);
    for (method, tolerance, bound) in [(Method::Tsit45, 1e-13, 1e-6), (Method::Bdf, 1e-12, 1e-4)] {
        let end = final_state(&machine, &y, 2000.0, method, tolerance);
        let error = difference(end[0], 2000.0);
        println!("{} {error:e} m", method.name());
        assert!(error < bound, "{} {error:e}", method.name());
    }
}

/// Periods on both sides of the separatrix, as near as a thousandth of the speed: elliptic integrals.
#[test]
fn periods_of_a_pendulum() {
    let machine = pendulum();
    let natural = G.sqrt();
    // The largest speed in parts of that of the separatrix.
    for part in [
        1e-6_f64, 0.01, 0.3, 0.9, 0.99, 0.999, 1.001, 1.01, 1.1, 3.0, 100.0,
    ] {
        for direction in [1.0, -1.0] {
            let start = from(1.5 * PI, direction * 2.0 * natural * part);
            let orbit = Orbit::loaded(&machine, start).expect("an orbit");
            let exact = if part < 1.0 {
                4.0 / natural * complete_elliptic(part)
            } else {
                2.0 / (natural * part) * complete_elliptic(1.0 / part)
            };
            let error = orbit.period / exact - 1.0;
            println!("{part}: {error:e} with {} points", orbit.points);
            // Next to the separatrix, the rounding of g l over the energy left at the top. A small
            // swing feels the rounding of the coordinate over its amplitude.
            let near = 1.0 / (1.0 - part * part).abs();
            let tolerance = 2e-15 + 1e-16 * near.min(1e6) + 2e-16 / part;
            assert!(error.abs() < tolerance, "{part}: {error:e} {tolerance:e}");
            let rotates = matches!(orbit.motion_class, MotionClass::Rotation { .. });
            assert_eq!(rotates, part > 1.0, "{part}");
        }
    }
}

/// What becomes of a pendulum pushed from its bottom.
#[test]
fn fates_of_a_pendulum() {
    let machine = pendulum();
    let push = |part: f64| {
        let start = from(1.5 * PI, 2.0 * G.sqrt() * part);
        motion_class(&machine, start).expect("a fate")
    };
    let MotionClass::Rotation {
        potential_maximum_at: top,
        kinetic_at_maximum: spare,
        period,
    } = push(1.0 + 1e-12)
    else {
        panic!("turns over")
    };
    // 2 m g l (1 + 1e-12)² leaves 4e-12 m g l at the top.
    assert!((spare / (4e-12 * G) - 1.0).abs() < 1e-3, "{spare:e}");
    assert!((top - 2.5 * PI).abs() < 1e-14 && period == TAU, "{top}");
    assert!(matches!(push(1.0 - 1e-12), MotionClass::Libration { .. }));
    let MotionClass::Asymptotic { to } = push(1.0) else {
        panic!("creeps")
    };
    assert!((to - 2.5 * PI).abs() < 1e-14, "{to}");
    let start = from(1.5 * PI, 2.0 * G.sqrt());
    let none = Orbit::loaded(&machine, start);
    assert!(
        matches!(none, Err(DynamicsError::AsymptoticMotion { .. })),
        "{none:?}"
    );
    for rest in [FRAC_PI_2, 1.5 * PI] {
        assert_eq!(
            motion_class(&machine, from(rest, 0.0)),
            Ok(MotionClass::Equilibrium)
        );
    }
    // A turning point is where arcsine says.
    let MotionClass::Libration {
        turning_points: [a, b],
    } = push(0.3)
    else {
        panic!("swings")
    };
    let amplitude_angle = 2.0 * 0.3_f64.asin();
    assert!(
        (a - 1.5 * PI + amplitude_angle).abs() < 4e-15
            && (b - 1.5 * PI - amplitude_angle).abs() < 4e-15
    );
}

/// A block on a spring along a line without ends: one sine, whatever its amplitude and wherever it is.
#[test]
// Long: one derivation by hand.
fn a_block_on_a_spring() {
    let scene = parse(
        r#"
[bodies.ground]
points = { O = [0, 0], W = [-1, 0] }
[bodies.block]
points = { P = [0, 0] }
mass = 2.0
center = "P"
inertia = 0.1
[joints]
slide = { prismatic = ["ground.O", "block.P"], axis = [1, 0] }
[actuators.s]
length = "slide"
[loads]
spring = { spring = ["ground.W", "block.P"], stiffness = 50.0, free-length = 1.25 }
"#,
    );
    let machine = machine(&scene, &[], &[]);
    let natural = 5.0;
    for (q, q_dot) in [
        (0.26, 0.0),
        (0.25, 1.0),
        (0.9, -2.0),
        (-0.1, 0.4),
        (0.25 + 1e-7, 0.0),
    ] {
        let orbit = Orbit::loaded(&machine, from(q, q_dot)).expect("an orbit");
        let displacement = q - 0.25;
        let size = displacement.hypot(q_dot / natural);
        // The coordinate's own rounding over the amplitude.
        let rounding = 2e-16 / size;
        let error = orbit.period * natural / TAU - 1.0;
        assert!(error.abs() < 1e-15 + rounding, "{q} {q_dot}: {error:e}");
        for i in 0..20 {
            let t = 0.37 * f64::from(i);
            let (sin, cos) = (natural * t).sin_cos();
            let exact = [
                0.25 + displacement * cos + q_dot / natural * sin,
                q_dot * cos - displacement * natural * sin,
            ];
            let found = orbit.state_at(t);
            // A few roundings of phases up to 35 rad.
            assert!(
                (found.q - exact[0]).abs() < 3e-15 + 2e-14 * size,
                "{found:?}"
            );
            assert!(
                (found.q_dot - exact[1]).abs() < 1e-14 + 1e-13 * size,
                "{found:?}"
            );
        }
        // The first passage of a coordinate, and none beyond the turning points.
        let t = orbit.time_at(0.25 - 0.3 * size).expect("a time");
        let displacement = orbit.state_at(t).q - 0.25 + 0.3 * size;
        // Two roundings of a phase of up to 2π; met: 6e-16.
        assert!(
            displacement.abs() < 3e-15 * size.max(0.5) && t >= 0.0,
            "{displacement:e}"
        );
        assert!(
            orbit
                .time_at(0.25 - 0.3 * size)
                .is_some_and(|t| t < orbit.period)
        );
        // It was on the same side until then.
        let side = |t: f64| orbit.state_at(t).q > 0.25 - 0.3 * size;
        assert!((0..100).all(|i| side(t * f64::from(i) / 100.0) == side(0.0)));
        assert_eq!(orbit.time_at(0.25 + 1.01 * size), None);
    }
}

/// A heavy crank-rocker, turning over and swinging, against an integrator.
#[test]
fn a_heavy_crank_rocker() {
    let mut scene = scene("crank-rocker");
    let model = model_for(&scene, &[]);
    let free = Orbit::new(&model, from(PI / 3.0, 10.0)).expect("a period");
    // Independent 40 digits: 0.7314883837332249723 s.
    assert!((free.period / 0.731_488_383_733_225 - 1.0).abs() < 4e-15);
    scene.loads = weight();
    let machine = machine(&scene, &[], &[]);
    for (speed, rotates) in [
        (10.0, true),
        (-10.0, true),
        (0.5, false),
        (-0.5, false),
        (0.0, false),
    ] {
        let start = from(PI / 3.0, speed);
        let orbit = Orbit::loaded(&machine, start).expect("an orbit");
        assert_eq!(
            matches!(orbit.motion_class, MotionClass::Rotation { .. }),
            rotates,
            "{:?}",
            orbit.motion_class
        );
        let y = machine.initial_state(&[start.q], &[speed]);
        for part in [0.3, 0.8, 1.0, 2.6] {
            let t = part * orbit.period;
            let end = final_state(&machine, &y, t, Method::Tsit45, 1e-13);
            let exact = orbit.state_at(t);
            // Tsit45's own error: a thousand times its tolerance where the motion lingers near the summit.
            assert!(
                (end[0] - exact.q).abs() < 2e-10,
                "{speed} {part} {:e}",
                end[0] - exact.q
            );
            assert!((end[1] - exact.q_dot).abs() < 1e-9, "{speed} {part}");
        }
    }
}

/// Gravity for a scene that has none.
fn weight() -> Vec<Load> {
    vec![Load {
        name: "weight".into(),
        kind: LoadKind::Gravity {
            direction: vec2(0.0, -1.0),
        },
        magnitude: Magnitude::Constant(G),
    }]
}

/// A heavy six-bar that turns only between two limit positions: at its lowest it swings with its natural
/// frequency; pushed harder it reaches one of them.
#[test]
fn a_swing_within_limits() {
    let mut scene = scene("class-three-six-bar");
    scene.loads = weight();
    let machine = machine(&scene, &[], &[]);
    let (low, to) = machine.model().plan().range().limits().expect("limits");
    let found = equilibria(&machine, [low + 1e-3, to - 1e-3]).expect("equilibria");
    let rest = found
        .iter()
        .find(|e| e.stability == Stability::Centre)
        .expect("a lowest position");
    let q = rest.y[0];
    let natural = TAU / rest.modes()[0].angular_frequency;
    let swing = |away: f64| {
        Orbit::loaded(&machine, from(q + away, 0.0))
            .expect("an orbit")
            .period
    };
    // The period of a small swing grows with the square of its width.
    let [wide, narrow] = [2e-4, 1e-4].map(swing);
    let limit = narrow - (wide - narrow) / 3.0;
    assert!((limit / natural - 1.0).abs() < 1e-9, "{limit} {natural}");
    let orbit = Orbit::loaded(&machine, from(q + 0.1, 0.0)).expect("an orbit");
    let y = machine.initial_state(&[q + 0.1], &[0.0]);
    let end = final_state(&machine, &y, orbit.period, Method::Tsit45, 1e-13);
    assert!((end[0] - q - 0.1).abs() < 1e-11, "{:e}", end[0] - q - 0.1);
    for (speed, end) in [(1e3, to), (-1e3, low)] {
        let Ok(MotionClass::ReachesLimit { at }) = motion_class(&machine, from(q, speed)) else {
            panic!("reaches its limit")
        };
        assert!((at - end).abs() < 1e-12);
    }
}

/// A wheel with an unbalanced pinion of as many turns in one of its own. At 32 equally spaced positions 16, 32 or 64
/// waves look like none; in turns of the pinion its period is the same integral for all.
#[test]
fn waves_that_equally_spaced_points_do_not_see_are_resolved() {
    for waves in [15.0, 16.0, 32.0, 64.0] {
        let text = format!(
            r#"
[bodies.ground]
points = {{ A = [0, 0], B = [{centres}, 0] }}
[bodies.wheel]
points = {{ A = [0, 0] }}
mass = 1
center = "A"
inertia = 0.5
[bodies.pinion]
points = {{ B = [0, 0] }}
mass = 0.1
center = [0.005, 0]
inertia = 1e-6
[joints]
A = {{ revolute = ["ground.A", "wheel.A"] }}
B = {{ revolute = ["ground.B", "pinion.B"] }}
mesh = {{ gear = ["wheel.A", "pinion.B"], radii = [{waves}, 1] }}
[actuators.phi]
angle = ["ground", "wheel"]
[assembly]
phi = 0.0
pinion = 0.0
[loads]
weight = {{ gravity = [0, -9.81] }}
"#,
            centres = waves + 1.0
        );
        let scene = parse(&text);
        let found = Orbit::loaded(&machine(&scene, &[], &[]), from(0.0, 0.17)).unwrap();
        let m = 0.5 + waves * waves * (1e-6 + 0.1 * 0.005 * 0.005);
        let kinetic = |u: f64| 0.5 * m * 0.17 * 0.17 + 0.1 * G * 0.005 * u.sin();
        let slowness = |k: u32| (m / (2.0 * kinetic(TAU * f64::from(k) / 997.0))).sqrt();
        let period = TAU / 997.0 * (0..997).map(slowness).sum::<f64>();
        let error = (found.period / period - 1.0).abs();
        assert!(error < 1e-12, "{waves}: {} for {period}", found.period);
    }
}
