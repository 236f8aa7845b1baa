//! Loads that feel an angle feel its whole turns: a body that points to −x has no jump there.

use crate::scenes::{Case, body, load, varied};
use dwell_geometry::{BodyId, Coordinate, Mechanism};
use dwell_kinetostatics::{Load, LoadKind, Signal};
use std::f64::consts::{PI, TAU};

/// A drag link: every body turns with the crank, over and over.
const DRAG_LINK: &str = r#"
    [bodies]
    ground.points = { A = [0, 0], D = [0.1, 0] }
    crank.points = { A = [0, 0], B = [0.4, 0] }
    coupler.points = { B = [0, 0], C = [0.35, 0] }
    follower = { points = { D = [0, 0], C = [0.42, 0] }, mass = 0.5, center = [0.2, 0], inertia = 0.01 }
    [joints]
    A = { revolute = ["ground.A", "crank.A"] }
    B = { revolute = ["crank.B", "coupler.B"] }
    C = { revolute = ["coupler.C", "follower.C"] }
    D = { revolute = ["ground.D", "follower.D"] }
    [actuators]
    phi = { angle = ["ground", "crank"] }
"#;

const STIFFNESS: f64 = 3.0;
const FREE: f64 = 0.4;

fn pair(mechanism: &Mechanism) -> [BodyId; 2] {
    ["ground", "follower"].map(|name| body(mechanism, name))
}

fn torsion(mechanism: &Mechanism) -> Vec<Load> {
    let kind = LoadKind::torsion_spring(pair(mechanism), FREE);
    vec![load("torsion", kind, STIFFNESS)]
}

/// The same spring as a couple whose magnitude depends on the angle.
fn commanded(mechanism: &Mechanism) -> Vec<Load> {
    let bodies = pair(mechanism);
    let signal = Signal::Value(Coordinate::Angle(bodies));
    let couple = [STIFFNESS * FREE, -STIFFNESS];
    vec![varied("couple", LoadKind::couple(bodies), signal, &couple)]
}

fn drag_link(follower_angle: f64, loads: fn(&Mechanism) -> Vec<Load>) -> Case {
    let text = format!("{DRAG_LINK}[assembly]\nphi = 2.0\nfollower = {follower_angle}\n");
    Case::parse(&text, loads)
}

/// The couple on the follower and its counted angle, at rest.
fn couple(case: &Case, q: &[f64]) -> [f64; 2] {
    let (mut memory, rest) = (case.memory(), vec![0.0; q.len()]);
    let state = case.evaluate(&mut memory, 0.0, q, &rest, &rest);
    let [ground, follower] = pair(&case.mechanism);
    let wrenches = &state.loads().wrenches;
    let on_follower = wrenches.iter().find(|wrench| wrench.body == follower);
    let angle = state.bodies().angle([ground, follower])[0];
    [on_follower.expect("an act").couple, angle]
}

/// A few turns: couple and angle keep in step, across ±π and beyond.
#[test]
fn a_spring_winds_up_turn_by_turn() {
    for loads in [torsion, commanded] {
        let case = drag_link(2.0, loads);
        let [_, assembled] = couple(&case, &[2.0]);
        for revolutions in [-2.0, -1.0, 1.0, 3.0] {
            let [_, angle] = couple(&case, &[2.0 + TAU * revolutions]);
            // Rounding of angles up to 20 rad.
            assert!(
                (angle - assembled - TAU * revolutions).abs() < 2e-14,
                "{revolutions}"
            );
        }
        let [mut before, mut last] = couple(&case, &[2.0]);
        for k in 1..200 {
            let [now, angle] = couple(&case, &[2.0 + 0.05 * f64::from(k)]);
            // The follower turns by at most twice what the crank does.
            assert!((angle - last).abs() < 0.1, "{k}: {last} to {angle}");
            let wound = -STIFFNESS * (angle - last);
            // Rounding of couples up to 40 N m.
            assert!((now - before - wound).abs() < 4e-14, "{k}");
            (before, last) = (now, angle);
        }
    }
}

