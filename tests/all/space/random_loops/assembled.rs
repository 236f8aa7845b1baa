//! Random mechanisms assembled at a pose: one loop, or two; driven at a joint, by a length, or through a gear pair.

use dwell_geometry::space::{
    Actuator, Joint, JointKind, Mechanism, Placement, Rotation, Side, Vec3, vec3,
};
use dwell_geometry::{Body, BodyId};
use dwell_kinetostatics::space::{Axes, Component, Mass, Reaction};

/// Pseudorandom numbers by the generator of Steele, Lea and Flood (SplitMix64).
pub(super) struct Random(pub(super) u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// From −1 to 1.
    fn number(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    pub(super) fn vector(&mut self) -> Vec3 {
        vec3(self.number(), self.number(), self.number())
    }

    fn direction(&mut self) -> Vec3 {
        loop {
            let v = self.vector();
            if v.norm() > 0.1 && v.norm() < 1.0 {
                return v.unit().unwrap_or(v);
            }
        }
    }

    fn placement(&mut self) -> Placement {
        Placement {
            position: self.vector(),
            rotation: Rotation::IDENTITY.turned_by(self.direction().scaled(3.0 * self.number())),
        }
    }

    fn mass(&mut self) -> Mass {
        // The tensor of six point masses.
        let points: Vec<Vec3> = (0..6).map(|_| self.vector().scaled(0.3)).collect();
        let center = points
            .iter()
            .fold(Vec3::ZERO, |a, b| a + *b)
            .scaled(1.0 / 6.0);
        let mut inertia = [0.0; 6];
        for r in points.iter().map(|p| *p - center) {
            let square = r.dot(r);
            let part = [
                square - r.x * r.x,
                square - r.y * r.y,
                square - r.z * r.z,
                -r.x * r.y,
                -r.x * r.z,
                -r.y * r.z,
            ];
            for (sum, part) in inertia.iter_mut().zip(part) {
                *sum += part / 6.0;
            }
        }
        let mass = 1.5 + self.number();
        Mass {
            mass,
            center,
            inertia: inertia.map(|i| i * mass),
        }
    }

    /// Kinds of joints among these with so many freedoms in sum.
    fn kinds(&mut self, freedoms: usize, all: &[JointKind]) -> Vec<JointKind> {
        let mut found: Vec<JointKind> = Vec::new();
        let mut left = freedoms;
        while left > 0 {
            let kind = all[self.below(all.len())];
            if kind.freedoms() <= left {
                left -= kind.freedoms();
                found.push(kind);
            }
        }
        found
    }
}

/// The kinds of joints of which loops are made; those after the seventh only where a point is driven on a line.
const KINDS: [JointKind; 9] = [
    JointKind::Revolute,
    JointKind::Prismatic,
    JointKind::Cylindrical,
    JointKind::Universal,
    JointKind::Spherical,
    JointKind::Planar,
    JointKind::Helical { pitch: 0.2 },
    JointKind::PointOnLine,
    JointKind::PointInPlane,
];
const WITHOUT_POINTS: usize = 7;

/// What drives a mechanism.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum DrivenBy {
    /// The angle or the travel of its first joint.
    Joint,
    /// The distance of two points.
    Length,
    /// A wheel, by teeth.
    Gear,
    /// A screw in a loop of screws alone.
    ScrewOfScrews,
    /// A joint of a loop with points on lines and in planes, such as the travel of a point on a line.
    JointOfPoints,
}

/// A mechanism assembled at a pose.
pub(super) struct Assembled {
    pub(super) mechanism: Mechanism,
    pub(super) placements: Vec<Placement>,
    pub(super) masses: Vec<Mass>,
    pub(super) q: f64,
    /// Angle and travel of the first joint at the pose.
    first: [f64; 2],
}

