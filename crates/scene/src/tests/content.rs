//! The data of a scene.

use super::*;
use crate::{Calibration, DwellRequest, MotionDuration, PathPoint};
use dwell_geometry::{BodyId, Component, JointId, JointKind, Vec2, vec2};
use std::f64::consts::{FRAC_PI_2, PI};

#[test]
fn the_whole_language() {
    let scene = parse(WHOLE).unwrap();
    assert_eq!(scene.name, "test");
    assert_eq!(scene.title, "Slider-crank");
    assert_eq!(scene.note.as_deref(), Some("For tests."));
    let m = &scene.mechanism;
    let names: Vec<_> = m.bodies.iter().map(|b| b.name.as_str()).collect();
    assert_eq!(names, ["ground", "crank", "rod", "piston"]);
    assert_eq!(m.ground, 0);
    let names: Vec<_> = m.joints.iter().map(|j| j.name.as_str()).collect();
    assert_eq!(names, ["A", "B", "P", "slide"]);
    let slide = &m.joints[3];
    assert_eq!(slide.bodies, [BodyId(0), BodyId(3)]);
    assert_eq!(slide.points, [vec2(0.0, 0.01), Vec2::ZERO]);
    let axes = [vec2(0.6, 0.8); 2];
    assert_eq!(slide.kind, JointKind::Prismatic { axes });
    assert_eq!(m.actuators.len(), 1);
    assert_eq!(m.actuators[0].name, "phi");
    assert_eq!(m.actuators[0].bodies, [BodyId(0), BodyId(1)]);

    assert_eq!(scene.masses[0], dwell_kinetostatics::Mass::default());
    assert_eq!(scene.masses[1].mass, 2.0);
    assert_eq!(scene.masses[1].center, vec2(0.05, 0.001));
    assert_eq!(scene.masses[1].inertia, 1666e-6);
    assert_eq!(scene.masses[2].inertia, 0.0);
    let rod = vec![
        ("B".to_owned(), Vec2::ZERO),
        ("P".to_owned(), vec2(0.3, 0.0)),
    ];
    assert_eq!(scene.points[2], rod);

    assert_eq!(scene.assembly.coordinates, [FRAC_PI_2]);
    assert_eq!(
        scene.assembly.initial_guess,
        [None, None, Some(-PI / 9.0), None]
    );
    let requested: Vec<_> = scene.requests.reactions.iter().collect();
    assert_eq!(requested.len(), 3, "slide.normal is asked for twice");
    assert_eq!(m.reaction_name(*requested[0]), "slide.normal");
    assert_eq!(m.reaction_name(*requested[1]), "slide.moment");
    assert_eq!(requested[2].joint, JointId(0));
    assert_eq!(requested[2].component, Component::X);
    let (body, name, at) = (BodyId(2), "P".to_owned(), vec2(0.3, 0.0));
    assert_eq!(scene.requests.paths[0], PathPoint { body, name, at });
    assert_eq!(
        scene.requests.dwell,
        Some(DwellRequest {
            body,
            relative_band: 0.02
        })
    );
    let motion = scene.motion.unwrap();
    assert_eq!(motion.initial_coordinates, [PI / 6.0]);
    assert_eq!(motion.initial_velocities, [PI]);
    assert_eq!(motion.duration, MotionDuration::Periods(2.0));
    let path = "crank.inertia".to_owned();
    assert_eq!(scene.calibration, Some(Calibration { path, period: 5.42 }));
}

/// Two bodies and a joint: the least a scene can be.
const MINIMAL: &str = r#"
bodies.bob = { points = { O = [0, 0] }, inertia = 1 }
bodies.ground.points.O = [0, 0]
joints.O.revolute = ["ground.O", "bob.O"]
actuators.phi.angle = ["ground", "bob"]
"#;