/// The initial guess of the angle determines how far the spring is wound.
#[test]
fn a_spring_is_wound_as_the_rough_angle_says() {
    let mut about = [0.0, TAU, -TAU].map(|more| {
        let case = drag_link(2.0 + more, torsion);
        couple(&case, &[2.0])
    });
    let [couple, angle] = about[0];
    assert!((angle - 2.0).abs() < PI && (couple + STIFFNESS * (angle - FREE)).abs() < 1e-14);
    about[1][1] -= TAU;
    about[2][1] += TAU;
    for [_, other] in about {
        assert!((other - angle).abs() < 1e-14);
    }
    // A turn more winds it by 2π.
    assert!((about[1][0] - couple + STIFFNESS * TAU).abs() < 1e-14);
}

/// By virtual work: the generalised force is the fall of ½ k (θ − free)² next to θ = π too.
#[test]
fn a_spring_gives_back_what_it_took_across_the_half_turn() {
    let case = drag_link(2.0, torsion);
    let mut memory = case.memory();
    let mut energy = |q: f64| {
        let state = case.evaluate(&mut memory, 0.0, &[q], &[0.0], &[0.0]);
        state.potential_energy(0).expect("it has one")
    };
    let around: Vec<f64> = (0..=400)
        .map(|k| energy(2.0 + 0.01 * f64::from(k)))
        .collect();
    let mut crossed = false;
    for k in 2..=398 {
        let h = 0.01;
        let fall =
            (8.0 * (around[k - 1] - around[k + 1]) - (around[k - 2] - around[k + 2])) / (12.0 * h);
        let q = 2.0 + h * k as f64;
        let [_, angle] = couple(&case, &[q]);
        crossed |= (angle - PI).abs() < 0.02;
        let mut force = [0.0];
        let mut state = case.evaluate(&mut memory, 0.0, &[q], &[0.0], &[0.0]);
        state.generalised_forces(&mut force);
        // h⁴/30 times the fifth derivative of the energy; 1.4e-8 W is met.
        assert!((fall - force[0]).abs() < 3e-8, "{k}: {fall} {}", force[0]);
    }
    assert!(crossed);
}

/// Without stored poses: with several actuators, the pose is followed from the start.
#[test]
fn turns_are_counted_with_several_actuators() {
    // The follower's pivot stands on a slide.
    let text = DRAG_LINK
        .replace("ground.D\", \"follower.D", "base.D\", \"follower.D")
        .replace("    [joints]\n", "    base.points.D = [0, 0]\n    [joints]\n    guide = { prismatic = [\"ground.D\", \"base.D\"], axis = [1, 0] }\n");
    let text =
        format!("{text}    x = {{ length = \"guide\" }}\n[assembly]\nphi = 2.0\nfollower = 2.0\n");
    let fixed_pivot = drag_link(2.0, torsion);
    let case = Case::parse(&text, torsion);
    let mut wound = false;
    for q in [2.0, 3.5, 5.0, 8.0, -3.0] {
        let [one, _] = couple(&fixed_pivot, &[q]);
        let [two, angle] = couple(&case, &[q, 0.0]);
        wound |= angle > PI;
        // Rounding of couples up to 40 N m.
        assert!((one - two).abs() < 4e-14, "{q}: {one} {two}");
    }
    assert!(wound);
}

/// Between two bodies of which only one has a rough angle, the other is within half a turn of it, in any direction of
/// both.
#[test]
fn an_angle_that_is_not_told_is_within_half_a_turn() {
    let between = |mechanism: &Mechanism| {
        let kind = LoadKind::torsion_spring(
            ["coupler", "follower"].map(|name| body(mechanism, name)),
            0.0,
        );
        vec![load("torsion", kind, STIFFNESS)]
    };
    // The follower points to 3.03 rad and the coupler to -2.02, 1.24 rad before it.
    for guess in ["follower = 3.0", "coupler = -2.0", "follower = 9.3"] {
        let case = Case::parse(
            &format!("{DRAG_LINK}[assembly]\nphi = 2.0\n{guess}\n"),
            between,
        );
        let [torque, _] = couple(&case, &[2.0]);
        assert!(
            (torque / STIFFNESS - 1.24).abs() < 0.01,
            "{guess}: {torque}"
        );
    }
}
