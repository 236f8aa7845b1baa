//! The data of scenes in space.

use super::format::{merged, tables, tables_of_examples};
use super::mutations::pieces;
use super::{IN_SPACE, WHOLE, render};
use crate::keys::kinds;
use crate::{PlaneScene, Scene, SpaceScene};
use dwell_geometry::space::{ActuatorKind, JointKind, Rotation, Vec3, vec3};
use dwell_geometry::{BodyId, JointId};
use dwell_kinetostatics::space::{Direction, Load, LoadKind};
use dwell_kinetostatics::{Friction, FrictionContact, Magnitude};
use std::f64::consts::{PI, TAU};

fn close(a: Vec3, b: Vec3) -> bool {
    (a - b).norm() < 1e-15
}

#[test]
fn points_with_three_numbers_make_a_scene_one_in_space() {
    let read = |text: &str| Scene::parse("test.toml", text).expect("a scene");
    assert!(matches!(read(IN_SPACE), Scene::Space(_)));
    assert!(matches!(read(WHOLE), Scene::Plane(_)));
    let error = PlaneScene::parse("test.toml", IN_SPACE).expect_err("not in the plane");
    assert!(error.message.contains("is in space"), "{error}");
    assert!(!error.labels.is_empty());
}

#[test]
fn bodies_and_joints_are_read_in_si() {
    let scene = SpaceScene::parse("test.toml", IN_SPACE).expect("a scene");
    let mechanism = &scene.mechanism;
    assert_eq!(mechanism.bodies.len(), 7);
    assert!(close(scene.masses[1].center, vec3(0.05, 0.001, 0.0)));
    let [xx, yy, ..] = scene.masses[1].inertia;
    assert!((xx - 1e-5).abs() < 1e-20 && (yy - 1.666e-3).abs() < 1e-18);
    // About its axes (y, z, x of the body) I_xx of the file is the body's I_yy, and I_xy its I_yz.
    let turned = scene.masses[2].inertia;
    let expected = [40e-6, 20e-6, 30e-6, 2e-6, 3e-6, 1e-6];
    for (found, expected) in turned.into_iter().zip(expected) {
        assert!((found - expected).abs() < 1e-20, "{turned:?}");
    }
    let [a, _, p, slide, _, screw, _, weld, link] = &mechanism.joints[..] else {
        panic!("{} joints", mechanism.joints.len())
    };
    assert_eq!(a.kind, JointKind::Revolute);
    assert!(close(a.sides[1].axis, vec3(0.0, 0.0, 1.0)));
    assert!(close(p.sides[1].axis, vec3(0.0, 0.0, 1.0)));
    assert!(close(slide.sides[1].normal, vec3(0.0, 0.0, 1.0)));
    assert!(
        matches!(screw.kind, JointKind::Helical { pitch } if (pitch - 0.005 / TAU).abs() < 1e-18)
    );
    assert_eq!(weld.sides[0].axis, weld.sides[1].axis);
    assert_eq!(link.kind, JointKind::Distance { length: 0.02 });
    let kinds = mechanism.actuators.iter().map(|a| a.kind);
    assert!(kinds.eq([
        ActuatorKind::Angle(JointId(0)),
        ActuatorKind::Travel(JointId(4))
    ]));
}

