//! Every joint as pins, slides and welds, and relations between angles and travels: the few things
//! that the structure is made of. What a joint needs for that is added as massless bodies: a slot is
//! a block that slides on one body and is pinned to the other; a length is a line pinned to one
//! point on which a block slides that is pinned to the other.

use crate::mechanism::{
    ActuatorId, BodyId, Coordinate, Drive, JointId, JointKind, Mechanism, Relation,
};
use crate::plane::Vec2;
use dwell_laws::Law;

/// What a bond, or a row of a relation, comes from: whom a message names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Owner {
    /// A joint of the mechanism.
    Joint(JointId),
    /// An actuator that drives a length.
    Actuator(ActuatorId),
}

/// A pin, a slide or a weld between two bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bond {
    /// What it comes from.
    pub owner: Owner,
    /// The two bodies; an index beyond the mechanism's bodies is an added, massless one.
    pub bodies: [usize; 2],
    /// Its point on each body, in that body's frame, m.
    pub points: [Vec2; 2],
    /// What it lets move.
    pub tie: Tie,
}

/// What a bond lets move.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Tie {
    /// The points coincide.
    Pin,
    /// The second body slides along an axis, given in each body's frame.
    Slide {
        /// Unit vector of the axis in each body's frame.
        axes: [Vec2; 2],
        /// Whether its travel is a coordinate that something drives or relates.
        measured: bool,
        /// Whether its travel is a length: never negative.
        length: bool,
    },
    /// The points coincide and the second body is turned from the first by (cos, sin).
    Weld(Vec2),
}

/// A quantity that is linear in the unknowns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Measure {
    /// The angle of a body's frame from the ground's, rad.
    Angle(usize),
    /// The travel of a slide, by bond, m.
    Travel(usize),
}

/// A sum of measures with factors.
pub(crate) type Sum = Vec<(Measure, f64)>;

/// A relation: Σ of − law(Σ by) = constant.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Ratio {
    pub(crate) owner: Owner,
    pub(crate) of: Sum,
    pub(crate) law: Option<(Law, Sum)>,
    /// Whether the constant is what the sum is at the start (gears mesh as assembled), else zero.
    pub(crate) as_assembled: bool,
    /// Whether the relation is between angles, in rad, rather than between lengths, in m.
    pub(crate) angular: bool,
    /// A line of centres it names, the body that holds both centres, and the line's angle in it, rad.
    pub(crate) line: Option<(usize, usize, f64)>,
}

/// What an actuator drives.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Driven {
    /// The angle of the second body from the first.
    Angle([usize; 2]),
    /// The travel of a slide, by bond.
    Travel(usize),
}

/// A mechanism in pins, slides, welds and relations.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Lowered {
    /// Number of bodies: the mechanism's, then the added ones.
    pub(crate) bodies: usize,
    /// Number of the mechanism's bodies.
    pub(crate) named: usize,
    pub(crate) ground: usize,
    pub(crate) bonds: Vec<Bond>,
    pub(crate) ratios: Vec<Ratio>,
    /// By actuator.
    pub(crate) drives: Vec<Driven>,
    /// By joint: its first bond, and its relation.
    pub(crate) of_joint: Vec<(Option<usize>, Option<usize>)>,
}

/// The x axis of an added body.
const ALONG: Vec2 = Vec2::IDENTITY;

impl Lowered {
    pub(crate) fn new(mechanism: &Mechanism) -> Self {
        let mut lowered = Self {
            bodies: mechanism.bodies.len(),
            named: mechanism.bodies.len(),
            ground: mechanism.ground,
            bonds: Vec::with_capacity(mechanism.joints.len()),
            ratios: Vec::new(),
            drives: Vec::new(),
            of_joint: Vec::with_capacity(mechanism.joints.len()),
        };
        // Joints first: a relation or an actuator may name any of them.
        for j in 0..mechanism.joints.len() {
            let parts = lowered.joint(mechanism, JointId(j));
            lowered.of_joint.push(parts);
        }
        for (j, joint) in mechanism.joints.iter().enumerate() {
            if let JointKind::Relation(r) = joint.kind
                && let Some(relation) = mechanism.relations.get(r)
            {
                let ratio = lowered.relation(JointId(j), relation);
                lowered.of_joint[j].1 = Some(ratio);
            }
        }
        for (i, actuator) in mechanism.actuators.iter().enumerate() {
            let owner = Owner::Actuator(ActuatorId(i));
            let bodies = actuator.bodies.map(|b| b.0);
            let drive = match actuator.drive {
                Drive::Angle => Driven::Angle(bodies),
                Drive::Travel(joint) => Driven::Travel(lowered.measured(joint)),
                Drive::Length(points) => {
                    let (bond, _) = lowered.line(owner, bodies, points, true);
                    Driven::Travel(bond)
                }
            };
            lowered.drives.push(drive);
        }
        lowered
    }