impl Assembled {
    pub(super) fn new(random: &mut Random, loops: usize, driven_by: DrivenBy) -> Self {
        let mut made = Self {
            mechanism: Mechanism {
                bodies: vec![Body::named("ground")],
                ground: 0,
                joints: Vec::new(),
                actuators: Vec::new(),
                couplings: Vec::new(),
            },
            placements: vec![Placement::default()],
            masses: vec![Mass::default()],
            q: 0.0,
            first: [0.0; 2],
        };
        // One of the joints with an angle or a travel is driven; the loop has one freedom in all.
        let driven = [
            JointKind::Revolute,
            JointKind::Prismatic,
            JointKind::Cylindrical,
            JointKind::Helical { pitch: -0.3 },
            JointKind::PointOnLine,
        ];
        let all = match driven_by {
            DrivenBy::JointOfPoints => &KINDS[..],
            _ => &KINDS[..WITHOUT_POINTS],
        };
        let driven = driven[random.below(driven.len() - usize::from(all.len() == WITHOUT_POINTS))];
        let mut kinds = vec![driven];
        match driven_by {
            DrivenBy::ScrewOfScrews => {
                let screw = |k| JointKind::Helical {
                    pitch: 0.17 * f64::from(k) - 0.5,
                };
                kinds = (0..7).map(screw).collect();
            }
            DrivenBy::Joint | DrivenBy::Length | DrivenBy::Gear | DrivenBy::JointOfPoints => {
                kinds.extend(random.kinds(7 - driven.freedoms(), all));
            }
        }
        made.chain(random, &kinds, [0, 0]);
        let [angle, along] = made.first;
        let is_travel = match kinds[0] {
            JointKind::Prismatic | JointKind::PointOnLine => true,
            JointKind::Helical { .. } => random.below(2) == 0,
            _ => false,
        };
        (made.q, made.mechanism.actuators) = match is_travel {
            true => (along, vec![Actuator::travel("q", 0)]),
            false => (angle, vec![Actuator::angle("q", 0)]),
        };
        match driven_by {
            DrivenBy::Joint | DrivenBy::ScrewOfScrews | DrivenBy::JointOfPoints => {}
            DrivenBy::Length => made.drive_length(random),
            DrivenBy::Gear => made.drive_gear(random),
        }
        for _ in 1..loops {
            let kinds = random.kinds(6, all);
            let from = 1 + random.below(made.mechanism.bodies.len() - 1);
            let to = (from + 1 + random.below(made.mechanism.bodies.len() - 1))
                % made.mechanism.bodies.len();
            made.chain(random, &kinds, [from, to]);
        }
        made
    }

    /// Adds a chain of joints, with bodies between them, from one body to another.
    fn chain(&mut self, random: &mut Random, kinds: &[JointKind], [from, to]: [usize; 2]) {
        let mut last = from;
        for (k, kind) in kinds.iter().enumerate() {
            let next = if k + 1 == kinds.len() {
                to
            } else {
                self.mechanism
                    .bodies
                    .push(Body::named(format!("body-{}", self.placements.len())));
                self.placements.push(random.placement());
                self.masses.push(random.mass());
                self.placements.len() - 1
            };
            self.join(random, *kind, [last, next]);
            last = next;
        }
    }

    /// A joint between two bodies where they are.
    fn join(&mut self, random: &mut Random, kind: JointKind, bodies: [usize; 2]) {
        let (point, axis) = (random.vector(), random.direction());
        let normal = axis
            .cross(random.direction())
            .unit()
            .unwrap_or_else(|| axis.any_normal());
        let (mut angle, mut along) = (2.0 * random.number(), 0.5 * random.number());
        match kind {
            JointKind::Prismatic | JointKind::Weld => angle = 0.0,
            JointKind::Helical { pitch } => along = pitch * angle,
            _ => {}
        }
        let slides = kind.has_travel();
        let across = axis.cross(normal);
        let moved = match kind {
            JointKind::Planar | JointKind::PointInPlane => {
                normal.scaled(along) + across.scaled(0.3 * random.number())
            }
            _ if slides => axis.scaled(along),
            _ => Vec3::ZERO,
        };
        let turned = normal.scaled(angle.cos()) + across.scaled(angle.sin());
        let (second_axis, second_normal) = match kind {
            // Of a point on a line or in a plane the second side has no directions.
            JointKind::Universal | JointKind::PointOnLine | JointKind::PointInPlane => {
                (turned, axis)
            }
            _ => (axis, turned),
        };
        if self.mechanism.joints.is_empty() {
            self.first = [angle, if slides { along } else { 0.0 }];
        }
        let sides = [
            self.side(bodies[0], point, [axis, normal]),
            self.side(bodies[1], point + moved, [second_axis, second_normal]),
        ];
        let name = format!("joint-{}", self.mechanism.joints.len());
        self.mechanism
            .joints
            .push(Joint::new(name, bodies, kind, sides));
    }

