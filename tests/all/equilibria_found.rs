//! All equilibria of a machine are found, and each with what is known of it: against closed forms, and against the zeros
//! and curvatures of potentials written by hand.

use crate::machine::{DOUBLE, machine, parse};
use dwell_dynamics::{
    CoordinateMode, DynamicsError, Equilibrium, Machine, Stability, equilibria,
    equilibria_from_starts, equilibrium_near,
};
use dwell_kinetostatics::{Load, LoadKind, Magnitude, Model};
use dwell_tests::fixtures::scene;
use std::f64::consts::{FRAC_PI_2, PI};

const G: f64 = 9.81;

/// The zeros of a function between two points, by bisection where it changes its sign on a fine grid.
fn zeros(f: impl Fn(f64) -> f64, [from, to]: [f64; 2]) -> Vec<f64> {
    const PARTS: usize = 200_003;
    let at = |k: usize| from + (to - from) * k as f64 / PARTS as f64;
    let mut found = Vec::new();
    for k in 0..PARTS {
        let (mut a, mut b) = (at(k), at(k + 1));
        if f(a) * f(b) > 0.0 {
            continue;
        }
        for _ in 0..60 {
            let middle = 0.5 * (a + b);
            if f(a) * f(middle) <= 0.0 {
                b = middle;
            } else {
                a = middle;
            }
        }
        found.push(a);
    }
    found
}

/// The pendulum of 9.81 N m, with the weight −g cos φ, and a torsion spring −k (φ − φ₀).
fn sprung(stiffness: f64, free_angle: f64) -> Machine {
    let scene = scene("pendulum-a01");
    let spring = Load {
        name: "coil".into(),
        kind: LoadKind::torsion_spring(scene.mechanism.joints[0].bodies, free_angle),
        magnitude: Magnitude::Constant(stiffness),
    };
    machine(&scene, &[spring], &[])
}

/// A spring over several revolutions leaves one, three, five … equilibria of a pendulum, in turn stable and unstable.
#[test]
fn every_equilibrium_of_a_pendulum_with_a_spring_is_found() {
    let mut most = 0;
    for (stiffness, free_angle) in [(1.2, 0.3), (0.9, -1.0), (3.0, 0.5), (30.0, 1.0), (0.5, 2.0)] {
        let force = |q: f64| -G * q.cos() - stiffness * (q - free_angle);
        let interval = [-25.0, 25.1];
        let expected = zeros(force, interval);
        let found = equilibria(&sprung(stiffness, free_angle), interval).unwrap();
        assert_eq!(found.len(), expected.len(), "{stiffness} {free_angle}");
        most = most.max(found.len());
        for (one, q) in found.iter().zip(expected) {
            let error = (one.y[0] - q).abs();
            // The hand-written force rounds, too.
            assert!(error <= one.errors[0] + 1e-13, "{error} {:?}", one.errors);
            assert!(one.errors[0] < 1e-12, "{:?}", one.errors);
            let is_stable = G * q.sin() - stiffness < 0.0;
            let stability = if is_stable {
                Stability::Centre
            } else {
                Stability::Unstable
            };
            assert_eq!(one.stability, stability, "{q}");
        }
    }
    assert!(most >= 5, "{most}");
}

/// Where the spring's line touches the weight's curve both meet in a double zero; a little to one side it is two zeros
/// 1e-4 rad apart, to the other side none.
#[test]
fn zeros_that_touch_are_found_and_not_invented() {
    let stiffness = 4.0_f64;
    for touching in [(stiffness / G).asin(), PI - (stiffness / G).asin()] {
        let free_angle = touching + G * touching.cos() / stiffness;
        let near = [touching - 0.3, touching + 0.31];
        let one = equilibria(&sprung(stiffness, free_angle), near).unwrap();
        assert!(!one.is_empty(), "{touching}");
        for found in &one {
            let error = (found.y[0] - touching).abs();
            assert!(
                error <= found.errors[0] && found.errors[0] < 1e-5,
                "{error} {:?}",
                found.errors
            );
            assert_eq!(found.stability, Stability::Undecided);
        }
        // The force there changes by k over the free angle: its curvature is −g sin φ″ = g cos φ.
        let counts = [-1e-9, 1e-9].map(|aside| {
            let found = equilibria(&sprung(stiffness, free_angle + aside), near).unwrap();
            if let [a, b] = found.as_slice() {
                let apart = 2.0 * (2.0 * stiffness * 1e-9 / (G * touching.cos().abs())).sqrt();
                let measured = b.y[0] - a.y[0];
                assert!((measured / apart - 1.0).abs() < 1e-3, "{measured} {apart}");
                assert_ne!(a.stability, b.stability);
            }
            found.len()
        });
        assert_eq!(counts.iter().sum::<usize>(), 2, "{touching}: {counts:?}");
    }
}