    /// The bonds and the relation of a joint: the first of each.
    fn joint(&mut self, mechanism: &Mechanism, id: JointId) -> (Option<usize>, Option<usize>) {
        let joint = &mechanism.joints[id.0];
        let owner = Owner::Joint(id);
        let bodies = joint.bodies.map(|b| b.0);
        let points = joint.points;
        let first = self.bonds.len();
        let ratio = self.ratios.len();
        match joint.kind {
            JointKind::Revolute => self.bond(owner, bodies, points, Tie::Pin),
            JointKind::Weld { angle } => {
                self.bond(owner, bodies, points, Tie::Weld(Vec2::from_angle(angle)));
            }
            JointKind::Prismatic { axes } => self.bond(owner, bodies, points, slide(axes)),
            JointKind::Slot { axis } => self.slot(owner, bodies, points, axis),
            JointKind::Distance { length } => {
                let line = self.body();
                let end = ALONG * length;
                self.bond(owner, [bodies[0], line], [points[0], Vec2::ZERO], Tie::Pin);
                self.bond(owner, [line, bodies[1]], [end, points[1]], Tie::Pin);
            }
            JointKind::Gear { radii, internal } => {
                let (_, line) = self.line(owner, bodies, points, false);
                let one = if internal { -radii[0] } else { radii[0] };
                let of = vec![
                    (Measure::Angle(bodies[0]), one),
                    (Measure::Angle(bodies[1]), radii[1]),
                    (Measure::Angle(line), -(one + radii[1])),
                ];
                self.ratio(owner, of, true);
                let carrier = carrier(mechanism, id, radii[0] + radii[1]);
                if let Some(ratio) = self.ratios.last_mut() {
                    ratio.line = carrier.map(|(carrier, lead)| (line, carrier, lead));
                }
            }
            JointKind::Rack { axis, radius } => {
                // The pinion's centre slides along the rack on a block, and across it on another.
                let along = self.body();
                let across = self.body();
                let frame = [axis, ALONG];
                self.bond(
                    owner,
                    [bodies[0], along],
                    [points[0], Vec2::ZERO],
                    slide(frame),
                );
                self.measure(first);
                let normal = [ALONG.perp(), ALONG.perp()];
                let origin = [Vec2::ZERO; 2];
                self.bond(owner, [along, across], origin, slide(normal));
                // A coordinate of its own, so that the loop closes as a vector.
                self.measure(first + 1);
                self.bond(
                    owner,
                    [across, bodies[1]],
                    [Vec2::ZERO, points[1]],
                    Tie::Pin,
                );
                self.rolls(owner, first, bodies, radius);
            }
            JointKind::Rolling { axis, radius } => {
                let raised = points[0] + axis.perp() * radius;
                self.slot(owner, bodies, [raised, points[1]], axis);
                self.measure(first);
                self.rolls(owner, first, bodies, radius);
            }
            JointKind::Relation(_) => return (None, None),
        }
        (Some(first), (self.ratios.len() > ratio).then_some(ratio))
    }

    fn relation(&mut self, joint: JointId, relation: &Relation) -> usize {
        let owner = Owner::Joint(joint);
        let of = self.sum(owner, relation.of);
        let by = self.sum(owner, relation.by);
        self.ratios.push(Ratio {
            owner,
            of,
            law: Some((relation.law.clone(), by)),
            as_assembled: false,
            angular: relation.of.is_angle(),
            line: None,
        });
        self.ratios.len() - 1
    }

    /// A coordinate as a sum of measures.
    fn sum(&mut self, owner: Owner, coordinate: Coordinate) -> Sum {
        match coordinate {
            Coordinate::Angle([first, second]) => vec![
                (Measure::Angle(second.0), 1.0),
                (Measure::Angle(first.0), -1.0),
            ],
            Coordinate::Travel(joint) => vec![(Measure::Travel(self.measured(joint)), 1.0)],
            Coordinate::Length { bodies, points } => {
                let (bond, _) = self.line(owner, bodies.map(|b| b.0), points, true);
                vec![(Measure::Travel(bond), 1.0)]
            }
        }
    }

    fn body(&mut self) -> usize {
        self.bodies += 1;
        self.bodies - 1
    }

    fn bond(&mut self, owner: Owner, bodies: [usize; 2], points: [Vec2; 2], tie: Tie) {
        self.bonds.push(Bond {
            owner,
            bodies,
            points,
            tie,
        });
    }