    /// A side by its point and directions in the ground's frame.
    fn side(&self, body: usize, point: Vec3, [axis, normal]: [Vec3; 2]) -> Side {
        let Placement { position, rotation } = self.placements[body];
        Side {
            point: rotation.apply_inverse(point - position),
            axis: rotation.apply_inverse(axis),
            normal: rotation.apply_inverse(normal),
        }
    }

    /// Drives the distance between points of the ground and of the body that the first joint moves, instead of that joint.
    fn drive_length(&mut self, random: &mut Random) {
        let ends = [random.vector(), random.vector()];
        let any = [vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0)];
        let sides = [self.side(0, ends[0], any), self.side(1, ends[1], any)];
        self.q = (ends[1] - ends[0]).norm();
        let rod = self.mechanism.joints.len();
        let kind = JointKind::Distance { length: 0.0 };
        self.mechanism
            .joints
            .push(Joint::new("rod", [0, 1], kind, sides));
        self.mechanism.actuators = vec![Actuator::length("q", rod)];
    }

    /// Drives a wheel on the ground whose teeth move the first joint's body.
    fn drive_gear(&mut self, random: &mut Random) {
        let first = self.mechanism.joints[0].sides[0];
        let [angle, along] = self.first;
        let arm = |side: &Side, p: Vec3, n: Vec3| side.axis.cross(p - side.point).dot(n);
        let (pitch, normal, bearing) = loop {
            let (p, n, axis) = (random.vector(), random.direction(), random.direction());
            let bearing = Side {
                point: random.vector(),
                axis,
                normal: axis.any_normal(),
            };
            if arm(&bearing, p, n).abs() > 0.2 {
                break (p, n, bearing);
            }
        };
        // The teeth travel as far on both wheels from where all angles and travels are zero.
        let travel = arm(&first, pitch, normal) * angle + first.axis.dot(normal) * along;
        self.q = travel / arm(&bearing, pitch, normal);
        let wheel = self.placements.len();
        self.mechanism.bodies.push(Body::named("wheel"));
        self.placements.push(random.placement());
        self.masses.push(random.mass());
        let across = bearing.axis.cross(bearing.normal);
        let turned = bearing.normal.scaled(self.q.cos()) + across.scaled(self.q.sin());
        let on_wheel = self.side(wheel, bearing.point, [bearing.axis, turned]);
        let teeth = Side {
            point: pitch,
            axis: normal,
            normal: normal.any_normal(),
        };
        let joints = &mut self.mechanism.joints;
        let sides = [bearing, on_wheel];
        joints.push(Joint::new(
            "bearing",
            [0, wheel],
            JointKind::Revolute,
            sides,
        ));
        let kind = JointKind::Gear { carrier: BodyId(0) };
        joints.push(Joint::new("teeth", [wheel, 1], kind, [teeth; 2]));
        self.mechanism.actuators = vec![Actuator::angle("q", self.mechanism.joints.len() - 2)];
    }

    /// Every component of every joint in the axes of the ground.
    pub(super) fn reactions(&self) -> Vec<Reaction> {
        let joints = 0..self.mechanism.joints.len();
        let components = |j: usize| {
            (0..6).map(move |k| Reaction {
                joint: dwell_geometry::JointId(j),
                component: match k {
                    0..3 => Component::Force(Axes::Ground, k),
                    _ => Component::Moment(Axes::Ground, k - 3),
                },
            })
        };
        joints.flat_map(components).collect()
    }
}
