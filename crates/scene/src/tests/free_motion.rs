//! The contents of driven.toml, to the last digit: friction, drives, prescribed actuators and events.

use super::*;
use crate::{EventTrigger, MotionDuration, NamedEvent, SceneLocation};
use dwell_geometry::{ActuatorId, BodyId, Component, Coordinate, JointId, Reaction, Vec2, vec2};
use dwell_kinetostatics::{
    Drive, DriveKind, Friction, FrictionContact, Guide, Load, LoadKind, Magnitude, Motor, Signal,
    SpeedController,
};
use dwell_laws::{Expression, Interpolation, Law, Sinusoid, Spline};
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

fn free_motion() -> PlaneScene {
    parse(FREE_MOTION).unwrap()
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

fn dry_friction(
    joint: usize,
    coefficient: f64,
    contact: FrictionContact,
    regularization_speed: impl Into<Option<f64>>,
) -> Magnitude {
    Magnitude::Friction(Friction {
        joint: JointId(joint),
        coefficient,
        static_coefficient: coefficient,
        contact,
        regularization_speed: regularization_speed.into(),
    })
}

const PIN: FrictionContact = FrictionContact::Pin { radius: 0.005 };

fn guide(length: f64) -> FrictionContact {
    FrictionContact::Guide { length }
}

/// Both joints of the pin B rub; friction without a regularization speed holds at rest.
#[test]
fn loads_and_friction() {
    let torque = |bodies| LoadKind::couple(bodies);
    let damper = |bodies| LoadKind::rotational_damper(bodies);
    let constant = Magnitude::Constant;
    let gas = Expression::parse("50*t", &["t"]).unwrap();
    let push = LoadKind::point_to_point_force([GROUND, PISTON], [Vec2::ZERO; 2]);
    let down = LoadKind::Gravity {
        direction: vec2(0.0, -1.0),
    };
    let expected = [
        ("weight", down, constant(9.81)),
        ("gas", push, Magnitude::Expression(gas, vec![Signal::Time])),
        ("drag", LoadKind::slide_force(slide()), constant(-20.0)),
        (
            "B-rod.friction",
            torque([CRANK, ROD]),
            dry_friction(1, 0.1, PIN, None),
        ),
        ("B-rod.viscous", damper([CRANK, ROD]), constant(0.002)),
        (
            "B-arm.friction",
            torque([CRANK, ARM]),
            dry_friction(2, 0.1, PIN, None),
        ),
        ("B-arm.viscous", damper([CRANK, ARM]), constant(0.002)),
        (
            "slide.friction",
            LoadKind::slide_force(slide()),
            dry_friction(4, 0.15, guide(0.04), 0.002),
        ),
        (
            "groove.friction",
            LoadKind::slide_force(groove()),
            dry_friction(5, 0.05, guide(0.0), None),
        ),
        ("W.viscous", damper([GROUND, WHEEL]), constant(0.003)),
    ]
    .map(|(name, kind, magnitude)| Load {
        name: name.to_owned(),
        kind,
        magnitude,
    });
    assert_eq!(free_motion().loads, expected);
    let viscous = changed(
        FREE_MOTION,
        "groove = { coefficient = 0.05 }",
        "groove = { viscous = 7 }",
    );
    let load = parse(&viscous).unwrap().loads[8].clone();
    assert_eq!(
        (load.kind, load.magnitude),
        (LoadKind::slide_damper(groove()), constant(7.0))
    );
}

#[test]
fn drives() {
    let table = |rows: &[[f64; 2]]| {
        Law::Spline(Spline::interpolating(rows, Interpolation::Monotone).unwrap())
    };
    let engine = Magnitude::Law(Signal::Value(PHI), table(&[[0.0, 2.0], [TAU, 1.0]]));
    let falling = Expression::parse("12 - 2*t", &["t"]).unwrap();
    let voltage = Magnitude::Expression(falling, vec![Signal::Time]);
    let starter = Motor {
        voltage,
        torque_constant: 0.05,
        resistance: 1.2,
        inductance: 0.002,
        gear_ratio: -20.0,
        rotor_inertia: 3.5 / 1e6,
        is_torque_speed_line: false,
    };
    let pump = Motor {
        voltage: Magnitude::Constant(1.0),
        torque_constant: 1.0 / (100.0 * PI),
        resistance: 1.0 / (100.0 * PI) / 0.5,
        inductance: 0.0,
        gear_ratio: 400.0,
        rotor_inertia: 0.0,
        is_torque_speed_line: true,
    };
    let governor = SpeedController {
        reference_speed: Magnitude::Constant(PI),
        proportional_gain: 2.0,
        integral_gain: 5.0,
        limit: 10.0,
    };
    let brake = SpeedController {
        reference_speed: Magnitude::Law(Signal::Time, table(&[[0.0, 0.1], [1.0, 0.0]])),
        proportional_gain: 3.0,
        integral_gain: 0.0,
        limit: f64::INFINITY,
    };
    let expected = [
        ("engine", OMEGA, DriveKind::AppliedForce(engine)),
        ("starter", PHI, DriveKind::Motor(starter)),
        ("pump", RISE, DriveKind::Motor(pump)),
        ("governor", OMEGA, DriveKind::SpeedController(governor)),
        ("brake", RISE, DriveKind::SpeedController(brake)),
    ]
    .map(|(name, coordinate, kind)| Drive {
        name: name.to_owned(),
        coordinate,
        kind,
    });
    assert_eq!(free_motion().drives, expected);
}

/// At the shaft: u k/R is the torque at rest, u/k the speed without torque.
#[test]
fn a_line_is_that_of_its_motor() {
    let scene = free_motion();
    let DriveKind::Motor(motor) = &scene.drives[2].kind else {
        panic!("a motor");
    };
    let Magnitude::Constant(voltage) = motor.voltage else {
        panic!("a constant voltage");
    };
    let stall_torque = voltage * motor.torque_constant / motor.resistance;
    let no_load_speed = voltage / motor.torque_constant;
    // Three roundings each.
    assert!((stall_torque - 0.5).abs() < 4e-16, "{stall_torque}");
    assert!(
        (no_load_speed - 100.0 * PI).abs() < 2e-13,
        "{no_load_speed}"
    );
}

#[test]
fn motion_with_led_actuators() {
    let motion = free_motion().motion.unwrap();
    let swing = Sinusoid::starting_at(deg(30.0), deg(10.0), 2.0, 0.0).unwrap();
    let stroke = Spline::through(&[[0.0, 0.005], [3.0, 0.008]]).unwrap();
    let prescribed = [Law::Sinusoid(swing), Law::Spline(stroke)];
    let [_, swing, ..] = prescribed[0].eval(0.0);
    let [begin, speed, ..] = prescribed[1].eval(0.0);
    assert_eq!(
        motion.initial_coordinates,
        [deg(20.0), deg(30.0), begin, 0.0]
    );
    assert_eq!(motion.initial_velocities, [deg(90.0), swing, speed, PI]);
    let [swing, stroke] = prescribed;
    assert_eq!(motion.laws, [None, Some(swing), Some(stroke), None]);
    assert_eq!(motion.duration, MotionDuration::Seconds(3.0));
}

/// A bare number is the only free actuator's, and loads, drives or laws can do without a speed.
#[test]
fn defaults_of_a_motion() {
    let motion = |old: &str, new: &str| {
        parse(&changed(FREE_MOTION, old, new))
            .unwrap()
            .motion
            .unwrap()
    };
    let at_rest = motion("initial-velocity = { phi = 90, omega = 180 }\n", "");
    assert_eq!(
        [at_rest.initial_velocities[0], at_rest.initial_velocities[3]],
        [0.0; 2]
    );
    let one = FREE_MOTION
        .replace(
            "initial-coordinate = { phi = 20 }",
            "initial-coordinate = 20",
        )
        .replace(
            "[motion.prescribed]\n",
            "[motion.prescribed]\nomega = { speed = 45 }\n",
        )
        .replace(
            "initial-velocity = { phi = 90, omega = 180 }\nduration",
            "initial-velocity = 90\nduration",
        )
        .replace("applied-force = \"omega\"", "applied-force = \"phi\"")
        .replace(
            "speed-controller = \"omega\", speed = 180",
            "speed-controller = \"phi\", speed = 180",
        );
    let motion = parse(&one).unwrap().motion.unwrap();
    assert_eq!(
        motion.initial_coordinates,
        [deg(20.0), deg(30.0), 0.005, 0.0]
    );
    assert_eq!(
        [motion.initial_velocities[0], motion.initial_velocities[3]],
        [deg(90.0), deg(45.0)]
    );
    let bare = FREE_MOTION.split("[loads]").next().unwrap();
    let laws = "[motion]\nduration = 1\nprescribed.omega = { speed = 1 }\n";
    let motion = parse(&format!("{bare}{laws}")).unwrap().motion.unwrap();
    assert_eq!(motion.initial_velocities[0], 0.0);
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
        ("turning", EventTrigger::Reversal(RISE), false),
        ("off", normal(4, 0.0), true),
        ("hard", normal(5, -15.0), false),
        ("again", EventTrigger::Revolution(PHI), false),
    ]
    .map(|(name, trigger, terminal)| NamedEvent {
        name: name.to_owned(),
        trigger,
        terminal,
    });
    assert_eq!(free_motion().motion.unwrap().events, expected);
}

