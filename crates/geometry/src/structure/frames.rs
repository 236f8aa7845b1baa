//! Which bodies have a common orientation. Bodies joined by a prismatic joint keep their angle to one another;
//! an angular actuator prescribes it. So orientations need fewer unknowns than there are bodies: one per
//! *class* of bodies whose relative angles are known once the actuators' coordinates are.

use crate::error::StructureError;
use crate::mechanism::ActuatorId;
use crate::plane::Vec2;
use crate::structure::lower::{ActuatedCoordinate, KinematicPair, Lowered, Owner, PairKind};
use std::collections::HashSet;

/// The source of the rotation of a frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum RotationSource {
    /// The ground's frame: it does not rotate.
    Ground,
    /// The first frame of a class: its angle is an unknown.
    Unknown,
    /// Rotated from another frame by an actuator's coordinate, times `sign`.
    Actuated {
        /// The frame it is turned from (a smaller index).
        parent: usize,
        /// The actuator whose coordinate turns it.
        actuator: usize,
        /// +1 or −1.
        sign: f64,
    },
}

/// A frame: an orientation that one or more bodies share, up to constant offsets.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// The source of its rotation.
    pub rotation_source: RotationSource,
    /// Its class; class 0 is the ground's, where every angle is known.
    pub orientation_class: usize,
}

/// Orientation of a body: its frame's rotation times a constant one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Orientation {
    /// Index of the frame.
    pub frame: usize,
    /// Constant rotation (cos, sin) from the frame to the body.
    pub offset: Vec2,
    /// The angle of that rotation, rad: found once, for every evaluation adds it.
    pub offset_angle: f64,
}

impl Orientation {
    fn new(frame: usize, offset: Vec2) -> Self {
        Self {
            frame,
            offset,
            offset_angle: offset.angle(),
        }
    }
}

/// The constraint that fixes the angle between two bodies of one class.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum AngularConstraintSource {
    /// A slide or a weld, by its moment: index of the pair.
    Pair(usize),
    /// An angular actuator, by its moment.
    Actuator(ActuatorId),
}

/// A body whose angle to another one is fixed or prescribed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AngularConstraint {
    /// The body.
    pub body: usize,
    /// The other body, which comes earlier.
    pub reference_body: usize,
    /// The constraint that fixes or prescribes the angle.
    pub source: AngularConstraintSource,
    /// Whether `body` is the first-named of the two.
    pub body_is_first: bool,
}

/// The orientations of all bodies.
#[derive(Debug, Clone, PartialEq)]
pub struct Frames {
    /// All frames; frame 0 is the ground's, an actuated frame comes after the one it is turned from.
    pub frames: Vec<Frame>,
    /// Each body's orientation, by body.
    pub orientations: Vec<Orientation>,
    /// The angular constraints, outwards from each class's first body.
    pub angular_constraints: Vec<AngularConstraint>,
    /// Pairs that fix an angle which others fix already: their moments are not determinate.
    pub redundant_pairs: Vec<usize>,
    /// Number of classes, the ground's included.
    pub orientation_classes: usize,
    /// The bodies of each class.
    pub class_bodies: Vec<Vec<usize>>,
}

/// Two chains of axes give one angle to this rounding, rad.
const SAME_ANGLE: f64 = 1e-9;

impl Frames {
    /// Finds the frames and classes of a mechanism.
    ///
    /// # Errors
    /// [`StructureError::OverConstrained`] when a slide, a weld or an actuator fixes an angle
    /// that others fix already, unless it is a slide or a weld that fixes the same angle.
    pub(crate) fn find(lowered: &Lowered) -> Result<Self, StructureError> {
        let (n, neighbours) = (lowered.bodies, angular_neighbours(lowered));
        let mut found = Self::of_ground(n);
        let mut reached = vec![false; n];
        let (mut visited, mut conflicting) = (HashSet::new(), Vec::new());
        for first_body in std::iter::once(lowered.ground).chain(0..n) {
            if std::mem::replace(&mut reached[first_body], true) {
                continue;
            }
            if first_body != lowered.ground {
                found.orientations[first_body].frame = found.frames.len();
                found.frames.push(Frame {
                    rotation_source: RotationSource::Unknown,
                    orientation_class: found.orientation_classes,
                });
                found.orientation_classes += 1;
            }
            let mut queue = vec![first_body];
            while let Some(body) = queue.pop() {
                for &(other, source, other_is_first) in &neighbours[body] {
                    if !visited.insert(source) {
                        continue;
                    }
                    let constraint = AngularConstraint {
                        body: other,
                        reference_body: body,
                        source,
                        body_is_first: other_is_first,
                    };
                    if std::mem::replace(&mut reached[other], true) {
                        conflicting.extend(found.add_redundant(lowered, constraint));
                        continue;
                    }
                    found.orientations[other] = found.constrained_orientation(lowered, constraint);
                    found.angular_constraints.push(constraint);
                    queue.push(other);
                }
            }
        }
        if !conflicting.is_empty() {
            return Err(Lowered::over_constrained(&conflicting));
        }
        found.class_bodies = vec![Vec::new(); found.orientation_classes];
        for (body, orientation) in found.orientations.iter().enumerate() {
            found.class_bodies[found.frames[orientation.frame].orientation_class].push(body);
        }
        Ok(found)
    }

