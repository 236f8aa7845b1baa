//! Mechanisms with every joint and every drive, under loads.

use super::setup::Setup;
use dwell_geometry::{
    Actuator, ActuatorKind, Body, BodyId, Coordinate, Coupling, Joint, JointId, JointKind,
    Mechanism, Vec2, vec2,
};
use dwell_kinetostatics::{Direction, LoadKind, Mass};
use dwell_laws::{Law, Polynomial};

pub(crate) fn all() -> Vec<Setup> {
    vec![five_bar(), boom(), epicyclic(), wedge(), cam()]
}

fn on([first, second]: [usize; 2]) -> [BodyId; 2] {
    [BodyId(first), BodyId(second)]
}

/// Masses with centres off every point; the ground's does not matter.
fn masses(count: usize) -> Vec<Mass> {
    let of = |b: usize| {
        let b = b as f64;
        Mass {
            mass: 1.0 + 0.3 * b,
            center: vec2(0.2 + 0.05 * b, 0.1 - 0.04 * b),
            inertia: 0.2 + 0.03 * b,
        }
    };
    (0..count).map(of).collect()
}

/// The frame of a body whose `point` is at `at`.
fn pose(point: Vec2, at: Vec2, angle: f64) -> [f64; 3] {
    let origin = at - point.rotate(Vec2::from_angle(angle));
    [origin.x, origin.y, angle]
}

fn weight() -> (LoadKind, f64) {
    let direction = Vec2::from_angle(-1.5);
    (LoadKind::Gravity { direction }, 9.8)
}

/// States that go to `to` from the start, with several speeds and accelerations.
fn motions(start: &[f64], steps: &[&[f64]]) -> Vec<[Vec<f64>; 3]> {
    let rates = [[1.0, 0.7], [-0.8, 0.5], [0.6, -1.2], [0.0, 0.0]];
    let of = |(step, [v, a]): (&&[f64], [f64; 2])| {
        let q = start.iter().zip(*step).map(|(q, s)| q + s).collect();
        let scaled = |by: f64| {
            let one = |i: usize| by * (1.0 - 0.4 * i as f64);
            (0..start.len()).map(one).collect()
        };
        [q, scaled(v), scaled(a)]
    };
    steps.iter().zip(rates).map(of).collect()
}

/// Two cranks with a drive each, two couplers, spring and damper: two degrees of freedom.
// Long: the description of one mechanism.
fn five_bar() -> Setup {
    let (a, e) = (vec2(0.1, -0.3), vec2(2.1, -0.2));
    let (near, far) = (vec2(0.2, 0.1), vec2(1.2, 0.1));
    let (crank1, crank2) = (1.9_f64, 0.8_f64);
    let b = a + Vec2::from_angle(crank1);
    let d = e + Vec2::from_angle(crank2);
    // The upper point at 2 from both.
    let half = (d - b) * 0.5;
    let c = b + half + half.perp() * ((4.0 - half.dot(half)).sqrt() / half.norm());
    let coupler = [vec2(0.0, 0.0), vec2(2.0, 0.0)];
    let points = [vec2(0.4, 0.2), vec2(0.3, -0.1)];
    Setup {
        name: "five-bar",
        mechanism: Mechanism {
            bodies: ["ground", "crank", "left", "right", "other"]
                .map(Body::named)
                .into(),
            joints: vec![
                Joint::revolute("A", [0, 1], [a, near]),
                Joint::revolute("B", [1, 2], [far, coupler[0]]),
                Joint::revolute("C", [3, 2], [coupler[1], coupler[1]]),
                Joint::revolute("D", [3, 4], [coupler[0], far]),
                Joint::revolute("E", [4, 0], [near, e]),
            ],
            actuators: vec![
                Actuator::new("phi", [0, 1], ActuatorKind::Angle),
                Actuator::new("psi", [2, 4], ActuatorKind::Angle),
            ],
            ..Mechanism::default()
        },
        masses: masses(5),
        assembly_poses: vec![
            [0.0; 3],
            pose(near, a, crank1),
            pose(coupler[0], b, (c - b).angle()),
            pose(coupler[0], d, (c - d).angle()),
            pose(near, e, crank2),
        ],
        loads: vec![
            weight(),
            (LoadKind::spring(on([1, 3]), points, 0.6), 40.0),
            (LoadKind::damper(on([0, 2]), points), 7.0),
            (LoadKind::torsion_spring(on([2, 3]), 0.5), 5.0),
        ],
        motions: motions(
            &[crank1, crank2 - (c - b).angle()],
            &[&[0.1, 0.05], &[0.3, -0.2], &[-0.2, 0.1], &[0.0, 0.0]],
        ),
    }
}