const SHAFT: &str = r#"
[bodies.ground]
points = { A = [0, 0] }
[bodies.shaft]
points = { A = [0, 0] }
mass = 1.0
center = "A"
inertia = 0.02
[joints]
A = { revolute = ["ground.A", "shaft.A"] }
[actuators.phi]
angle = ["ground", "shaft"]
"#;

fn shaft(torque: &str) -> Machine {
    let load =
        format!("{SHAFT}[loads]\npush = {{ torque = \"shaft\", magnitude = \"{torque}\" }}\n");
    machine(&parse(&load), &[], &[])
}

/// A force law that touches zero has an equilibrium there; one with play has one everywhere in it, and not hundreds; without
/// any force every position is one.
#[test]
fn force_laws_that_touch_zero_or_stay_there() {
    let touching = equilibria(&shaft("0.3*(phi - 1)^2*(2 + cos(phi))"), [-3.0, 3.0]).unwrap();
    assert_eq!(touching.len(), 1);
    assert!((touching[0].y[0] - 1.0).abs() <= touching[0].errors[0]);
    assert!(touching[0].errors[0] < 3e-6 && touching[0].neutral.is_empty());
    assert_eq!(touching[0].stability, Stability::Undecided);

    let play = "-5*max(0, phi - 0.4) - 5*min(0, phi + 0.7)";
    let found = equilibria(&shaft(play), [-3.0, 3.0]).unwrap();
    assert_eq!(found.len(), 1, "{found:?}");
    assert_eq!(found[0].stability, Stability::Neutral);
    let [from, to] = found[0].neutral[0].extent.unwrap();
    assert!(
        (from + 0.7).abs() < 1e-12 && (to - 0.4).abs() < 1e-12,
        "{from} {to}"
    );

    for none in ["0*phi", "1e-18*cos(phi)*0"] {
        let found = equilibria(&shaft(none), [-3.0, 3.0]).unwrap();
        assert_eq!(found.len(), 1);
        assert_eq!(found[0].neutral[0].extent, Some([-3.0, 3.0]));
    }
    // A single pulse between the positions of the search: of its two zeros none is lost.
    let pulse = "1 - 2*exp(-((phi - 0.3)/0.01)^2)";
    let half = 0.01 * 2.0_f64.ln().sqrt();
    let found = equilibria(&shaft(pulse), [-3.0, 3.0]).unwrap();
    assert_eq!(found.len(), 2);
    for (one, q) in found.iter().zip([0.3 - half, 0.3 + half]) {
        assert!((one.y[0] - q).abs() < 1e-14, "{} {q}", one.y[0]);
    }
}

/// Two weights that balance about the pin leave the roundings of their moments, at which no equilibrium is found by chance.
#[test]
fn a_balanced_beam_rests_everywhere() {
    let text = r#"
[bodies.ground]
points = { A = [0, 0] }
[bodies.left]
points = { A = [0, 0], P = [-0.3, 0.1] }
mass = 2.0
center = [-0.3, 0.1]
inertia = 0.1
[bodies.right]
points = { P = [0, 0] }
mass = 6.0
center = [0.4, -0.13333333333333333]
inertia = 0.1
[joints]
A = { revolute = ["ground.A", "left.A"] }
P = { weld = ["left.P", "right.P"] }
[actuators.phi]
angle = ["ground", "left"]
[loads]
weight = { gravity = [0, -9.81] }
"#;
    let found = equilibria(&machine(&parse(text), &[], &[]), [-3.0, 3.2]).unwrap();
    assert_eq!(found.len(), 1, "{}", found.len());
    assert_eq!(found[0].stability, Stability::Neutral);
}

fn double(changes: &[(&str, &str)]) -> Machine {
    let mut text = DOUBLE.to_owned();
    for (old, new) in changes {
        assert!(text.contains(old), "{old}");
        text = text.replacen(old, new, 1);
    }
    machine(&parse(&text), &[], &[])
}

/// The equilibria of a machine of two angles within half a revolution and a little about zero.
fn all_of(machine: &Machine) -> Vec<Equilibrium> {
    let first = machine.initial_state(&[0.4, -0.3], &[0.0, 0.0]);
    let range = [-0.96 * PI, 1.04 * PI];
    equilibria_from_starts(machine, &first, &[range; 2], 400).unwrap()
}