/// The drives are a model's last loads: places count on.
#[test]
fn a_later_error_points_at_loads_friction_and_drives() {
    let scene = free_motion();
    for (location, text) in [
        (SceneLocation::Load(2), "drag"),
        (SceneLocation::Magnitude(2), "-20"),
        (SceneLocation::Load(3), "B"),
        (SceneLocation::Magnitude(3), "0.1"),
        (SceneLocation::Magnitude(4), "0.002"),
        (SceneLocation::Load(6), "B"),
        (SceneLocation::Load(7), "slide"),
        (SceneLocation::Magnitude(9), "0.003"),
        (SceneLocation::Load(10), "engine"),
        (SceneLocation::Load(14), "brake"),
        (SceneLocation::Magnitude(11), "\"12 - 2*t\""),
        (SceneLocation::Magnitude(12), "0.5"),
        (SceneLocation::Magnitude(13), "180"),
        (SceneLocation::Drive(1), "starter"),
        (SceneLocation::Event(2), "off"),
        (SceneLocation::MotionLaw(ActuatorId(1)), "psi"),
        // Not written down: the nearest thing that is.
        (SceneLocation::MotionLaw(ActuatorId(0)), "[motion]"),
        (SceneLocation::Event(9), "[motion]"),
        (SceneLocation::Drive(9), ""),
        (SceneLocation::Load(15), ""),
    ] {
        let error = scene.error("wrong".to_owned(), None, &[(location, "here".to_owned())]);
        assert_eq!(error.labelled(), [(text, "here")], "{location:?}");
    }
}
