//! Lowering: every joint as kinematic pairs (pins, slides and welds) and couplings between angles and travels, so that
//! the structure has no other kinds. Massless bodies are added as needed: a slot is a block that slides on one body and
//! is pinned to the other; a length is a line pinned to one point on which a block slides that is pinned to the other.

use crate::error::StructureError;
use crate::mechanism::{ActuatorId, BodyId, Coordinate, Coupling, JointId, JointKind, Mechanism};
use crate::plane::Vec2;
use dwell_laws::Law;
use std::collections::BTreeSet;

/// The joint or actuator that a pair or a coupling comes from, for messages.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Owner {
    /// A joint of the mechanism.
    Joint(JointId),
    /// An actuator that drives a length.
    Actuator(ActuatorId),
}

/// A pin, a slide or a weld between two bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KinematicPair<C = f64> {
    /// Its owner: a joint or an actuator of the mechanism.
    pub owner: Owner,
    /// The two bodies; an index beyond the mechanism's bodies is an added, massless one.
    pub bodies: [usize; 2],
    /// Its point on each body, in that body's frame, m.
    pub points: [Vec2<C>; 2],
    /// Its kind.
    pub kind: PairKind,
}

/// Which relative motion a kinematic pair allows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum PairKind {
    /// The points coincide.
    Revolute,
    /// The second body slides along an axis, given in each body's frame.
    Prismatic {
        /// Unit vector of the axis in each body's frame.
        axes: [Vec2; 2],
        /// Whether its travel is a coordinate that an actuator drives or a coupling names.
        travel_is_coordinate: bool,
        /// Whether its travel is a length: never negative.
        travel_is_length: bool,
    },
    /// The points coincide and the second body is turned from the first by (cos, sin).
    Rigid(Vec2),
}

/// A quantity that is linear in the unknowns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum LoweredCoordinate {
    /// The angle of a body's frame from the ground's, rad.
    Angle(usize),
    /// The travel of a slide, by pair, m.
    Travel(usize),
}

/// A sum of coordinates with factors.
pub(crate) type LinearTerms = Vec<(LoweredCoordinate, f64)>;

/// A coupling: Σ dependent − law(Σ independent) = constant.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LoweredCoupling {
    pub(crate) owner: Owner,
    pub(crate) dependent: LinearTerms,
    pub(crate) law: Option<(Law, LinearTerms)>,
    /// Whether the constant is the value of the sum at assembly (gears mesh as assembled); else it is zero.
    pub(crate) constant_from_assembly: bool,
    /// Whether the coupling is between angles, in rad, rather than between lengths, in m.
    pub(crate) angular: bool,
    /// A line of centres it names, the body that holds both centres, and the line's angle in it, rad.
    pub(crate) line_of_centres: Option<(usize, usize, f64)>,
}

impl LoweredCoupling {
    /// Σ dependent = 0, between lengths.
    fn linear(owner: Owner, dependent: LinearTerms) -> Self {
        Self {
            owner,
            dependent,
            law: None,
            constant_from_assembly: false,
            angular: false,
            line_of_centres: None,
        }
    }
}

/// The coordinate that an actuator drives, after lowering.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum ActuatedCoordinate {
    /// The angle of the second body from the first.
    Angle([usize; 2]),
    /// The travel of a slide, by pair.
    Travel(usize),
}

/// A mechanism in pins, slides, welds and couplings.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Lowered<C = f64> {
    /// Number of bodies: the mechanism's, then the added ones.
    pub(crate) bodies: usize,
    /// Number of the mechanism's bodies.
    pub(crate) mechanism_bodies: usize,
    pub(crate) ground: usize,
    pub(crate) pairs: Vec<KinematicPair<C>>,
    pub(crate) couplings: Vec<LoweredCoupling>,
    /// By actuator.
    pub(crate) actuated_coordinates: Vec<ActuatedCoordinate>,
    /// By joint: its first pair, and its coupling.
    pub(crate) joint_parts: Vec<(Option<usize>, Option<usize>)>,
}

impl PairKind {
    /// Whether its travel is a coordinate.
    pub(crate) fn counts_travel(self) -> bool {
        matches!(self, Self::Prismatic { travel_is_coordinate, .. } if travel_is_coordinate)
    }

    /// Whether its travel is a length.
    pub(crate) fn is_length(self) -> bool {
        matches!(self, Self::Prismatic { travel_is_length, .. } if travel_is_length)
    }
}