#[test]
fn what_is_absent_has_its_default() {
    let scene = parse(MINIMAL).unwrap();
    assert_eq!(scene.title, "test");
    assert_eq!(scene.note, None);
    assert_eq!(scene.mechanism.ground, 1, "the order is that of the file");
    assert_eq!(scene.assembly.coordinates, [0.0]);
    assert_eq!(scene.requests.reactions, scene.mechanism.reactions());
    assert!(scene.requests.paths.is_empty());
    assert_eq!(scene.requests.dwell, None);
    assert_eq!(scene.motion, None);
    assert_eq!(scene.calibration, None);

    let with_requests = format!("{MINIMAL}\nrequests = {{ paths = [] }}");
    let scene = parse(&with_requests).unwrap();
    assert_eq!(scene.requests.reactions, scene.mechanism.reactions());
    let none = format!("{MINIMAL}\nrequests = {{ reactions = [] }}");
    assert!(parse(&none).unwrap().requests.reactions.is_empty());
    let both = format!("{MINIMAL}\nrequests = {{ reactions = [\"O\"] }}");
    let scene = parse(&both).unwrap();
    assert_eq!(scene.requests.reactions, scene.mechanism.reactions());
}

#[test]
fn motion_and_assembly_start_where_the_other_does() {
    let start = |more: &str| {
        let scene = parse(&format!("{MINIMAL}\n{more}")).unwrap();
        (
            scene.assembly.coordinates[0],
            scene.motion.unwrap().initial_coordinates[0],
        )
    };
    let motion = "initial-velocity = 1, duration = 2";
    let both = format!("assembly.phi = 1\nmotion = {{ initial-coordinate = 2, {motion} }}");
    assert_eq!(start(&both), (1.0, 2.0));
    assert_eq!(
        start(&format!("motion = {{ initial-coordinate = 2, {motion} }}")),
        (2.0, 2.0)
    );
    assert_eq!(
        start(&format!("assembly.phi = 1\nmotion = {{ {motion} }}")),
        (1.0, 1.0)
    );
    assert_eq!(start(&format!("motion = {{ {motion} }}")), (0.0, 0.0));
}

#[test]
fn any_body_can_be_the_ground() {
    let moving = MINIMAL.replace(
        "ground.points",
        "ground.fixed = false\nbodies.ground.points",
    );
    let scene = parse(&moving.replace("inertia = 1", "fixed = true")).unwrap();
    assert_eq!(scene.mechanism.ground, 0);
    let renamed = MINIMAL
        .replace("inertia = 1", "fixed = true")
        .replace("ground", "link-1");
    assert_eq!(parse(&renamed).unwrap().mechanism.ground, 0);
}

#[test]
fn the_mass_of_the_ground_is_read_and_dropped() {
    let heavy = "bodies.ground.mass = 5\nbodies.ground.inertia = 2\nbodies.ground.points.O";
    let scene = parse(&MINIMAL.replace("bodies.ground.points.O", heavy)).unwrap();
    assert_eq!(scene.masses[1], dwell_kinetostatics::Mass::default());
    assert!(scene.value("ground.mass").is_err());
    let wrong = MINIMAL.replace(
        "bodies.ground.points.O",
        "bodies.ground.mass = -5\nbodies.ground.points.O",
    );
    assert!(parse(&wrong).unwrap_err().message.contains("negative"));
}

#[test]
fn names_of_many_scripts() {
    let text = MINIMAL
        .replace("bob", "\"Kurbel-1 φ₂\"")
        .replace(".\"Kurbel-1 φ₂\".", ".Kurbel-1 φ₂.")
        .replace("\"\"Kurbel-1 φ₂\".O\"", "\"Kurbel-1 φ₂.O\"")
        .replace("\"\"Kurbel-1 φ₂\"\"", "\"Kurbel-1 φ₂\"");
    let scene = parse(&text).unwrap();
    assert_eq!(scene.mechanism.bodies[0].name, "Kurbel-1 φ₂");
    assert_eq!(scene.value("Kurbel-1 φ₂.inertia").unwrap(), 1.0);
}