#[test]
fn assembly_loads_and_requests_are_read_in_si() {
    let scene = SpaceScene::parse("test.toml", IN_SPACE).expect("a scene");
    assert_eq!(scene.assembly.q, [PI / 2.0, 0.0]);
    let rod = scene.assembly.placements[2];
    assert!(close(rod.position, vec3(0.0, 0.1, 0.0)));
    let (sin, cos) = (-PI / 9.0).sin_cos();
    let turned = rod.rotation.apply(vec3(1.0, 0.0, 0.0));
    assert!(close(turned, vec3(cos, sin, 0.0)), "{turned:?}");
    // A vector of two right angles turns by two right angles.
    let half = Rotation::of_vector(vec3(PI, 0.0, 0.0)).apply(vec3(0.0, 1.0, 0.0));
    assert!((half - vec3(0.0, -1.0, 0.0)).norm() < 1e-15);
    let [weight, push, twist, drag, _, ..] = &scene.loads[..] else {
        panic!("{} loads", scene.loads.len())
    };
    let constant = |load: &Load| match load.magnitude {
        Magnitude::Constant(value) => value,
        ref other => panic!("{other:?}"),
    };
    assert!((constant(weight) - 9.81).abs() < 1e-15);
    assert_eq!(
        weight.kind,
        LoadKind::Gravity {
            direction: vec3(0.0, 0.0, -1.0)
        }
    );
    assert!(
        matches!(push.kind, LoadKind::Force { direction: Direction::Body(u), .. } if u.x == -1.0)
    );
    let of = |kind: LoadKind| match kind {
        LoadKind::Special(couple) => couple.bodies,
        other => panic!("{other:?}"),
    };
    assert_eq!(of(twist.kind), [BodyId(0), BodyId(1)]);
    assert_eq!(of(drag.kind), [BodyId(0), BodyId(2)]);
    let names: Vec<_> = scene
        .requests
        .reactions
        .iter()
        .map(|&r| scene.reaction_name(r))
        .collect();
    assert_eq!(
        names,
        [
            "slide.y",
            "slide.z",
            "slide.moment-x",
            "slide.moment-y",
            "slide.moment-z",
            "A.z",
            "A.moment-across",
            "P.axial"
        ]
    );
}

/// A friction of a cylindrical joint is two loads: along the axis and about it.
#[test]
fn friction_is_read_in_si() {
    let scene = SpaceScene::parse("test.toml", IN_SPACE).expect("a scene");
    let [_, _, _, _, _, hinge, oil, slide, along, about] = &scene.loads[..] else {
        panic!("{} loads", scene.loads.len())
    };
    let dry = |load: &Load, joint: usize, [low, high]: [f64; 2], contact, speed| {
        let friction = load.friction().expect("friction");
        let wanted = Friction {
            joint: JointId(joint),
            coefficient: low,
            static_coefficient: high,
            contact,
            regularization_speed: speed,
        };
        assert_eq!(friction, wanted, "{}", load.name);
    };
    let bearing = |radius, distance| FrictionContact::Bearing { radius, distance };
    let guide = FrictionContact::Guide { length: 0.04 };
    dry(hinge, 0, [0.1; 2], bearing(0.005, 0.0), None);
    dry(slide, 3, [0.2, 0.3], guide, None);
    for load in [along, about] {
        dry(load, 4, [0.05; 2], bearing(0.004, 0.03), Some(0.002));
    }
    assert_eq!(oil.magnitude, Magnitude::Constant(0.002));
    let of = [hinge, oil, slide, along, about].map(|load| (load.name.as_str(), load.kind));
    let (hinge, guide, tube) = (JointId(0), JointId(3), JointId(4));
    assert_eq!(
        of,
        [
            ("A.friction", LoadKind::couple(hinge)),
            ("A.viscous", LoadKind::rotational_damper(hinge)),
            ("slide.friction", LoadKind::slide_force(guide)),
            ("tube.friction", LoadKind::slide_force(tube)),
            ("tube.friction-moment", LoadKind::couple(tube)),
        ]
    );
}

/// End stops are those of the plane: angles and lengths in the units of the scene, stiffness and damping in SI.
#[test]
fn end_stops_are_read_in_si() {
    let scene = SpaceScene::parse("test.toml", IN_SPACE).expect("a scene");
    let [buffer, bed] = &scene.stops[..] else {
        panic!("{} stops", scene.stops.len())
    };
    assert_eq!(buffer.name, "buffer");
    assert_eq!((buffer.actuator.0, bed.actuator.0), (0, 1));
    let angles = [buffer.min, buffer.max].map(|limit| limit.expect("a limit"));
    let wanted = [-10.0_f64, 300.0].map(f64::to_radians);
    assert!(
        angles
            .iter()
            .zip(wanted)
            .all(|(a, b)| (a - b).abs() < 1e-15)
    );
    assert_eq!((buffer.restitution, buffer.yielding), (0.5, None));
    assert_eq!((bed.min, bed.max), (Some(0.0), None));
    assert_eq!(bed.yielding, Some([20000.0, 50.0]));
}