impl<C: Copy> KinematicPair<C> {
    /// Its point on one of its bodies, in that body's frame, m.
    pub(crate) fn point_on(&self, body: usize) -> Vec2<C> {
        self.points[usize::from(self.bodies[0] != body)]
    }
}

/// The x axis of an added body.
const X_AXIS: Vec2 = Vec2::IDENTITY;

impl Lowered {
    pub(crate) fn new(mechanism: &Mechanism) -> Self {
        let mut lowered = Self {
            bodies: mechanism.bodies.len(),
            mechanism_bodies: mechanism.bodies.len(),
            ground: mechanism.ground,
            pairs: Vec::with_capacity(mechanism.joints.len()),
            couplings: Vec::new(),
            actuated_coordinates: Vec::new(),
            joint_parts: Vec::with_capacity(mechanism.joints.len()),
        };
        // Joints first: a coupling or an actuator may name any of them.
        for j in 0..mechanism.joints.len() {
            let parts = lowered.lower_joint(mechanism, JointId(j));
            lowered.joint_parts.push(parts);
        }
        for (j, joint) in mechanism.joints.iter().enumerate() {
            if let JointKind::Coupling(r) = joint.kind
                && let Some(coupling) = mechanism.couplings.get(r)
            {
                lowered.joint_parts[j].1 = Some(lowered.couplings.len());
                lowered.lower_coupling(Owner::Joint(JointId(j)), coupling);
            }
        }
        for (i, actuator) in mechanism.actuators.iter().enumerate() {
            let owner = Owner::Actuator(ActuatorId(i));
            let coordinate = lowered.lower_coordinate(owner, actuator.coordinate());
            lowered.actuated_coordinates.push(coordinate);
        }
        lowered
    }

    /// Whether another mechanism consists of the same pairs and couplings, with points that may differ.
    pub(crate) fn differs_in_points_only(&self, other: &Self) -> bool {
        let same_pair = |(one, two): (&KinematicPair, &KinematicPair)| {
            let points = two.points;
            KinematicPair { points, ..*one } == *two
        };
        self.pairs.len() == other.pairs.len()
            && self.pairs.iter().zip(&other.pairs).all(same_pair)
            && (self.bodies, self.ground) == (other.bodies, other.ground)
            && self.couplings == other.couplings
            && self.actuated_coordinates == other.actuated_coordinates
    }

    /// The first kinematic pair of a joint, and its coupling.
    //
    // Long: a few lines for each kind of joint.
    fn lower_joint(
        &mut self,
        mechanism: &Mechanism,
        id: JointId,
    ) -> (Option<usize>, Option<usize>) {
        let joint = &mechanism.joints[id.0];
        let owner = Owner::Joint(id);
        let bodies = joint.bodies.map(|b| b.0);
        let points = joint.points;
        let first = self.pairs.len();
        let first_coupling = self.couplings.len();
        match joint.kind {
            JointKind::Revolute => self.add_pin(owner, bodies, points),
            JointKind::Weld { angle } => {
                let kind = PairKind::Rigid(Vec2::from_angle(angle));
                self.add_pair(owner, bodies, points, kind);
            }
            JointKind::Prismatic { axes } => self.add_pair(owner, bodies, points, prismatic(axes)),
            JointKind::Slot { axis } => self.add_slot(owner, bodies, points, axis),
            JointKind::Distance { length } => {
                let line = self.add_body();
                let end = X_AXIS * length;
                self.add_pin(owner, [bodies[0], line], [points[0], Vec2::ZERO]);
                self.add_pin(owner, [line, bodies[1]], [end, points[1]]);
            }
            JointKind::Gear { radii, internal } => {
                let (_, line) = self.add_line(owner, bodies, points, false);
                let one = if internal { -radii[0] } else { radii[0] };
                let dependent = vec![
                    (LoweredCoordinate::Angle(bodies[0]), one),
                    (LoweredCoordinate::Angle(bodies[1]), radii[1]),
                    (LoweredCoordinate::Angle(line), -(one + radii[1])),
                ];
                let carrier = carrier(mechanism, id, radii[0] + radii[1]);
                self.couplings.push(LoweredCoupling {
                    constant_from_assembly: true,
                    line_of_centres: carrier.map(|(body, phase)| (line, body, phase)),
                    ..LoweredCoupling::linear(owner, dependent)
                });
            }
            JointKind::Rack { axis, radius } => {
                // The pinion's centre slides along the rack on a block, and across it on another.
                let along = self.add_body();
                let across = self.add_body();
                let on_rack = [points[0], Vec2::ZERO];
                let on_axis = prismatic([axis, X_AXIS]);
                self.add_pair(owner, [bodies[0], along], on_rack, on_axis);
                self.make_travel_coordinate(first);
                let normal = [X_AXIS.perp(), X_AXIS.perp()];
                let origin = [Vec2::ZERO; 2];
                self.add_pair(owner, [along, across], origin, prismatic(normal));
                // A coordinate of its own, so that the loop closes as a vector.
                self.make_travel_coordinate(first + 1);
                self.add_pin(owner, [across, bodies[1]], [Vec2::ZERO, points[1]]);
                self.add_rolling_coupling(owner, first, bodies, radius);
            }
            JointKind::Rolling { axis, radius } => {
                let raised = points[0] + axis.perp() * radius;
                self.add_slot(owner, bodies, [raised, points[1]], axis);
                self.make_travel_coordinate(first);
                self.add_rolling_coupling(owner, first, bodies, radius);
            }
            JointKind::Coupling(_) => return (None, None),
        }
        let has_coupling = self.couplings.len() > first_coupling;
        (Some(first), has_coupling.then_some(first_coupling))
    }