/// Both hanging, one standing on the other, both standing; only the first is stable.
#[test]
fn a_double_pendulum_has_four_equilibria() {
    let found = all_of(&double(&[]));
    assert_eq!(found.len(), 4, "{found:?}");
    let signs = [[-1.0, -1.0], [-1.0, 1.0], [1.0, -1.0], [1.0, 1.0]];
    for (one, sign) in found.iter().zip(signs) {
        for (k, sign) in sign.into_iter().enumerate() {
            let error = (one.y[k] - sign * FRAC_PI_2).abs();
            assert!(
                error <= one.errors[k] && one.errors[k] < 1e-13,
                "{error} {:?}",
                one.errors
            );
        }
        let hangs = sign == [-1.0, -1.0];
        let expected = if hangs {
            Stability::Centre
        } else {
            Stability::Unstable
        };
        assert_eq!(one.stability, expected);
    }
    // The same from another order of starts: the result depends on none of them.
    let machine = double(&[]);
    let first = machine.initial_state(&[2.0, 1.0], &[0.0, 0.0]);
    let range = [-0.96 * PI, 1.04 * PI];
    let again = equilibria_from_starts(&machine, &first, &[range; 2], 150).unwrap();
    assert_eq!(again.len(), 4);
}

/// With a coil between both the lower angle gives the upper one: k (q − p − α) = −g m₂ c₂ cos q. So all equilibria are the
/// zeros of one function, and the curvature of the potential decides their stability.
#[test]
fn every_equilibrium_of_a_double_pendulum_with_a_spring_is_found() {
    let (upper, lower) = (G * (1.3 * 0.35 + 0.8 * 0.6), G * 0.8 * 0.25);
    for (k, free) in [(3.0, 0.4), (0.6, -0.9), (20.0, 0.1)] {
        let spring = format!(
            "[loads]\ncoil = {{ torsion-spring = [\"one\", \"two\"], stiffness = {k}, free-angle = {free} }}\n"
        );
        let found = all_of(&double(&[("[loads]\n", &spring)]));
        let p = |q: f64| q - free + lower * q.cos() / k;
        let force = |q: f64| -upper * p(q).cos() + k * (q - p(q) - free);
        let range = [-0.96 * PI, 1.04 * PI];
        let expected = zeros(force, range);
        let expected: Vec<[f64; 2]> = expected.into_iter().map(|q| [p(q), q]).collect();
        let within = |p: f64| range[0] < p && p < range[1];
        let expected: Vec<[f64; 2]> = expected.into_iter().filter(|[p, _]| within(*p)).collect();
        assert_eq!(found.len(), expected.len(), "{k} {free}: {expected:?}");
        for [p, q] in expected {
            let is_there =
                |e: &&Equilibrium| (e.y[0] - p).abs() < 1e-11 && (e.y[1] - q).abs() < 1e-11;
            let one = found.iter().find(is_there).unwrap();
            // V = upper sin p + lower sin q + ½ k (q − p − α)².
            let (pp, qq, pq) = (k - upper * p.sin(), k - lower * q.sin(), -k);
            let is_stable = pp > 0.0 && pp * qq > pq * pq;
            let stability = if is_stable {
                Stability::Centre
            } else {
                Stability::Unstable
            };
            assert_eq!(one.stability, stability, "{p} {q}");
        }
    }
}

/// A balanced wheel at the end of a pendulum rests at every angle: its direction is neutral, and it is left where it starts.
#[test]
fn a_balanced_wheel_is_a_neutral_direction_and_no_failure() {
    let machine = double(&[("center = [0.25, 0]", "center = [0, 0]")]);
    let found = all_of(&machine);
    assert_eq!(found.len(), 2, "{found:?}");
    for (one, p) in found.iter().zip([-FRAC_PI_2, FRAC_PI_2]) {
        assert!((one.y[0] - p).abs() <= one.errors[0], "{:?}", one.y);
        assert!((one.y[1] + 0.3).abs() < 1e-9, "{:?}", one.y);
        assert_eq!(one.neutral.len(), 1);
        assert_eq!(one.neutral[0].direction, [0.0, 1.0]);
        let hangs = p < 0.0;
        let stability = if hangs {
            Stability::Neutral
        } else {
            Stability::Unstable
        };
        assert_eq!(one.stability, stability);
    }
    assert_eq!(found[0].modes().len(), 1);
    let near =
        equilibrium_near(&machine, &machine.initial_state(&[-1.2, 0.7], &[0.5, 0.1])).unwrap();
    assert!(
        (near.y[1] - 0.7).abs() < 1e-9 && near.neutral.len() == 1,
        "{near:?}"
    );
}