/// A boom raised by a massive cylinder, a stick on it drawn by a length, a bucket welded to it.
// Long: the description of one mechanism.
fn boom() -> Setup {
    let (o, p) = (vec2(0.0, 0.3), vec2(0.8, -0.4));
    let raised = 0.5;
    let boom = pose(vec2(0.1, 0.0), o, raised);
    let at = |pose: [f64; 3], point: Vec2| {
        vec2(pose[0], pose[1]) + point.rotate(Vec2::from_angle(pose[2]))
    };
    let (lug, tip) = (vec2(1.4, -0.2), vec2(3.0, 0.1));
    let lifted = at(boom, lug);
    let along = (lifted - p).angle();
    // Barrel and rod: their axes at odd angles in their frames.
    let (axis1, axis2) = (0.3, -1.1);
    let barrel = pose(vec2(0.0, 0.0), p, along - axis1);
    let rod = pose(vec2(0.0, 0.2), lifted, along - axis2);
    let stick = pose(vec2(0.2, 0.0), at(boom, tip), raised - 1.8);
    let (reach, grip) = (vec2(1.9, 0.0), vec2(-0.3, 0.1));
    let bucket = pose(grip, at(stick, reach), stick[2] + 0.6);
    let ends = [vec2(1.6, 0.7), vec2(-0.4, 0.3)];
    let length = (at(stick, ends[1]) - at(boom, ends[0])).norm();
    // The travel from the barrel's pin to the rod's, which lies off the axis.
    let travel = (lifted - p).norm();
    Setup {
        name: "boom",
        mechanism: Mechanism {
            bodies: ["ground", "boom", "barrel", "rod", "stick", "bucket"]
                .map(Body::named)
                .into(),
            joints: vec![
                Joint::revolute("O", [0, 1], [o, vec2(0.1, 0.0)]),
                Joint::revolute("P", [2, 0], [Vec2::ZERO, p]),
                Joint::new(
                    "cylinder",
                    [2, 3],
                    [Vec2::ZERO, vec2(0.0, 0.2)],
                    JointKind::Prismatic {
                        axes: [Vec2::from_angle(axis1), Vec2::from_angle(axis2)],
                    },
                ),
                Joint::revolute("lug", [3, 1], [vec2(0.0, 0.2), lug]),
                Joint::revolute("tip", [1, 4], [tip, vec2(0.2, 0.0)]),
                Joint::new(
                    "grip",
                    [4, 5],
                    [reach, grip],
                    JointKind::Weld { angle: 0.6 },
                ),
            ],
            actuators: vec![
                Actuator::new("lift", [2, 3], ActuatorKind::Travel(JointId(2))),
                Actuator::new("draw", [1, 4], ActuatorKind::Length(ends)),
            ],
            ..Mechanism::default()
        },
        masses: masses(6),
        assembly_poses: vec![[0.0; 3], boom, barrel, rod, stick, bucket],
        loads: vec![
            weight(),
            (
                LoadKind::Force {
                    body: BodyId(5),
                    point: vec2(0.3, -0.4),
                    direction: Direction::Body(Vec2::from_angle(2.0)),
                },
                30.0,
            ),
            (LoadKind::rotational_damper(on([1, 4])), 3.0),
        ],
        motions: motions(
            &[travel, length],
            &[&[0.05, 0.05], &[0.1, -0.1], &[-0.05, 0.02], &[0.0, 0.0]],
        ),
    }
}