    fn lower_coupling(&mut self, owner: Owner, coupling: &Coupling) {
        let dependent = self.linear_terms(owner, coupling.dependent);
        let independent = self.linear_terms(owner, coupling.independent);
        self.couplings.push(LoweredCoupling {
            law: Some((coupling.law.clone(), independent)),
            angular: coupling.dependent.is_angle(),
            ..LoweredCoupling::linear(owner, dependent)
        });
    }

    /// A coordinate as an angle between bodies, or as the travel of a pair.
    fn lower_coordinate(&mut self, owner: Owner, coordinate: Coordinate) -> ActuatedCoordinate {
        match coordinate {
            Coordinate::Angle(bodies) => ActuatedCoordinate::Angle(bodies.map(|b| b.0)),
            Coordinate::Travel(joint) => ActuatedCoordinate::Travel(self.travel_pair(joint)),
            Coordinate::Length { bodies, points } => {
                let (pair, _) = self.add_line(owner, bodies.map(|b| b.0), points, true);
                ActuatedCoordinate::Travel(pair)
            }
        }
    }

    /// A coordinate as a sum of lowered coordinates.
    fn linear_terms(&mut self, owner: Owner, coordinate: Coordinate) -> LinearTerms {
        match self.lower_coordinate(owner, coordinate) {
            ActuatedCoordinate::Angle([first, second]) => vec![
                (LoweredCoordinate::Angle(second), 1.0),
                (LoweredCoordinate::Angle(first), -1.0),
            ],
            ActuatedCoordinate::Travel(pair) => vec![(LoweredCoordinate::Travel(pair), 1.0)],
        }
    }

    fn add_body(&mut self) -> usize {
        self.bodies += 1;
        self.bodies - 1
    }

    fn add_pair(&mut self, owner: Owner, bodies: [usize; 2], points: [Vec2; 2], kind: PairKind) {
        self.pairs.push(KinematicPair {
            owner,
            bodies,
            points,
            kind,
        });
    }

    fn add_pin(&mut self, owner: Owner, bodies: [usize; 2], points: [Vec2; 2]) {
        self.add_pair(owner, bodies, points, PairKind::Revolute);
    }

    /// A block on the first body, pinned to the second.
    fn add_slot(&mut self, owner: Owner, bodies: [usize; 2], points: [Vec2; 2], axis: Vec2) {
        let block = self.add_body();
        let (on_first, on_axis) = ([points[0], Vec2::ZERO], prismatic([axis, X_AXIS]));
        self.add_pair(owner, [bodies[0], block], on_first, on_axis);
        self.add_pin(owner, [block, bodies[1]], [Vec2::ZERO, points[1]]);
    }