    /// The actuators that turn a frame from the first one of its class, each with its sign, from the last one on.
    pub fn turned_by(&self, mut frame: usize) -> impl Iterator<Item = (usize, f64)> {
        std::iter::from_fn(move || match self.frames[frame].rotation_source {
            RotationSource::Ground | RotationSource::Unknown => None,
            RotationSource::Actuated {
                parent,
                actuator,
                sign,
            } => {
                frame = parent;
                Some((actuator, sign))
            }
        })
    }

    /// All bodies in the ground's frame.
    fn of_ground(bodies: usize) -> Self {
        let ground_orientation = Orientation::new(0, Vec2::IDENTITY);
        Self {
            frames: vec![Frame {
                rotation_source: RotationSource::Ground,
                orientation_class: 0,
            }],
            orientations: vec![ground_orientation; bodies],
            angular_constraints: Vec::new(),
            redundant_pairs: Vec::new(),
            orientation_classes: 1,
            class_bodies: Vec::new(),
        }
    }

    /// The orientation of a body by its constraint to one whose orientation is known.
    fn constrained_orientation(
        &mut self,
        lowered: &Lowered,
        constraint: AngularConstraint,
    ) -> Orientation {
        let reference = self.orientations[constraint.reference_body];
        let is_first = constraint.body_is_first;
        match constraint.source {
            AngularConstraintSource::Pair(b) => Orientation::new(
                reference.frame,
                offset_across(&lowered.pairs[b], reference.offset, is_first),
            ),
            AngularConstraintSource::Actuator(a) => {
                let class = self.frames[reference.frame].orientation_class;
                self.frames.push(Frame {
                    rotation_source: RotationSource::Actuated {
                        parent: reference.frame,
                        actuator: a.0,
                        sign: if is_first { -1.0 } else { 1.0 },
                    },
                    orientation_class: class,
                });
                Orientation::new(self.frames.len() - 1, reference.offset)
            }
        }
    }

    /// Notes a constraint between two bodies whose angle is fixed already; returns its owner if it contradicts others.
    fn add_redundant(&mut self, lowered: &Lowered, constraint: AngularConstraint) -> Option<Owner> {
        let reference = self.orientations[constraint.reference_body];
        let orientation = self.orientations[constraint.body];
        if let AngularConstraintSource::Pair(b) = constraint.source
            && reference.frame == orientation.frame
        {
            let is_first = constraint.body_is_first;
            let required = offset_across(&lowered.pairs[b], reference.offset, is_first);
            if (required - orientation.offset).norm() < SAME_ANGLE {
                self.redundant_pairs.push(b);
                return None;
            }
        }
        Some(match constraint.source {
            AngularConstraintSource::Pair(b) => lowered.pairs[b].owner,
            AngularConstraintSource::Actuator(a) => Owner::Actuator(a),
        })
    }
}

/// By body: each body whose angle from it is fixed or prescribed, by what, and whether that body is the first-named.
fn angular_neighbours(lowered: &Lowered) -> Vec<Vec<(usize, AngularConstraintSource, bool)>> {
    let mut neighbours = vec![Vec::new(); lowered.bodies];
    let mut connect = |bodies: [usize; 2], source: AngularConstraintSource| {
        neighbours[bodies[0]].push((bodies[1], source, false));
        neighbours[bodies[1]].push((bodies[0], source, true));
    };
    for (i, coordinate) in lowered.actuated_coordinates.iter().enumerate() {
        if let ActuatedCoordinate::Angle(bodies) = *coordinate {
            connect(bodies, AngularConstraintSource::Actuator(ActuatorId(i)));
        }
    }
    for (b, pair) in lowered.pairs.iter().enumerate() {
        if pair.kind != PairKind::Revolute {
            connect(pair.bodies, AngularConstraintSource::Pair(b));
        }
    }
    neighbours
}

/// The constant rotation of the other body of a pair, from that of one of them.
fn offset_across(pair: &KinematicPair, offset: Vec2, other_is_first: bool) -> Vec2 {
    match pair.kind {
        PairKind::Revolute => offset,
        // Both axes point the same way: θ₁ + α₁ = θ₂ + α₂.
        PairKind::Prismatic { axes, .. } => {
            let (other, axis) = if other_is_first {
                (axes[0], axes[1])
            } else {
                (axes[1], axes[0])
            };
            offset.rotate(axis).rotate_inverse(other)
        }
        PairKind::Rigid(angle) if other_is_first => offset.rotate_inverse(angle),
        PairKind::Rigid(angle) => offset.rotate(angle),
    }
}
