//! Small machines with every kind of joint and drive, described by hand.

use dwell_geometry::{
    Actuator, Body, BodyId, Coordinate, Drive, Joint, JointId, JointKind, Mechanism, Relation,
    Start, Vec2, vec2,
};
use dwell_kinetostatics::Mass;
use dwell_laws::{Law, Polynomial};

pub(crate) struct Machine {
    pub(crate) name: &'static str,
    pub(crate) mechanism: Mechanism,
    pub(crate) masses: Vec<Mass>,
    pub(crate) start: Start,
}

const O: Vec2 = Vec2::ZERO;
const X: Vec2 = vec2(1.0, 0.0);
const PIN: JointKind = JointKind::Revolute;
const SLIDE: JointKind = JointKind::Prismatic { axes: [X, X] };

/// Bodies 1 to `n` move, each with its centre off its frame's origin.
fn machine<const J: usize>(
    name: &'static str,
    rough: &[f64],
    joints: [([usize; 2], [Vec2; 2], JointKind); J],
    (bodies, drive, q): ([usize; 2], Drive, f64),
    relations: Vec<Relation>,
) -> Machine {
    let body = |i: usize| Body {
        name: format!("body {i}"),
    };
    let joint = |(bodies, points, kind): ([usize; 2], [Vec2; 2], JointKind)| Joint {
        name: "joint".into(),
        bodies: bodies.map(BodyId),
        points,
        kind,
    };
    let ground = [Mass::default()].into_iter();
    let moving = (0..rough.len()).map(|i| {
        let one = [0.7, 1.1, 0.9][i % 3];
        Mass {
            mass: one,
            center: vec2(0.05 * one, 0.03),
            inertia: 4e-3 * one,
        }
    });
    let at = [None].into_iter().chain(rough.iter().map(|&a| Some(a)));
    Machine {
        name,
        mechanism: Mechanism {
            bodies: (0..=rough.len()).map(body).collect(),
            ground: 0,
            joints: joints.into_iter().map(joint).collect(),
            actuators: vec![Actuator {
                name: "q".into(),
                bodies: bodies.map(BodyId),
                drive,
            }],
            relations,
        },
        masses: ground.chain(moving).collect(),
        start: Start {
            q: vec![q],
            rough: at.collect(),
            ..Start::default()
        },
    }
}

fn related(of: Coordinate, by: Coordinate, coefficients: &[f64]) -> Vec<Relation> {
    let coefficients = coefficients.to_vec();
    vec![Relation {
        of,
        by,
        law: Law::Polynomial(Polynomial { coefficients }),
    }]
}

pub(crate) fn all() -> Vec<Machine> {
    let crank = ([0, 1], [O, O], PIN);
    let turned = ([0, 1], Drive::Angle, 0.5);
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
                ([0, 2], [vec2(0.3, 0.0), O], PIN),
                ([1, 2], [O, O], gear([0.1, 0.2], false)),
            ],
            turned,
            none(),
        ),
        machine(
            "planet in a ring",
            &[0.5, 0.9],
            [
                crank,
                ([1, 2], [vec2(0.2, 0.0), O], PIN),
                ([0, 2], [O, O], gear([0.3, 0.1], true)),
            ],
            turned,
            none(),
        ),
        machine(
            "rack and pinion",
            &[0.5, 0.0],
            [crank, ([0, 2], [rack, O], SLIDE), ([2, 1], [O, O], on_rack)],
            turned,
            none(),
        ),
        machine(
            "rolling disc with a rod",
            &[0.5, 0.3],
            [
                ([0, 1], [track, O], rolling),
                ([1, 2], [vec2(0.0, 0.05), O], PIN),
                ([0, 2], [vec2(0.6, 0.0), vec2(0.6, 0.0)], slot),
            ],
            turned,
            none(),
        ),
        machine(
            "slotted rocker",
            &[0.5, 0.2],
            [
                crank,
                ([0, 2], [vec2(-0.3, 0.0), O], PIN),
                ([2, 1], [vec2(0.0, 0.02), vec2(0.1, 0.0)], slot),
            ],
            turned,
            none(),
        ),
        machine(
            "distance",
            &[0.5, 1.2],
            [
                crank,
                ([0, 2], [vec2(0.3, 0.0), O], PIN),
                ([1, 2], [vec2(0.1, 0.0), vec2(0.25, 0.0)], rod),
            ],
            turned,
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
            turned,
            none(),
        ),
        machine(
            "cylinder",
            &[0.6],
            [crank],
            ([0, 1], Drive::Length(line), 0.25),
            none(),
        ),
        machine(
            "driven slide",
            &[0.6, -0.3, 0.0],
            [
                crank,
                ([1, 2], [vec2(0.1, 0.0), O], PIN),
                ([2, 3], [vec2(0.35, 0.0), O], PIN),
                ([0, 3], [vec2(0.0, 0.02), O], SLIDE),
            ],
            ([0, 3], Drive::Travel(JointId(3)), 0.37),
            none(),
        ),
        machine(
            "driven slot",
            &[0.6, 0.2],
            [
                crank,
                ([0, 2], [vec2(-0.3, 0.0), O], PIN),
                ([2, 1], [vec2(0.0, 0.02), vec2(0.1, 0.0)], slot),
            ],
            ([2, 1], Drive::Travel(JointId(2)), 0.33),
            none(),
        ),
        machine(
            "cam",
            &[0.5, 0.3],
            [
                crank,
                ([0, 2], [vec2(0.3, 0.0), O], PIN),
                ([0, 2], [O, O], JointKind::Relation(0)),
            ],
            turned,
            related(second, first, &[0.1, 0.5, -0.3, 0.2]),
        ),
        machine(
            "lifting cam",
            &[0.5, 0.0],
            [
                crank,
                ([0, 2], [vec2(0.3, 0.0), O], SLIDE),
                ([0, 2], [O, O], JointKind::Relation(0)),
            ],
            turned,
            related(Coordinate::Travel(JointId(1)), first, &[0.1, 0.05, -0.02]),
        ),
        machine(
            "angle by a length",
            &[0.6, 0.3],
            [
                crank,
                ([0, 2], [vec2(0.3, 0.0), O], PIN),
                ([0, 2], [O, O], JointKind::Relation(0)),
            ],
            turned,
            related(
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
