//! What driven.toml says, to the last digit: friction, drives, led actuators and events.

use super::*;
use crate::{EventTrigger, Length, NamedEvent, Place};
use dwell_dynamics::{Drive, DriveKind, Motor, Regulator};
use dwell_geometry::{ActuatorId, BodyId, Component, Coordinate, JointId, Reaction, Vec2, vec2};
use dwell_kinetostatics::{Friction, Guide, Load, LoadKind, Magnitude, Signal};
use dwell_laws::{Expression, Law, Sinusoid, Spline};
use std::f64::consts::{PI, TAU};

const GROUND: BodyId = BodyId(0);
const CRANK: BodyId = BodyId(1);
const ROD: BodyId = BodyId(2);
const PISTON: BodyId = BodyId(3);
const ARM: BodyId = BodyId(4);
const SHOE: BodyId = BodyId(5);
const WHEEL: BodyId = BodyId(7);

const PHI: Coordinate = Coordinate::Angle([GROUND, CRANK]);
const OMEGA: Coordinate = Coordinate::Angle([GROUND, WHEEL]);
const RISE: Coordinate = Coordinate::Travel(JointId(4));

fn driven() -> Scene {
    parse(DRIVEN).unwrap()
}

/// x π/180, as the reader converts degrees.
fn deg(x: f64) -> f64 {
    x * PI / 180.0
}

fn slide() -> Guide {
    Guide {
        bodies: [GROUND, PISTON],
        points: [vec2(0.0, 0.01), Vec2::ZERO],
        axis: vec2(0.6, 0.8),
    }
}

fn groove() -> Guide {
    Guide {
        bodies: [ARM, SHOE],
        points: [vec2(0.04, 0.0), Vec2::ZERO],
        axis: vec2(0.0, 1.0),
    }
}

fn rubs(joint: usize, [coefficient, size, fade]: [f64; 3]) -> Magnitude {
    let joint = JointId(joint);
    Magnitude::Friction(Friction {
        joint,
        coefficient,
        size,
        fade,
    })
}

/// Both joints of the pin B rub; a fade not given is 0.01 rad/s or 0.001 m/s.
#[test]
fn loads_and_friction() {
    let turn = |bodies| LoadKind::Torque { bodies };
    let damp = |bodies| LoadKind::TorsionDamper { bodies };
    let constant = Magnitude::Constant;
    let gas = Expression::parse("50*t", &["t"]).unwrap();
    let push = LoadKind::Push {
        bodies: [GROUND, PISTON],
        points: [Vec2::ZERO; 2],
    };
    let down = LoadKind::Gravity {
        direction: vec2(0.0, -1.0),
    };
    let expected = [
        ("weight", down, constant(9.81)),
        ("gas", push, Magnitude::Expression(gas, vec![Signal::Time])),
        ("drag", LoadKind::Slide(slide()), constant(-20.0)),
        (
            "B-rod.friction",
            turn([CRANK, ROD]),
            rubs(1, [0.1, 0.005, 0.01]),
        ),
        ("B-rod.viscous", damp([CRANK, ROD]), constant(0.002)),
        (
            "B-arm.friction",
            turn([CRANK, ARM]),
            rubs(2, [0.1, 0.005, 0.01]),
        ),
        ("B-arm.viscous", damp([CRANK, ARM]), constant(0.002)),
        (
            "slide.friction",
            LoadKind::Slide(slide()),
            rubs(4, [0.15, 0.04, 0.002]),
        ),
        (
            "groove.friction",
            LoadKind::Slide(groove()),
            rubs(5, [0.05, 0.0, 0.001]),
        ),
        ("W.viscous", damp([GROUND, WHEEL]), constant(0.003)),
    ];
    let expected = expected.map(|(name, kind, magnitude)| Load {
        name: name.to_owned(),
        kind,
        magnitude,
    });
    assert_eq!(driven().loads, expected);
    let viscous = changed(
        DRIVEN,
        "groove = { coefficient = 0.05 }",
        "groove = { viscous = 7 }",
    );
    let load = parse(&viscous).unwrap().loads[8].clone();
    assert_eq!(
        (load.kind, load.magnitude),
        (LoadKind::SlideDamper(groove()), constant(7.0))
    );
}

#[test]
fn drives() {
    let table = |rows: &[[f64; 2]]| Law::Spline(Spline::through(rows).unwrap());
    let engine = Magnitude::Law(Signal::Value(PHI), table(&[[0.0, 2.0], [TAU, 1.0]]));
    let voltage = Expression::parse("12 - 2*t", &["t"]).unwrap();
    let voltage = Magnitude::Expression(voltage, vec![Signal::Time]);
    let starter = Motor {
        voltage,
        constant: 0.05,
        resistance: 1.2,
        inductance: 0.002,
        ratio: -20.0,
        inertia: 3.5 / 1e6,
    };
    let pump = Motor {
        voltage: Magnitude::Constant(1.0),
        constant: 1.0 / (100.0 * PI),
        resistance: 1.0 / (100.0 * PI) / 0.5,
        inductance: 0.0,
        ratio: 400.0,
        inertia: 0.0,
    };
    let governor = Regulator {
        speed: Magnitude::Constant(PI),
        proportional: 2.0,
        integral: 5.0,
        limit: 10.0,
    };
    let brake = Regulator {
        speed: Magnitude::Law(Signal::Time, table(&[[0.0, 0.1], [1.0, 0.0]])),
        proportional: 3.0,
        integral: 0.0,
        limit: f64::INFINITY,
    };
    let expected = [
        ("engine", OMEGA, DriveKind::Action(engine)),
        ("starter", PHI, DriveKind::Motor(starter)),
        ("pump", RISE, DriveKind::Motor(pump)),
        ("governor", OMEGA, DriveKind::Regulator(governor)),
        ("brake", RISE, DriveKind::Regulator(brake)),
    ];
    let expected = expected.map(|(name, coordinate, kind)| Drive {
        name: name.to_owned(),
        coordinate,
        kind,
    });
    assert_eq!(driven().drives, expected);
}