    /// A block on the first body, pinned to the second.
    fn slot(&mut self, owner: Owner, bodies: [usize; 2], points: [Vec2; 2], axis: Vec2) {
        let block = self.body();
        let on_first = [points[0], Vec2::ZERO];
        self.bond(owner, [bodies[0], block], on_first, slide([axis, ALONG]));
        self.bond(owner, [block, bodies[1]], [Vec2::ZERO, points[1]], Tie::Pin);
    }

    /// A line from a point of the first body through one of the second: its slide and its body.
    fn line(
        &mut self,
        owner: Owner,
        bodies: [usize; 2],
        points: [Vec2; 2],
        measured: bool,
    ) -> (usize, usize) {
        let line = self.body();
        let block = self.body();
        self.bond(owner, [bodies[0], line], [points[0], Vec2::ZERO], Tie::Pin);
        let bond = self.bonds.len();
        let tie = Tie::Slide {
            axes: [ALONG, ALONG],
            measured,
            length: true,
        };
        self.bond(owner, [line, block], [Vec2::ZERO; 2], tie);
        self.bond(owner, [block, bodies[1]], [Vec2::ZERO, points[1]], Tie::Pin);
        (bond, line)
    }

    fn ratio(&mut self, owner: Owner, of: Sum, as_assembled: bool) {
        self.ratios.push(Ratio {
            owner,
            of,
            law: None,
            as_assembled,
            angular: false,
            line: None,
        });
    }

    /// Travel + r (θ₂ − θ₁) = 0.
    fn rolls(&mut self, owner: Owner, bond: usize, bodies: [usize; 2], radius: f64) {
        let of = vec![
            (Measure::Travel(bond), 1.0),
            (Measure::Angle(bodies[1]), radius),
            (Measure::Angle(bodies[0]), -radius),
        ];
        self.ratio(owner, of, false);
    }

    /// Makes the travel of a bond a coordinate.
    fn measure(&mut self, bond: usize) {
        if let Tie::Slide { measured, .. } = &mut self.bonds[bond].tie {
            *measured = true;
        }
    }

    /// The slide of a joint whose travel is a coordinate.
    fn measured(&mut self, joint: JointId) -> usize {
        let bond = self.of_joint.get(joint.0).and_then(|parts| parts.0);
        // `check` has refused joints without travel.
        let bond = bond.unwrap_or(0);
        self.measure(bond);
        bond
    }

    /// The mechanism's bodies among some.
    pub(crate) fn named(&self, bodies: impl IntoIterator<Item = usize>) -> Vec<BodyId> {
        let mut named: Vec<_> = bodies
            .into_iter()
            .filter(|&b| b < self.named)
            .map(BodyId)
            .collect();
        named.sort_unstable();
        named.dedup();
        named
    }

    /// The joints and the actuators among some owners.
    pub(crate) fn owners(
        owners: impl IntoIterator<Item = Owner>,
    ) -> (Vec<JointId>, Vec<ActuatorId>) {
        let (mut joints, mut actuators) = (Vec::new(), Vec::new());
        for owner in owners {
            match owner {
                Owner::Joint(joint) => joints.push(joint),
                Owner::Actuator(actuator) => actuators.push(actuator),
            }
        }
        joints.sort_unstable();
        joints.dedup();
        actuators.sort_unstable();
        actuators.dedup();
        (joints, actuators)
    }
}

/// The body that holds the centres of both gears, in pins and welds, and the angle of the line from
/// the first to the second in it, rad.
fn carrier(mechanism: &Mechanism, gears: JointId, radii: f64) -> Option<(usize, f64)> {
    let near = SAME_CENTRE * radii;
    let joint = &mechanism.joints[gears.0];
    let holders = |end: usize| {
        let mut found = vec![(joint.bodies[end].0, joint.points[end])];
        let mut next = 0;
        while let Some(&(body, point)) = found.get(next) {
            next += 1;
            for other in &mechanism.joints {
                if !matches!(other.kind, JointKind::Revolute | JointKind::Weld { .. }) {
                    continue;
                }
                for (one, two) in [(0, 1), (1, 0)] {
                    let there = other.bodies[two].0;
                    if other.bodies[one].0 == body
                        && (other.points[one] - point).norm() <= near
                        && found.iter().all(|(b, _)| *b != there)
                    {
                        found.push((there, other.points[two]));
                    }
                }
            }
        }
        found
    };
    let seconds = holders(1);
    holders(0).into_iter().find_map(|(body, first)| {
        let (_, second) = seconds.iter().find(|(b, _)| *b == body)?;
        Some((body, (*second - first).angle()))
    })
}

/// Two points of a body are one centre within this part of the radii: only the count of turns
/// hangs on it.
const SAME_CENTRE: f64 = 1e-6;

fn slide(axes: [Vec2; 2]) -> Tie {
    Tie::Slide {
        axes,
        measured: false,
        length: false,
    }
}