/// Against a torque above both weights no position balances: the coordinate and the force are named.
#[test]
fn a_force_that_never_changes_its_sign_is_the_cause() {
    let push = "[loads]\npush = { torque = [\"ground\", \"one\"], magnitude = 40 }\n";
    let machine = double(&[("[loads]\n", push)]);
    let first = machine.initial_state(&[0.4, -0.3], &[0.0, 0.0]);
    let none = equilibria_from_starts(&machine, &first, &[[-3.0, 3.2]; 2], 200);
    let Err(DynamicsError::Unbalanced { actuator: 0, force }) = none else {
        panic!("{none:?}");
    };
    let upper = G * (1.3 * 0.35 + 0.8 * 0.6);
    assert!(
        force[0] >= 40.0 - upper - 1e-9 && force[1] <= 40.0 + upper + 1e-9,
        "{force:?}"
    );
    assert!(force[0] < 40.0 - 0.9 * upper, "{force:?}");
}

/// A five-bar under gravity: at each equilibrium the potential, evaluated around it, is flat, and its curvature decides the
/// stability.
#[test]
fn a_five_bar_rests_where_its_potential_is_flat() {
    let scene = scene("five-bar");
    let model = Model::new(
        &scene.mechanism,
        &scene.masses,
        &scene.assembly.to_configuration(),
        &[],
    );
    let weight = parse(DOUBLE).loads;
    let machine =
        Machine::new(model.unwrap(), &weight, vec![CoordinateMode::Free; 2], &[]).unwrap();
    let first = machine.initial_state(&scene.assembly.coordinates, &[0.0, 0.0]);
    let ranges = [0, 1].map(|k| [first[k] - 3.0, first[k] + 3.2]);
    let found = equilibria_from_starts(&machine, &first, &ranges, 400).unwrap();
    // Where both rods coincide the inertia grows beyond all bounds, so that accelerations vanish; forces do not.
    assert_eq!(found.len(), 6, "{found:?}");
    let mut workspace = machine.workspace();
    let mut potential = |at: &[f64], p: f64, q: f64| {
        let mut state = at.to_vec();
        state[0] += p;
        state[1] += q;
        machine
            .evaluate(0.0, &state, &mut workspace)
            .unwrap()
            .energy()[1]
    };
    let h = 1e-3;
    for one in &found {
        let mut v = |p: f64, q: f64| potential(&one.y, p * h, q * h);
        let slopes = [v(1.0, 0.0) - v(-1.0, 0.0), v(0.0, 1.0) - v(0.0, -1.0)];
        // The third derivatives are of the order of the weights, 10 J, unless the five-bar is nearly stretched.
        assert!(
            slopes.iter().all(|slope| slope.abs() / (2.0 * h) < 1e-3),
            "{slopes:?} {:?}",
            one.y
        );
        let middle = v(0.0, 0.0);
        let pp = v(1.0, 0.0) + v(-1.0, 0.0) - 2.0 * middle;
        let qq = v(0.0, 1.0) + v(0.0, -1.0) - 2.0 * middle;
        let pq = 0.25 * (v(1.0, 1.0) + v(-1.0, -1.0) - v(1.0, -1.0) - v(-1.0, 1.0));
        let is_stable = pp > 0.0 && pp * qq > pq * pq;
        let stability = if is_stable {
            Stability::Centre
        } else {
            Stability::Unstable
        };
        assert_eq!(one.stability, stability, "{:?}", one.y);
    }
}

/// The error of an eigenvalue is never below that against the closed form, and of its order.
#[test]
fn eigenvalues_err_by_no_more_than_they_say() {
    for (stiffness, free_angle) in [
        (1.2, 0.3),
        (0.9, -1.0),
        (30.0, 1.0),
        (9.8, 1.6),
        (9.809_99, 1.571),
    ] {
        for one in equilibria(&sprung(stiffness, free_angle), [-8.0, 8.1]).unwrap() {
            // A curvature k − g sin φ that the position leaves open by g cos φ times its error.
            let square = stiffness - G * one.y[0].sin();
            let position = G * one.y[0].cos().abs() * one.errors[0];
            let unknown = (position + 1e-14 * G) / square.abs().sqrt();
            for ([re, im], error) in one.eigenvalues.iter().zip(&one.eigenvalue_errors) {
                let size = re.hypot(*im);
                let wrong = (size - square.abs().sqrt()).abs();
                assert!(wrong <= error + 1e-15 * size, "{wrong} {error}");
                assert!(*error < 100.0 * unknown, "{error} {unknown}");
            }
        }
    }
}
