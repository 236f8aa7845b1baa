//! The contents of machine.toml, to the last digit: every kind of joint, actuator, coordinate and load,
//! prescribed motions and sweeps.

use super::*;
use crate::NamedCoordinate;
use dwell_geometry::{
    ActuatorId, ActuatorKind, BodyId, Component, Coordinate, JointId, JointKind, Reaction, Vec2,
    vec2,
};
use dwell_kinetostatics::{Direction, Load, LoadKind, Magnitude, Signal};
use dwell_laws::{Expression, Interpolation, Law, Polynomial, Profile, Rise, Shape, Spline};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

// The bodies in the order of the file.
const GROUND: BodyId = BodyId(0);
const CRANK: BodyId = BodyId(1);
const ROD: BodyId = BodyId(2);
const LEVER: BodyId = BodyId(3);
const PISTON: BodyId = BodyId(4);
const BLOCK: BodyId = BodyId(5);
const PLATE: BodyId = BodyId(6);
const SUN: BodyId = BodyId(7);
const WHEEL: BodyId = BodyId(8);
const BAR: BodyId = BodyId(9);
const FOLLOWER: BodyId = BodyId(10);

const PHI: Coordinate = Coordinate::Angle([GROUND, CRANK]);
const LIFT: Coordinate = Coordinate::Travel(JointId(11));

fn machine() -> PlaneScene {
    parse(MACHINE).unwrap()
}

/// x/1000, as the reader converts mm.
fn mm(x: f64, y: f64) -> Vec2 {
    vec2(x / 1e3, y / 1e3)
}

/// x π/180, as the reader converts degrees.
fn deg(x: f64) -> f64 {
    x * PI / 180.0
}

/// A pressure angle makes a load, named after the joint, which points to the angle in the file.
#[test]
fn teeth_with_a_pressure_angle_have_a_separating_force() {
    let text = MACHINE
        .replace(
            "internal = true }",
            "internal = true, pressure-angle = 45 }",
        )
        .replace("radius = -30 }", "radius = -30, pressure-angle = 20 }");
    let scene = parse(&text).unwrap();
    let count = machine().loads.len();
    assert_eq!(scene.loads[..count], machine().loads);
    let joint = |name: &str| {
        let found = scene.mechanism.joints.iter().position(|j| j.name == name);
        JointId(found.unwrap())
    };
    let separating = |name: &str, angle: f64| {
        let id = joint(name);
        Load::separating(&scene.mechanism.joints[id.0], id, deg(angle)).unwrap()
    };
    let expected = [separating("mesh", 45.0), separating("strip", 20.0)];
    assert_eq!(scene.loads[count..], expected);
    assert_eq!(expected[0].name, "mesh.separating");
    let place = crate::SceneLocation::Magnitude(count);
    let error = scene.error(String::new(), None, &[(place, "here".to_owned())]);
    assert_eq!(error.errors()[0].labelled(), [("45", "here")]);
}

#[test]
fn joints() {
    let scene = machine();
    let x = vec2(1.0, 0.0);
    let y = vec2(0.0, 1.0);
    let o = Vec2::ZERO;
    let revolute = JointKind::Revolute;
    let gear = JointKind::Gear {
        radii: [0.06, 0.02],
        internal: true,
    };
    let rack = JointKind::Rack {
        axis: x,
        radius: -0.03,
    };
    let rolling = JointKind::Rolling {
        axis: x,
        radius: 0.02,
    };
    let expected = [
        ("O-crank", [GROUND, CRANK], [o, o], revolute),
        ("O-sun", [GROUND, SUN], [o, o], revolute),
        ("P-rod", [CRANK, ROD], [mm(40.0, 0.0), o], revolute),
        ("P-lever", [CRANK, LEVER], [mm(40.0, 0.0), o], revolute),
        (
            "slide",
            [GROUND, PISTON],
            [mm(0.0, 10.0), o],
            JointKind::Prismatic { axes: [x, x] },
        ),
        (
            "Q",
            [ROD, PISTON],
            [mm(120.0, 0.0), o],
            JointKind::Distance { length: 0.025 },
        ),
        (
            "groove",
            [LEVER, BLOCK],
            [mm(0.0, 70.0), o],
            JointKind::Slot { axis: y },
        ),
        (
            "seam",
            [BLOCK, PLATE],
            [mm(0.0, 5.0), o],
            JointKind::Weld { angle: FRAC_PI_2 },
        ),
        ("mesh", [SUN, WHEEL], [o, o], gear),
        ("strip", [BAR, SUN], [o, o], rack),
        ("floor", [GROUND, WHEEL], [mm(0.0, -50.0), o], rolling),
        (
            "guide",
            [GROUND, FOLLOWER],
            [mm(0.0, 10.0), o],
            JointKind::Prismatic { axes: [y, y] },
        ),
        (
            "cam",
            [GROUND, FOLLOWER],
            [mm(0.0, 10.0), o],
            JointKind::Coupling(0),
        ),
        ("map", [GROUND, ROD], [o, o], JointKind::Coupling(1)),
    ];
    let joints = &scene.mechanism.joints;
    assert_eq!(joints.len(), expected.len());
    for (joint, (name, bodies, points, kind)) in joints.iter().zip(expected) {
        assert_eq!(joint.name, name);
        assert_eq!(
            (joint.bodies, joint.points, joint.kind),
            (bodies, points, kind),
            "{name}"
        );
    }
}

