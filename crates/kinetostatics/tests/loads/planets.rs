//! Several equal planets: more teeth than the motion needs, so that they share the load.

use crate::scenes::Case;
use dwell_geometry::{BodyId, Vec2};
use dwell_scene::PlaneScene;
use std::f64::consts::TAU;

/// Sun 30 mm, planets 20 mm, ring 70 mm; with additional joints on request.
fn planets(count: usize, extra_joints: &str) -> Case {
    let mut bodies = String::new();
    let (mut joints, mut centers, mut angles) = (String::new(), String::new(), String::new());
    for k in 0..count {
        let at = TAU * k as f64 / count as f64;
        let (x, y) = (0.05 * at.cos(), 0.05 * at.sin());
        centers += &format!(", C{k} = [{x:?}, {y:?}]");
        bodies += &format!("planet{k}.points = {{ C = [0, 0] }}\n");
        joints += &format!(
            "C{k} = {{ revolute = [\"arm.C{k}\", \"planet{k}.C\"] }}\n\
             inner{k} = {{ gear = [\"sun.O\", \"planet{k}.C\"], radii = [0.03, 0.02] }}\n\
             outer{k} = {{ gear = [\"ground.O\", \"planet{k}.C\"], radii = [0.07, 0.02], internal = true }}\n"
        );
        angles += &format!("planet{k} = 0.0\n");
    }
    let text = format!(
        r#"
        [bodies]
        ground.points = {{ O = [0, 0] }}
        sun.points = {{ O = [0, 0] }}
        arm.points = {{ O = [0, 0]{centers} }}
        {bodies}
        [joints]
        {extra_joints}
        O = {{ revolute = ["ground.O", "sun.O"] }}
        arm-pin = {{ revolute = ["ground.O", "arm.O"] }}
        {joints}
        [actuators]
        phi = {{ angle = ["ground", "sun"] }}
        [assembly]
        phi = 0.0
        arm = 0.0
        {angles}
        [loads]
        load = {{ torque = "arm", magnitude = -12.0 }}
        "#
    );
    let scene = PlaneScene::parse("planets.toml", &text).expect("a scene");
    Case::of(&scene, |_| scene.loads.clone())
}

/// Willis: with the ring at rest the arm turns by 30/(30 + 70) of the sun, a planet by −(70/20 − 1) of the arm. The moment of
/// the arm, 12 N·m, needs 3.6 N·m at the sun, of which each planet's tooth, 30 mm from its centre, takes its part.
fn follow(case: &Case, planets: usize, turns: f64) {
    let q = TAU * turns + 0.4;
    let mut memory = case.memory();
    let state = case.evaluate(&mut memory, 0.0, &[q], &[2.0], &[0.0]);
    let body = |name: &str| {
        let found = case.mechanism.bodies.iter().position(|b| b.name == name);
        state.bodies().body(BodyId(found.expect("a body")))
    };
    // Least squares over a dozen rows leave 1e-14; of angles of some hundred radians the last digits are lost.
    let rounding = 1e-13 + 16.0 * f64::EPSILON * q.abs();
    let follows = |name: &str, ratio: f64| {
        let found = body(name);
        let error = (found.rotation - Vec2::from_angle(ratio * q)).norm();
        assert!(error < rounding, "{planets} {turns} {name}: {error:e}");
        let error = (found.angular_velocity - 2.0 * ratio).abs();
        assert!(error < 1e-13, "{planets} {turns} {name}: {error:e}");
    };
    follows("arm", 0.3);
    for k in 0..planets {
        follows(&format!("planet{k}"), -0.75);
    }
    let result = state.inverse_dynamics();
    assert!((result.tau[0] - 3.6).abs() < 1e-12, "{}", result.tau[0]);
    for k in 0..planets {
        for teeth in ["inner", "outer"] {
            let force = case.reaction(result, &format!("{teeth}{k}.tooth"));
            let share = 3.6 / 0.03 / planets as f64;
            assert!(
                (force.abs() - share).abs() < 1e-10,
                "{teeth}{k}: {force} {share}"
            );
        }
    }
}

#[test]
fn redundant_planets_turn_on_and_share_the_load() {
    for count in [1, 2, 3, 4] {
        let case = planets(count, "");
        assert_eq!(case.model.plan().range().limits(), None, "{count} planets");
        for turns in [0.0, 0.3, 7.9, 8.1, 100.0, -100.0] {
            follow(&case, count, turns);
        }
    }
}

/// A pin or a mesh that is written twice changes nothing, wherever it stands among the joints.
#[test]
fn joints_of_gears_written_twice_change_no_motion() {
    for twin in [
        "O-twin = { revolute = [\"ground.O\", \"sun.O\"] }",
        "arm-twin = { revolute = [\"ground.O\", \"arm.O\"] }",
        "C-twin = { revolute = [\"arm.C0\", \"planet0.C\"] }",
    ] {
        let case = planets(1, twin);
        assert_eq!(case.model.plan().range().limits(), None, "{twin}");
        for turns in [0.3, 100.0] {
            follow(&case, 1, turns);
        }
    }
    let case = planets(
        1,
        "twin = { gear = [\"ground.O\", \"planet0.C\"], radii = [0.07, 0.02], internal = true }",
    );
    let mut memory = case.memory();
    for turns in [0.3, 100.0] {
        let q = TAU * turns;
        let state = case.evaluate(&mut memory, 0.0, &[q], &[2.0], &[0.0]);
        let result = state.inverse_dynamics();
        // The two meshes share the force of one: 120 N.
        for teeth in ["outer0", "twin"] {
            let force = case.reaction(result, &format!("{teeth}.tooth"));
            assert!((force.abs() - 60.0).abs() < 1e-10, "{teeth}: {force}");
        }
        assert!((result.tau[0] - 3.6).abs() < 1e-12);
    }
}