/// A unit changes nothing but the digits in the file.
#[test]
fn units_convert_to_the_last_digit() {
    let in_si = WHOLE
        .replace("length = \"mm\"\ninertia = \"kg mm2\"\nangle = \"deg\"", "")
        .replace("[0, 10]", "[0, 0.01]")
        .replace("[100, 0]", "[0.1, 0]")
        .replace("[300, 0]", "[0.3, 0]")
        .replace("[50, 1]", "[0.05, 0.001]")
        .replace("1666.0", "0.001666")
        .replace("= 90", "= 1.5707963267948966")
        .replace("= -20", "= -0.3490658503988659")
        .replace("= 30", "= 0.5235987755982988")
        .replace("= 180", "= 3.141592653589793");
    let (a, b) = (parse(WHOLE).unwrap(), parse(&in_si).unwrap());
    assert_eq!(a.mechanism, b.mechanism);
    assert_eq!(a.points, b.points);
    assert_eq!(a.masses, b.masses);
    assert_eq!(a.assembly, b.assembly);
    assert_eq!(a.motion, b.motion);
    assert_eq!(a.requests, b.requests);
}

#[test]
fn every_unit() {
    let bob = |units: &str| {
        let text = MINIMAL.replace("inertia = 1", "inertia = 1, mass = 1, center = [1, 2]");
        parse(&format!("{text}\n[units]\n{units}")).unwrap().masses[0]
    };
    for (unit, meters) in [
        ("m", 1.0),
        ("mm", 0.001),
        ("cm", 0.01),
        ("um", 1e-6),
        ("km", 1000.0),
        ("in", 0.0254),
        ("ft", 0.3048),
    ] {
        let mass = bob(&format!("length = \"{unit}\"\ninertia = \"kg {unit}2\""));
        assert_eq!(mass.center.x, meters, "{unit}");
        assert!(
            (mass.inertia / (meters * meters) - 1.0).abs() < 4e-16,
            "{unit}"
        );
    }
    for (unit, kg) in [
        ("kg", 1.0),
        ("g", 0.001),
        ("t", 1000.0),
        ("lb", 0.45359237),
        ("oz", 0.45359237 / 16.0),
    ] {
        let mass = bob(&format!("mass = \"{unit}\"\ninertia = \"{unit} m2\""));
        assert_eq!((mass.mass, mass.inertia), (kg, kg), "{unit}");
    }
    for spelling in ["g mm2", "g mm^2", "g mm²", "g·mm²", "g*mm^2"] {
        assert_eq!(bob(&format!("inertia = \"{spelling}\"")).inertia, 1e-9);
    }
}

#[test]
fn axes_of_any_length() {
    let axis = |text: &str| match parse(&with("axis = [3, 4]", text))
        .unwrap()
        .mechanism
        .joints[3]
        .kind
    {
        JointKind::Prismatic { axes } => axes,
        _ => panic!("prismatic"),
    };
    assert_eq!(axis("axis = [1e308, 0]")[0], vec2(1.0, 0.0));
    assert_eq!(axis("axis = [0, -5e-324]")[0], vec2(0.0, -1.0));
    assert_eq!(
        axis("axes = [[1, 0], [0, 2]]"),
        [vec2(1.0, 0.0), vec2(0.0, 1.0)]
    );
}

#[test]
fn numbers_however_written() {
    for (written, value) in [
        ("2", 2.0),
        ("+2_000", 2000.0),
        ("0x10", 16.0),
        ("1e-3", 0.001),
        ("-0.0", 0.0),
        ("9007199254740993", 9007199254740992.0),
        ("1000000000000000000000000", 1e24),
    ] {
        let scene = parse(&with("mass = 2.0", &format!("mass = {written}"))).unwrap();
        assert_eq!(scene.masses[1].mass, value);
    }
}