#[test]
fn relations() {
    let scene = machine();
    let [cam, map] = scene.mechanism.couplings.as_slice() else {
        panic!("two relations");
    };
    assert_eq!((cam.dependent, cam.independent), (LIFT, PHI));
    let law = Expression::parse("0.01*(1 - cos(x))", &["x"]).unwrap();
    assert_eq!(cam.law, Law::Expression(law));
    let reach = scene.coordinate("reach").unwrap();
    assert_eq!(
        (map.dependent, map.independent),
        (Coordinate::Angle([GROUND, ROD]), reach)
    );
    let points = [[0.02, 0.0], [0.04, deg(10.0)], [0.08, deg(15.0)]];
    assert_eq!(map.law, Law::Spline(Spline::through(&points).unwrap()));
}

/// A rise of a relation is in the units of both coordinates, and begins where the scene says.
#[test]
fn a_rise_over_an_angle() {
    let text = changed(
        MACHINE,
        "expression = \"0.01*(1 - cos(x))\"",
        "polynomial345 = { rise = 20, duration = 120, delay = -30 }, start = 50",
    );
    let scene = parse(&text).unwrap();
    let rise = Rise {
        start: 0.05,
        rise: 0.02,
        duration: deg(120.0),
        delay: deg(-30.0),
    };
    let law = Profile::new(Shape::Polynomial345, rise).unwrap();
    assert_eq!(scene.mechanism.couplings[0].law, Law::Profile(law));
}

#[test]
fn actuators_and_coordinates() {
    let scene = machine();
    let actuators: Vec<_> = scene
        .mechanism
        .actuators
        .iter()
        .map(|a| (a.name.as_str(), a.bodies, a.kind))
        .collect();
    let jack = [mm(90.0, 90.0), mm(20.0, 0.0)];
    assert_eq!(
        actuators,
        [
            ("phi", [GROUND, CRANK], ActuatorKind::Angle),
            ("stroke", [LEVER, BLOCK], ActuatorKind::Travel(JointId(6))),
            ("jack", [GROUND, PLATE], ActuatorKind::Length(jack)),
        ]
    );
    let named = |name: &str, coordinate| NamedCoordinate {
        name: name.to_owned(),
        coordinate,
    };
    let reach = Coordinate::Length {
        bodies: [GROUND, ROD],
        points: [Vec2::ZERO, mm(120.0, 0.0)],
    };
    let alpha = Coordinate::Angle([GROUND, ROD]);
    assert_eq!(
        scene.coordinates,
        [
            named("lift", LIFT),
            named("alpha", alpha),
            named("reach", reach)
        ]
    );
    assert_eq!(scene.coordinate("phi"), Some(PHI));
    assert_eq!(scene.coordinate("lift"), Some(LIFT));
    assert_eq!(scene.coordinate("crank"), None);
    // Rad, m and m: each actuator's own unit.
    assert_eq!(scene.assembly.coordinates, [deg(60.0), 0.0, 0.08]);
    assert_eq!(scene.assembly.initial_guess[ROD.0], Some(deg(-20.0)));
}

#[test]
fn prescribed_and_swept() {
    let scene = machine();
    let prescribed = scene.prescribed.unwrap();
    assert_eq!((prescribed.duration, prescribed.points), (2.0, 401));
    let rise = Rise {
        start: 0.0,
        rise: 0.03,
        duration: 0.5,
        delay: 0.25,
    };
    let laws = [
        Law::Polynomial(Polynomial::motion(deg(60.0), TAU, 0.0)),
        Law::Profile(Profile::new(Shape::Trapezoidal { ramp: 0.1 }, rise).unwrap()),
        Law::Spline(Spline::through(&[[0.0, 0.08], [1.0, 0.09], [2.0, 0.085]]).unwrap()),
    ];
    assert_eq!(prescribed.laws, laws);
    let sweep = scene.sweep.unwrap();
    assert_eq!(
        (sweep.actuator, sweep.range),
        (ActuatorId(0), Some([0.0, TAU]))
    );
    assert_eq!(sweep.fixed_coordinates, [deg(60.0), 0.005, 0.08]);
    assert_eq!((sweep.points, sweep.speed), (181, PI));
}