/// At the shaft: u k/R is the torque at rest, u/k the speed without torque.
#[test]
fn a_line_is_that_of_its_motor() {
    let scene = driven();
    let DriveKind::Motor(motor) = &scene.drives[2].kind else {
        panic!("a motor");
    };
    let Magnitude::Constant(voltage) = motor.voltage else {
        panic!("a constant voltage");
    };
    let stall = voltage * motor.constant / motor.resistance;
    let idle = voltage / motor.constant;
    // Three roundings each.
    assert!((stall - 0.5).abs() < 4e-16, "{stall}");
    assert!((idle - 100.0 * PI).abs() < 2e-13, "{idle}");
}

#[test]
fn motion_with_led_actuators() {
    let motion = driven().motion.unwrap();
    let swing = Sinusoid::starting_at(deg(30.0), deg(10.0), 2.0, 0.0).unwrap();
    let stroke = Spline::through(&[[0.0, 0.005], [3.0, 0.008]]).unwrap();
    let led = [Law::Sinusoid(swing), Law::Spline(stroke)];
    let [_, swing, ..] = led[0].at(0.0);
    let [begin, speed, ..] = led[1].at(0.0);
    assert_eq!(motion.start, [deg(20.0), deg(30.0), begin, 0.0]);
    assert_eq!(motion.speed, [deg(90.0), swing, speed, PI]);
    let [swing, stroke] = led;
    assert_eq!(motion.laws, [None, Some(swing), Some(stroke), None]);
    assert_eq!(motion.length, Length::Duration(3.0));
}

/// A bare number is the only free actuator's, and loads, drives or laws can do without a speed.
#[test]
fn defaults_of_a_motion() {
    let motion = |old: &str, new: &str| parse(&changed(DRIVEN, old, new)).unwrap().motion.unwrap();
    let at_rest = motion("speed = { phi = 90, omega = 180 }\n", "");
    assert_eq!([at_rest.speed[0], at_rest.speed[3]], [0.0; 2]);
    let one = DRIVEN
        .replace("start = { phi = 20 }", "start = 20")
        .replace("[motion.laws]\n", "[motion.laws]\nomega = { speed = 45 }\n");
    let one = one.replace(
        "speed = { phi = 90, omega = 180 }\nduration",
        "speed = 90\nduration",
    );
    let one = one.replace("action = \"omega\"", "action = \"phi\"");
    let one = one.replace(
        "regulator = \"omega\", speed = 180",
        "regulator = \"phi\", speed = 180",
    );
    let motion = parse(&one).unwrap().motion.unwrap();
    assert_eq!(motion.start, [deg(20.0), deg(30.0), 0.005, 0.0]);
    assert_eq!([motion.speed[0], motion.speed[3]], [deg(90.0), deg(45.0)]);
    let bare = DRIVEN.split("[loads]").next().unwrap();
    let laws = "[motion]\nduration = 1\nlaws.omega = { speed = 1 }\n";
    let motion = parse(&format!("{bare}{laws}")).unwrap().motion.unwrap();
    assert_eq!(motion.speed[0], 0.0);
}

#[test]
fn events() {
    let reaction = |joint, component| Reaction {
        joint: JointId(joint),
        component,
    };
    let normal = |joint, value| EventTrigger::Reaction(reaction(joint, Component::Normal), value);
    let expected = [
        ("top", EventTrigger::Reaches(RISE, 0.32), false),
        ("turning", EventTrigger::Turns(RISE), false),
        ("off", normal(4, 0.0), true),
        ("hard", normal(5, -15.0), false),
        ("again", EventTrigger::WholeTurn(PHI), false),
    ];
    let expected = expected.map(|(name, trigger, stop)| NamedEvent {
        name: name.to_owned(),
        trigger,
        stop,
    });
    assert_eq!(driven().motion.unwrap().events, expected);
}

/// The drives are a model's last loads: places count on.
#[test]
fn a_later_error_points_at_loads_friction_and_drives() {
    let scene = driven();
    for (place, text) in [
        (Place::Load(2), "drag"),
        (Place::Magnitude(2), "-20"),
        (Place::Load(3), "B"),
        (Place::Magnitude(3), "0.1"),
        (Place::Magnitude(4), "0.002"),
        (Place::Load(6), "B"),
        (Place::Load(7), "slide"),
        (Place::Magnitude(9), "0.003"),
        (Place::Load(10), "engine"),
        (Place::Load(14), "brake"),
        (Place::Magnitude(11), "\"12 - 2*t\""),
        (Place::Magnitude(12), "0.5"),
        (Place::Magnitude(13), "180"),
        (Place::Drive(1), "starter"),
        (Place::Event(2), "off"),
        (Place::Led(ActuatorId(1)), "psi"),
        // Not written down: the nearest thing that is.
        (Place::Led(ActuatorId(0)), "[motion]"),
        (Place::Event(9), "[motion]"),
        (Place::Drive(9), ""),
        (Place::Load(15), ""),
    ] {
        let error = scene.error("wrong".to_owned(), None, &[(place, "here".to_owned())]);
        assert_eq!(error.labelled(), [(text, "here")], "{place:?}");
    }
}
