//! Small machines with every kind of joint and drive, described by hand.

use dwell_geometry::{
    Actuator, ActuatorKind, AssemblyConfiguration, Body, BodyId, Coordinate, Coupling, Joint,
    JointId, JointKind, Mechanism, Vec2, vec2,
};
use dwell_kinetostatics::Mass;
use dwell_laws::{Law, Polynomial};

pub(crate) struct Machine {
    pub(crate) name: &'static str,
    pub(crate) mechanism: Mechanism,
    pub(crate) masses: Vec<Mass>,
    pub(crate) assembly: AssemblyConfiguration,
}

const O: Vec2 = Vec2::ZERO;
const X: Vec2 = vec2(1.0, 0.0);
const REVOLUTE: JointKind = JointKind::Revolute;
const PRISMATIC: JointKind = JointKind::Prismatic { axes: [X, X] };

/// Bodies 1 to `n` move, each with its centre off its frame's origin.
fn machine<const J: usize>(
    name: &'static str,
    initial_angles: &[f64],
    joints: [([usize; 2], [Vec2; 2], JointKind); J],
    (bodies, drive, q): ([usize; 2], ActuatorKind, f64),
    relations: Vec<Coupling>,
) -> Machine {
    let body = |i: usize| Body::named(format!("body {i}"));
    let joint = |(bodies, points, kind): ([usize; 2], [Vec2; 2], JointKind)| {
        Joint::new("joint", bodies, points, kind)
    };
    let ground = [Mass::default()].into_iter();
    let moving = (0..initial_angles.len()).map(|i| {
        let one = [0.7, 1.1, 0.9][i % 3];
        Mass {
            mass: one,
            center: vec2(0.05 * one, 0.03),
            inertia: 4e-3 * one,
        }
    });
    let at = [None]
        .into_iter()
        .chain(initial_angles.iter().map(|&a| Some(a)));
    Machine {
        name,
        mechanism: Mechanism {
            bodies: (0..=initial_angles.len()).map(body).collect(),
            ground: 0,
            joints: joints.into_iter().map(joint).collect(),
            actuators: vec![Actuator::new("q", bodies, drive)],
            couplings: relations,
        },
        masses: ground.chain(moving).collect(),
        assembly: AssemblyConfiguration {
            q: vec![q],
            initial_guess: at.collect(),
            ..AssemblyConfiguration::default()
        },
    }
}

fn couplings(
    dependent: Coordinate,
    independent: Coordinate,
    coefficients: &[f64],
) -> Vec<Coupling> {
    let coefficients = coefficients.to_vec();
    vec![Coupling {
        dependent,
        independent,
        law: Law::Polynomial(Polynomial { coefficients }),
    }]
}