/// Whatever is not said of a motion or a sweep has its default; a law begins at the assembly.
#[test]
fn defaults_of_motions_and_sweeps() {
    let scene = |sections: &str| {
        let bare = WHOLE.split("[requests]").next().unwrap();
        parse(&format!("{bare}{sections}")).unwrap()
    };
    let swept = scene("[coordinate-sweep]").sweep.unwrap();
    assert_eq!((swept.actuator, swept.range), (ActuatorId(0), None));
    assert_eq!((swept.points, swept.speed), (361, 1.0));
    assert_eq!(swept.fixed_coordinates, [deg(90.0)]);
    for (law, at_start) in [
        ("speed = 1", deg(90.0)),
        (
            "sinusoid = { amplitude = 10, period = 2, phase = 30 }",
            deg(90.0),
        ),
        ("cycloidal = { rise = 10, duration = 1 }", deg(90.0)),
        ("polynomial4567 = { rise = 10, duration = 1 }", deg(90.0)),
        ("expression = \"0.5 + t\"", 0.5),
        ("table = [[-1, 10], [0, 20], [3, 40]]", deg(20.0)),
    ] {
        let prescribed = scene(&format!("[prescribed]\nduration = 3\nphi = {{ {law} }}"));
        let prescribed = prescribed.prescribed.unwrap();
        assert_eq!(prescribed.points, 361);
        let [start, ..] = prescribed.laws[0].eval(0.0);
        // Numbers near 1; the sine subtracts and adds its phase, two roundings.
        assert!((start - at_start).abs() < 4e-16, "{law}: {start}");
    }
}

#[test]
fn loads() {
    let scene = machine();
    let down = vec2(0.0, -1.0);
    let monotone = |rows: &[[f64; 2]]| Spline::interpolating(rows, Interpolation::Monotone);
    let couple = monotone(&[[0.0, 1.0], [FRAC_PI_2, 2.0], [PI, 1.5]]).unwrap();
    let torsion = monotone(&[[0.0, 10.0], [2.0, 20.0]]).unwrap();
    let follow = "100*max(0, sin(phi)) + 2*lift.velocity";
    let follow = Expression::parse(follow, &["phi", "lift.velocity"]).unwrap();
    let grease = Expression::parse("0.1 + 0.05*exp(-t)", &["t"]).unwrap();
    let constant = Magnitude::Constant;
    let expected = [
        (
            "weight",
            LoadKind::Gravity { direction: down },
            constant(9.81),
        ),
        (
            "push",
            LoadKind::Force {
                body: PISTON,
                point: Vec2::ZERO,
                direction: Direction::Ground(vec2(-1.0, 0.0)),
            },
            constant(100.0),
        ),
        (
            "follow",
            LoadKind::Force {
                body: ROD,
                point: mm(60.0, 5.0),
                direction: Direction::Body(vec2(0.0, 1.0)),
            },
            Magnitude::Expression(follow, vec![Signal::Value(PHI), Signal::Velocity(LIFT)]),
        ),
        ("moment", LoadKind::couple([GROUND, CRANK]), constant(-3.0)),
        (
            "couple",
            LoadKind::couple([ROD, CRANK]),
            Magnitude::Law(Signal::Value(PHI), Law::Spline(couple)),
        ),
        (
            "coil",
            LoadKind::spring(
                [GROUND, PLATE],
                [mm(90.0, 90.0), mm(20.0, 0.0)],
                77.85 / 1e3,
            ),
            constant(4530.0),
        ),
        (
            "twist",
            LoadKind::torsion_spring([GROUND, WHEEL], deg(45.0)),
            Magnitude::Law(Signal::Time, Law::Spline(torsion)),
        ),
        (
            "oil",
            LoadKind::damper([ROD, LEVER], [mm(60.0, 5.0), mm(0.0, 70.0)]),
            constant(100.0),
        ),
        (
            "grease",
            LoadKind::rotational_damper([GROUND, CRANK]),
            Magnitude::Expression(grease, vec![Signal::Time]),
        ),
        (
            "wind",
            LoadKind::Drag {
                body: ROD,
                point: mm(60.0, 5.0),
            },
            constant(0.6),
        ),
        (
            "fan",
            LoadKind::rotational_drag([GROUND, CRANK]),
            constant(0.002),
        ),
    ];
    assert_eq!(scene.loads.len(), expected.len());
    for (load, (name, kind, magnitude)) in scene.loads.iter().zip(expected) {
        assert_eq!(load.name, name);
        assert_eq!(load.kind, kind, "{name}");
        assert_eq!(load.magnitude, magnitude, "{name}");
    }
}