/// A fixed sun, an arm that drives a planet, a ring around both, and a rack on the ring's outside.
// Long: the description of one mechanism.
fn epicyclic() -> Setup {
    let o = vec2(0.3, 0.2);
    let (sun, planet, outer) = (0.5, 0.25, 1.2);
    let hub = vec2(0.1, -0.1);
    let arm_angle: f64 = 0.4;
    let centre = o + Vec2::from_angle(arm_angle) * (sun + planet);
    let rim = vec2(0.05, 0.02);
    // The rack below the ring, on a level guide: it has the ring on its left.
    let axis = vec2(1.0, 0.0);
    let level = o - vec2(0.3, outer);
    Setup {
        name: "epicyclic",
        mechanism: Mechanism {
            bodies: ["ground", "arm", "planet", "ring", "rack"]
                .map(Body::named)
                .into(),
            joints: vec![
                Joint::revolute("O", [0, 1], [o, hub]),
                Joint::revolute("P", [1, 2], [hub + vec2(sun + planet, 0.0), rim]),
                Joint::revolute("R", [3, 0], [rim, o]),
                Joint::new(
                    "sun",
                    [2, 0],
                    [rim, o],
                    JointKind::Gear {
                        radii: [planet, sun],
                        internal: false,
                    },
                ),
                Joint::new(
                    "ring",
                    [3, 2],
                    [rim, rim],
                    JointKind::Gear {
                        radii: [sun + 2.0 * planet, planet],
                        internal: true,
                    },
                ),
                Joint::new(
                    "guide",
                    [0, 4],
                    [level, vec2(0.2, 0.0)],
                    JointKind::Prismatic { axes: [axis; 2] },
                ),
                // The pitch line passes through the point on the rack; where along it the ring
                // stands at the start is the row's to say.
                Joint::new(
                    "rack",
                    [4, 3],
                    [vec2(0.5, 0.0), rim],
                    JointKind::Rack {
                        axis,
                        radius: outer,
                    },
                ),
            ],
            actuators: vec![Actuator::new("arm", [0, 1], ActuatorKind::Angle)],
            ..Mechanism::default()
        },
        masses: masses(5),
        assembly_poses: vec![
            [0.0; 3],
            pose(hub, o, arm_angle),
            pose(rim, centre, 1.3),
            pose(rim, o, 0.0),
            // t·(P2 − P1) = 0 with the ring at no angle.
            pose(vec2(0.5, 0.0), o - vec2(0.0, outer), 0.0),
        ],
        loads: vec![
            weight(),
            (LoadKind::couple(on([2, 3])), 4.0),
            (LoadKind::rotational_damper(on([0, 2])), 0.6),
        ],
        // More than a revolution on, so that the planet's and the ring's revolutions are counted.
        motions: motions(&[arm_angle], &[&[1.0], &[-2.0], &[9.0], &[0.0]]),
    }
}

/// A wedge pushed along the ground, a disc that rolls on its slope, held by a bar without mass.
fn wedge() -> Setup {
    let slope = Vec2::from_angle(0.5);
    let foot = vec2(0.1, 0.3);
    let radius = 0.3;
    let wedge_pose = pose(vec2(0.0, -0.1), vec2(0.4, 0.0), 0.0);
    let touch = vec2(wedge_pose[0], wedge_pose[1]) + foot + slope * 0.7;
    let centre = touch + slope.perp() * radius;
    let hub = vec2(0.05, -0.02);
    let anchor = vec2(-0.6, 1.7);
    Setup {
        name: "wedge",
        mechanism: Mechanism {
            bodies: ["ground", "wedge", "disc"].map(Body::named).into(),
            joints: vec![
                Joint::new(
                    "floor",
                    [0, 1],
                    [vec2(-0.2, 0.0), vec2(0.0, -0.1)],
                    JointKind::Prismatic {
                        axes: [vec2(1.0, 0.0); 2],
                    },
                ),
                Joint::new(
                    "slope",
                    [1, 2],
                    [foot, hub],
                    JointKind::Rolling {
                        axis: slope,
                        radius,
                    },
                ),
                Joint::new(
                    "bar",
                    [2, 0],
                    [hub, anchor],
                    JointKind::Distance {
                        length: (centre - anchor).norm(),
                    },
                ),
            ],
            actuators: vec![Actuator::new(
                "push",
                [0, 1],
                ActuatorKind::Travel(JointId(0)),
            )],
            ..Mechanism::default()
        },
        masses: masses(3),
        // t·(P2 − P1) + r θ = 0.
        assembly_poses: vec![[0.0; 3], wedge_pose, pose(hub, centre, -0.7 / radius)],
        loads: vec![
            weight(),
            (
                LoadKind::spring(on([0, 1]), [vec2(-1.0, 0.5), vec2(0.1, 0.1)], 0.0),
                20.0,
            ),
        ],
        motions: motions(&[0.6], &[&[0.1], &[-0.1], &[0.05], &[0.0]]),
    }
}