/// A scene cut short anywhere, or with a piece of it replaced, is read or told what is wrong with it.
#[test]
fn no_text_breaks_the_reader() {
    let survive = |text: &str| match Scene::parse("test.toml", text) {
        Ok(_) => true,
        Err(error) => {
            assert!(!render(&error).is_empty());
            false
        }
    };
    assert!(survive(IN_SPACE));
    for (at, _) in IN_SPACE.char_indices() {
        survive(&IN_SPACE[..at]);
    }
    for piece in pieces(IN_SPACE) {
        for other in [
            "",
            "x",
            "-1",
            "1e300",
            "nan",
            "[",
            "}",
            "\"A\"",
            "[1, 2, 3]",
            "{ at = [1, 0, 0] }",
        ] {
            survive(&[&IN_SPACE[..piece.start], other, &IN_SPACE[piece.end..]].concat());
        }
    }
}

#[test]
fn gear_pairs_and_driven_lengths_are_read() {
    let with = |joints: &str, actuators: &str| {
        let text = format!(
            "bodies.ground.points = {{ A = [0, 0, 0], P = [1, 0, 0] }}\nbodies.arm.points = {{ A = [0, 0, 0] }}\n\
             bodies.wheel.points = {{ A = [0, 0, 0] }}\njoints.A = {{ revolute = [\"ground.A\", \"arm.A\"], axis = [0, 0, 1] }}\n\
             joints.W = {{ revolute = [\"ground.P\", \"wheel.A\"], axis = [0, 0, 1] }}\n{joints}\n{actuators}\n"
        );
        SpaceScene::parse("test.toml", &text)
    };
    let teeth = "joints.T = { gear = [\"arm\", \"wheel\"], pitch-point = \"ground.P\", normal = [0, 2, 0] }";
    let rod = "joints.rod = { distance = [\"ground.P\", \"arm.A\"] }";
    let scene = with(teeth, "actuators.q = { angle = \"A\" }").expect("a scene");
    let pair = &scene.mechanism.joints[2];
    assert_eq!(pair.kind, JointKind::Gear { carrier: BodyId(0) });
    assert_eq!(pair.bodies, [BodyId(1), BodyId(2)]);
    assert!(close(pair.sides[1].axis, vec3(0.0, 1.0, 0.0)));
    assert!(close(pair.sides[1].point, vec3(1.0, 0.0, 0.0)));
    let names = scene
        .requests
        .reactions
        .iter()
        .map(|&r| scene.reaction_name(r));
    let of_pair: Vec<_> = names.filter(|n| n.starts_with('T')).collect();
    assert_eq!(of_pair, ["T.y"]);
    let scene = with(rod, "actuators.q = { length = \"rod\" }").expect("a scene");
    assert_eq!(
        scene.mechanism.actuators[0].kind,
        ActuatorKind::Length(JointId(2))
    );
    let says = |joints: &str, actuators: &str, words: &str| {
        let error = with(joints, actuators).expect_err(words);
        let text = render(&error);
        assert!(text.contains(words), "{text}");
    };
    let angle = "actuators.q = { angle = \"A\" }";
    says(rod, angle, "joint `rod` has no length");
    let given = rod.replace(" }", ", length = 1 }");
    let length = "actuators.q = { length = \"rod\" }";
    says(&given, length, "driven and given");
    says(
        &given,
        "actuators.q = { length = \"A\" }",
        "has no length to be driven",
    );
    let own = teeth.replace("ground.P", "arm.A");
    says(&own, angle, "is a point of one of its wheels");
    says(
        &teeth.replace(", normal = [0, 2, 0]", ""),
        angle,
        "`normal`",
    );
}

/// The bodies that the examples of keys name.
const BODIES: &str = r#"
bodies.ground = { points = { A = [0, 0, 0], S = [0, 0, 0] } }
bodies.crank = { points = { A = [0, 0, 0], B = [1, 0, 0], C = [2, 0, 0] }, center = "A" }
bodies.rod = { points = { A = [0, 0, 0], B = [0, 0, 0], P = [3, 0, 0] } }
bodies.piston = { points = { P = [0, 0, 0] } }
bodies.shaft = { points = { A = [0, 0, 0] } }
bodies.nut = { points = { A = [0, 0, 0] } }
bodies.block = { points = { A = [0, 0, 0] } }
joints.A = { revolute = ["ground.A", "crank.A"], axis = [0, 0, 1] }
joints.B = { spherical = ["crank.B", "rod.B"] }
joints.slide = { prismatic = ["ground.S", "piston.P"], axis = [1, 0, 0] }
joints.tube = { cylindrical = ["ground.S", "block.A"], axis = [1, 0, 0] }
joints.S = { spherical = ["rod.A", "shaft.A"] }
joints.N = { spherical = ["rod.A", "nut.A"] }
joints.K = { spherical = ["rod.A", "block.A"] }
actuators.phi = { angle = "A" }
assembly.phi = 0.5
"#;