    /// A line from a point of the first body through one of the second: its slide and its body.
    fn add_line(
        &mut self,
        owner: Owner,
        bodies: [usize; 2],
        points: [Vec2; 2],
        travel_is_coordinate: bool,
    ) -> (usize, usize) {
        let line = self.add_body();
        let block = self.add_body();
        self.add_pin(owner, [bodies[0], line], [points[0], Vec2::ZERO]);
        let pair = self.pairs.len();
        let kind = PairKind::Prismatic {
            axes: [X_AXIS, X_AXIS],
            travel_is_coordinate,
            travel_is_length: true,
        };
        self.add_pair(owner, [line, block], [Vec2::ZERO; 2], kind);
        self.add_pin(owner, [block, bodies[1]], [Vec2::ZERO, points[1]]);
        (pair, line)
    }

    /// Travel + r (θ₂ − θ₁) = 0.
    fn add_rolling_coupling(&mut self, owner: Owner, pair: usize, bodies: [usize; 2], radius: f64) {
        let dependent = vec![
            (LoweredCoordinate::Travel(pair), 1.0),
            (LoweredCoordinate::Angle(bodies[1]), radius),
            (LoweredCoordinate::Angle(bodies[0]), -radius),
        ];
        self.couplings
            .push(LoweredCoupling::linear(owner, dependent));
    }

    /// Declares the travel of a pair a coordinate.
    fn make_travel_coordinate(&mut self, pair: usize) {
        if let PairKind::Prismatic {
            travel_is_coordinate,
            ..
        } = &mut self.pairs[pair].kind
        {
            *travel_is_coordinate = true;
        }
    }

    /// The slide of a joint whose travel is a coordinate.
    fn travel_pair(&mut self, joint: JointId) -> usize {
        let pair = self.joint_parts.get(joint.0).and_then(|parts| parts.0);
        // `check` has refused joints without travel.
        let pair = pair.unwrap_or(0);
        self.make_travel_coordinate(pair);
        pair
    }

    /// The mechanism's bodies among some.
    pub(crate) fn mechanism_bodies(&self, bodies: impl IntoIterator<Item = usize>) -> Vec<BodyId> {
        let named = bodies.into_iter().filter(|&b| b < self.mechanism_bodies);
        let named: BTreeSet<_> = named.map(BodyId).collect();
        named.into_iter().collect()
    }

    /// The joints and the actuators among some owners.
    pub(crate) fn owners(
        owners: impl IntoIterator<Item = Owner>,
    ) -> (Vec<JointId>, Vec<ActuatorId>) {
        let (mut joints, mut actuators) = (BTreeSet::new(), BTreeSet::new());
        for owner in owners {
            match owner {
                Owner::Joint(joint) => joints.insert(joint),
                Owner::Actuator(actuator) => actuators.insert(actuator),
            };
        }
        (
            joints.into_iter().collect(),
            actuators.into_iter().collect(),
        )
    }

    /// The error of equations too many, by the owner of each.
    pub(crate) fn over_constrained(redundant: &[Owner]) -> StructureError {
        let (joints, actuators) = Self::owners(redundant.iter().copied());
        StructureError::OverConstrained {
            redundant_count: redundant.len(),
            joints,
            actuators,
        }
    }
}

/// The body that holds the centres of both gears, in pins and welds, and the angle of the line from
/// the first to the second in it, rad.
fn carrier(mechanism: &Mechanism, gears: JointId, radii: f64) -> Option<(usize, f64)> {
    let tolerance = SAME_CENTRE * radii;
    let joint = &mechanism.joints[gears.0];
    let holders = |gear: usize| {
        let mut found = vec![(joint.bodies[gear].0, joint.points[gear])];
        let mut next = 0;
        while let Some(&(body, point)) = found.get(next) {
            next += 1;
            for other in &mechanism.joints {
                if !other.kind.holds_points_together() {
                    continue;
                }
                for (one, two) in [(0, 1), (1, 0)] {
                    let other_body = other.bodies[two].0;
                    if other.bodies[one].0 == body
                        && (other.points[one] - point).norm() <= tolerance
                        && found.iter().all(|(b, _)| *b != other_body)
                    {
                        found.push((other_body, other.points[two]));
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

/// Two points of a body are one centre within this part of the radii: only the counting of revolutions
/// depends on it.
const SAME_CENTRE: f64 = 1e-6;

fn prismatic(axes: [Vec2; 2]) -> PairKind {
    PairKind::Prismatic {
        axes,
        travel_is_coordinate: false,
        travel_is_length: false,
    }
}