/// A crank whose angle moves a slide by one law; the slide's pin in a lever's slot; a flag turned
/// by a law of the distance of two points, one on the crank.
// Long: the description of one mechanism.
fn cam() -> Setup {
    let (a, l, f) = (vec2(0.0, 0.0), vec2(1.5, -0.8), vec2(-1.0, 0.5));
    let hub = vec2(0.1, 0.05);
    let law = |coefficients: &[f64]| {
        Law::Polynomial(Polynomial {
            coefficients: coefficients.to_vec(),
        })
    };
    let lift = [0.4, 0.3, -0.1, 0.05];
    let crank_angle: f64 = 0.7;
    let travel = Polynomial {
        coefficients: lift.to_vec(),
    }
    .eval(crank_angle)[0];
    let guide = Vec2::from_angle(0.3);
    let foot = vec2(0.6, 0.4);
    let (shoe, stud) = (vec2(0.0, 0.1), vec2(0.2, -0.1));
    let slide_pose = pose(shoe, foot + guide * travel, 0.3);
    let at = |pose: [f64; 3], point: Vec2| {
        vec2(pose[0], pose[1]) + point.rotate(Vec2::from_angle(pose[2]))
    };
    // The slot passes through the lever's pin.
    let slot = Vec2::from_angle(1.2);
    let lever = pose(hub, l, (at(slide_pose, stud) - l).angle() - 1.2);
    let crank = pose(hub, a, crank_angle);
    let ends = [vec2(0.5, 0.0), vec2(0.1, 0.3)];
    let distance = (at(slide_pose, ends[1]) - at(crank, ends[0])).norm();
    let wave = [0.2, 0.8, 0.3];
    let flagged = Polynomial {
        coefficients: wave.to_vec(),
    }
    .eval(distance)[0];
    Setup {
        name: "cam",
        mechanism: Mechanism {
            bodies: ["ground", "crank", "slide", "lever", "flag"]
                .map(Body::named)
                .into(),
            joints: vec![
                Joint::revolute("A", [0, 1], [a, hub]),
                Joint::new(
                    "guide",
                    [0, 2],
                    [foot, shoe],
                    JointKind::Prismatic {
                        axes: [guide, vec2(1.0, 0.0)],
                    },
                ),
                Joint::new("cam", [0, 2], [Vec2::ZERO; 2], JointKind::Coupling(0)),
                Joint::revolute("L", [3, 0], [hub, l]),
                Joint::new("slot", [3, 2], [hub, stud], JointKind::Slot { axis: slot }),
                Joint::revolute("F", [0, 4], [f, hub]),
                Joint::new("wave", [0, 4], [Vec2::ZERO; 2], JointKind::Coupling(1)),
            ],
            actuators: vec![Actuator::new("phi", [0, 1], ActuatorKind::Angle)],
            couplings: vec![
                Coupling {
                    dependent: Coordinate::Travel(JointId(1)),
                    independent: Coordinate::Angle(on([0, 1])),
                    law: law(&lift),
                },
                Coupling {
                    dependent: Coordinate::Angle(on([0, 4])),
                    independent: Coordinate::Length {
                        bodies: on([1, 2]),
                        points: ends,
                    },
                    law: law(&wave),
                },
            ],
            ..Mechanism::default()
        },
        masses: masses(5),
        assembly_poses: vec![[0.0; 3], crank, slide_pose, lever, pose(hub, f, flagged)],
        loads: vec![
            weight(),
            (LoadKind::damper(on([4, 2]), ends), 5.0),
            (LoadKind::torsion_spring(on([0, 4]), 0.2), 3.0),
        ],
        motions: motions(&[crank_angle], &[&[0.2], &[0.5], &[-0.3], &[0.0]]),
    }
}