#[test]
fn every_example_of_a_key_in_space_is_read() {
    let mut read = 0;
    for table in tables("scene-in-space") {
        for (key, inner) in tables_of_examples(table) {
            let inner = match table.keys.iter().find(|k| k.name == "normals") {
                Some(normals) if key == "axes" => {
                    let inner = inner.trim_end_matches('}');
                    format!("{inner}, normals = {} }}", normals.example)
                }
                _ => inner,
            };
            let first = table.kind_key();
            let fragment = match table.name.as_str() {
                "[bodies.<body>] in space" if inner.contains("inertia-axes") => {
                    let inner = inner.trim_end_matches('}');
                    format!("bodies.crank = {inner}, inertia = [10, 10, 10] }}")
                }
                "[bodies.<body>] in space" => format!("bodies.crank = {inner}"),
                "[actuators.<actuator>] in space" if inner.contains("length") => format!(
                    "joints.link = {{ distance = [\"ground.A\", \"nut.A\"] }}\nactuators.other = {inner}"
                ),
                "[actuators.<actuator>] in space" => format!("actuators.other = {inner}"),
                "distance in space" if !inner.contains("length") => {
                    format!("joints.other = {inner}\nactuators.other = {{ length = \"other\" }}")
                }
                "[assembly.<body>] in space" => format!("assembly.rod = {inner}"),
                "[requests] in space" => format!("requests = {inner}"),
                "[friction.<hinge>] in space" => format!("friction.A = {inner}"),
                "[friction.<slide>] in space" => format!("friction.slide = {inner}"),
                "[friction.<tube>] in space" => format!("friction.tube = {inner}"),
                "[stops.<stop>]" => format!("stops.other = {inner}"),
                "coupling" => {
                    format!("coordinates.rise = {{ travel = \"slide\" }}\njoints.other = {inner}")
                }
                _ if kinds("joints-in-space")
                    .iter()
                    .any(|t| t.kind_key() == first) =>
                {
                    format!("joints.other = {inner}")
                }
                _ if kinds("loads-in-space")
                    .iter()
                    .any(|t| t.kind_key() == first) =>
                {
                    format!("loads.other = {inner}")
                }
                _ => continue,
            };
            if let Err(error) = SpaceScene::parse("test.toml", &merged(BODIES, &fragment)) {
                panic!("{fragment}\n{}", render(&error));
            }
            read += 1;
        }
    }
    assert!(read >= 40, "{read}");
}

/// A tensor that no distribution of mass has is read as it is, and warned of where it stands; that of a flat body, on the bound, is not,
/// whatever its axes.
#[test]
fn tensors_that_no_body_has_are_warned_of() {
    let was = "inertia = [20, 30, 40, 1, 2, 3]";
    assert!(IN_SPACE.contains(was));
    for (tensor, excess) in [
        ("[20, 30, 50]", None),
        (
            "[20, 30, 50.01]",
            Some("0.00005001 kg m², exceeds the sum of the others, 0.00002 and 0.00003 kg m²"),
        ),
        // The same turned by 45° about z.
        ("[25, 25, 50, 5, 0, 0]", None),
        (
            "[25, 25, 50.01, 5, 0, 0]",
            Some("0.00005001 kg m², exceeds the sum of the others, 0.00002 and 0.00003 kg m²"),
        ),
        ("[0, 0, 0]", None),
    ] {
        let text = IN_SPACE.replace(was, &format!("inertia = {tensor}"));
        let scene = SpaceScene::parse("test.toml", &text).expect("a scene");
        match (scene.warnings.as_slice(), excess) {
            ([], None) => {}
            ([warning], Some(numbers)) => {
                let message = &warning.message;
                assert!(
                    message.contains("body `rod`") && message.contains(numbers),
                    "{message}"
                );
                let label = &warning.labels[0];
                assert_eq!(&text[label.offset()..label.offset() + label.len()], tensor);
            }
            (warnings, _) => panic!("{tensor}: {warnings:?}"),
        }
    }
}