pub(crate) fn all() -> Vec<Machine> {
    let crank = ([0, 1], [O, O], REVOLUTE);
    let driven_angle = ([0, 1], ActuatorKind::Angle, 0.5);
    let gear = |radii, internal| JointKind::Gear { radii, internal };
    let (track, rack) = (vec2(0.0, -0.1), vec2(0.1, -0.15));
    let rolling = JointKind::Rolling {
        axis: X,
        radius: 0.1,
    };
    let on_rack = JointKind::Rack {
        axis: X,
        radius: 0.15,
    };
    let slot = JointKind::Slot { axis: X };
    let rod = JointKind::Distance { length: 0.3 };
    let first = Coordinate::Angle([BodyId(0), BodyId(1)]);
    let second = Coordinate::Angle([BodyId(0), BodyId(2)]);
    let line = [vec2(0.3, 0.0), vec2(0.2, 0.1)];
    let none = Vec::new;
    vec![
        machine(
            "gears",
            &[0.5, 0.2],
            [
                crank,
                ([0, 2], [vec2(0.3, 0.0), O], REVOLUTE),
                ([1, 2], [O, O], gear([0.1, 0.2], false)),
            ],
            driven_angle,
            none(),
        ),
        machine(
            "planet in a ring",
            &[0.5, 0.9],
            [
                crank,
                ([1, 2], [vec2(0.2, 0.0), O], REVOLUTE),
                ([0, 2], [O, O], gear([0.3, 0.1], true)),
            ],
            driven_angle,
            none(),
        ),
        machine(
            "rack and pinion",
            &[0.5, 0.0],
            [
                crank,
                ([0, 2], [rack, O], PRISMATIC),
                ([2, 1], [O, O], on_rack),
            ],
            driven_angle,
            none(),
        ),
        machine(
            "rolling disc with a rod",
            &[0.5, 0.3],
            [
                ([0, 1], [track, O], rolling),
                ([1, 2], [vec2(0.0, 0.05), O], REVOLUTE),
                ([0, 2], [vec2(0.6, 0.0), vec2(0.6, 0.0)], slot),
            ],
            driven_angle,
            none(),
        ),
        machine(
            "slotted rocker",
            &[0.5, 0.2],
            [
                crank,
                ([0, 2], [vec2(-0.3, 0.0), O], REVOLUTE),
                ([2, 1], [vec2(0.0, 0.02), vec2(0.1, 0.0)], slot),
            ],
            driven_angle,
            none(),
        ),
        machine(
            "distance",
            &[0.5, 1.2],
            [
                crank,
                ([0, 2], [vec2(0.3, 0.0), O], REVOLUTE),
                ([1, 2], [vec2(0.1, 0.0), vec2(0.25, 0.0)], rod),
            ],
            driven_angle,
            none(),
        ),
        machine(
            "welded",
            &[0.5, 0.8],
            [
                crank,
                (
                    [1, 2],
                    [vec2(0.1, 0.05), vec2(0.02, 0.0)],
                    JointKind::Weld { angle: 0.3 },
                ),
            ],
            driven_angle,
            none(),
        ),
        machine(
            "cylinder",
            &[0.6],
            [crank],
            ([0, 1], ActuatorKind::Length(line), 0.25),
            none(),
        ),
        machine(
            "driven slide",
            &[0.6, -0.3, 0.0],
            [
                crank,
                ([1, 2], [vec2(0.1, 0.0), O], REVOLUTE),
                ([2, 3], [vec2(0.35, 0.0), O], REVOLUTE),
                ([0, 3], [vec2(0.0, 0.02), O], PRISMATIC),
            ],
            ([0, 3], ActuatorKind::Travel(JointId(3)), 0.37),
            none(),
        ),
        machine(
            "driven slot",
            &[0.6, 0.2],
            [
                crank,
                ([0, 2], [vec2(-0.3, 0.0), O], REVOLUTE),
                ([2, 1], [vec2(0.0, 0.02), vec2(0.1, 0.0)], slot),
            ],
            ([2, 1], ActuatorKind::Travel(JointId(2)), 0.33),
            none(),
        ),
        machine(
            "cam",
            &[0.5, 0.3],
            [
                crank,
                ([0, 2], [vec2(0.3, 0.0), O], REVOLUTE),
                ([0, 2], [O, O], JointKind::Coupling(0)),
            ],
            driven_angle,
            couplings(second, first, &[0.1, 0.5, -0.3, 0.2]),
        ),
        machine(
            "lifting cam",
            &[0.5, 0.0],
            [
                crank,
                ([0, 2], [vec2(0.3, 0.0), O], PRISMATIC),
                ([0, 2], [O, O], JointKind::Coupling(0)),
            ],
            driven_angle,
            couplings(Coordinate::Travel(JointId(1)), first, &[0.1, 0.05, -0.02]),
        ),
        machine(
            "angle by a length",
            &[0.6, 0.3],
            [
                crank,
                ([0, 2], [vec2(0.3, 0.0), O], REVOLUTE),
                ([0, 2], [O, O], JointKind::Coupling(0)),
            ],
            driven_angle,
            couplings(
                second,
                Coordinate::Length {
                    bodies: [BodyId(0), BodyId(1)],
                    points: line,
                },
                &[0.1, 1.5, -0.4],
            ),
        ),
    ]
}