/// A table of a speed has its first column in the scene's unit of that speed, the second in SI.
#[test]
fn a_table_of_a_speed() {
    let text = changed(MACHINE, "of = \"phi\"", "of = \"lift.velocity\"");
    let scene = parse(&text).unwrap();
    let rows = [[0.0, 1.0], [0.09, 2.0], [0.18, 1.5]];
    let spline = Spline::interpolating(&rows, Interpolation::Monotone).unwrap();
    let expected = Magnitude::Law(Signal::Velocity(LIFT), Law::Spline(spline));
    assert_eq!(scene.loads[4].magnitude, expected);
}

#[test]
fn names_that_are_no_words_stand_between_backticks() {
    let text = MACHINE
        .replace("lift", "lift-1")
        .replace("2*lift-1.velocity", "2*`lift-1.velocity`");
    let scene = parse(&text).unwrap();
    let Magnitude::Expression(expression, signals) = &scene.loads[2].magnitude else {
        panic!("an expression");
    };
    assert_eq!(signals, &[Signal::Value(PHI), Signal::Velocity(LIFT)]);
    // One value for each signal is all it takes: 100 × 1 + 2 × 3.
    assert_eq!(expression.eval(&[FRAC_PI_2, 3.0]), 106.0);
}

#[test]
fn requests() {
    let requests = machine().requests;
    let reaction = |joint: usize, component| Reaction {
        joint: JointId(joint),
        component,
    };
    // `O` is a pin of three bodies: both of its joints.
    assert_eq!(
        requests.reactions,
        [
            reaction(0, Component::X),
            reaction(0, Component::Y),
            reaction(1, Component::X),
            reaction(1, Component::Y),
            reaction(3, Component::X),
            reaction(12, Component::Force),
            reaction(13, Component::Moment),
            reaction(10, Component::Tangent),
        ]
    );
    let variables = requests.variables.unwrap();
    assert_eq!(
        variables,
        ["crank.angle", "rod.Q.x", "phi.actuator_force", "lift"]
    );
    let [section] = requests.sections.as_slice() else {
        panic!("one section");
    };
    assert_eq!(
        (section.body, section.points),
        (ROD, [Vec2::ZERO, mm(120.0, 0.0)])
    );
    assert_eq!(section.names, ["P", "Q"]);
    // Asked for twice it is still one; from the other end it is another.
    let once = "{ body = \"rod\", from = \"P\", to = \"Q\" }";
    let back = "{ body = \"rod\", from = \"Q\", to = \"P\" }";
    let twice = MACHINE.replace(once, &format!("{once}, {back}, {once}"));
    assert_eq!(parse(&twice).unwrap().requests.sections.len(), 2);
}

#[test]
fn a_later_error_points_at_what_is_new() {
    use crate::SceneLocation::*;
    let scene = machine();
    for (location, text) in [
        (
            CouplingLaw(JointId(12)),
            "expression = \"0.01*(1 - cos(x))\"",
        ),
        (JointPoint(JointId(12), 1), "\"phi\""),
        (JointPoint(JointId(3), 1), "\"lever.P\""),
        (Axis(JointId(9)), "[1, 0]"),
        (Coordinate(1), "alpha"),
        (Prescribed, "[prescribed]"),
        (PrescribedLaw(ActuatorId(2)), "jack"),
        (CoordinateSweep, "[coordinate-sweep]"),
        (Swept(ActuatorId(1)), "stroke = 5"),
        (Load(1), "push"),
        (Magnitude(1), "100"),
        (Magnitude(0), "[0, -9.81]"),
        (Variable(2), "\"phi.actuator_force\""),
        (Section(0), "{ body = \"rod\", from = \"P\", to = \"Q\" }"),
        // Not written down: the nearest thing that is.
        (CouplingLaw(JointId(4)), "slide"),
        (Swept(ActuatorId(2)), "[coordinate-sweep]"),
        (Section(9), "[requests]"),
        (Magnitude(99), ""),
    ] {
        let error = scene.error("wrong".to_owned(), None, &[(location, "here".to_owned())]);
        assert_eq!(error.labelled(), [(text, "here")], "{location:?}");
    }
}

/// What needs an actuator, and names that are taken: each told once.
#[test]
fn without_an_actuator_there_is_no_motion_to_prescribe() {
    let bare = WHOLE.split("[actuators.phi]").next().unwrap();
    let text = format!("{bare}[prescribed]\nduration = 1\n[coordinate-sweep]\npoints = 3\n");
    let diagnosed = messages(&text);
    assert_eq!(diagnosed.len(), 2, "{diagnosed:#?}");
    assert!(diagnosed[0].starts_with("there is a [prescribed] but no actuator | «[prescribed]»"));
    assert!(
        diagnosed[1]
            .starts_with("there is a [coordinate-sweep] but no actuator | «[coordinate-sweep]»")
    );
    let text = format!("{bare}[actuators]\nt = {{ angle = [\"ground\", \"crank\"] }}\n");
    assert!(messages(&text)[0].starts_with("`t` cannot be the name of an actuator | «t»"));
}
