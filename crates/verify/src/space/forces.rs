//! The forces of loads on bodies in space, from their positions and motions.

use super::joints::Sides;
use crate::placed_load::{Line, LineKind, PlacedLoad};
use crate::wrenches::BodyWrench;
use dwell_geometry::BodyId;
use dwell_geometry::space::{BodyMotion, Coordinate, Joint, Mechanism, Placement, Vec3};
use dwell_kinetostatics::space::{DirectedCouple, Direction, LoadKind, Mass};

/// The forces of loads of some magnitudes on bodies.
pub fn load_wrenches(
    (mechanism, masses, placements): (&Mechanism, &[Mass], &[Placement]),
    motions: &[BodyMotion],
    loads: &[(LoadKind, f64)],
) -> Vec<BodyWrench> {
    let bodies = SpaceBodies {
        mechanism,
        masses,
        placements,
        motions,
    };
    let wrenches = loads
        .iter()
        .map(|(kind, magnitude)| bodies.placed(kind).wrenches(*magnitude));
    wrenches.flatten().collect()
}

/// The bodies of a mechanism in space.
pub(super) struct SpaceBodies<'a> {
    pub(super) mechanism: &'a Mechanism,
    pub(super) masses: &'a [Mass],
    pub(super) placements: &'a [Placement],
    pub(super) motions: &'a [BodyMotion],
}

impl SpaceBodies<'_> {
    /// The axis of a joint, of its first body.
    fn axis(&self, joint: &Joint) -> Vec3 {
        let first = &self.placements[joint.bodies[0].0];
        first.rotation.apply(joint.sides[0].axis)
    }

    fn point(&self, body: BodyId, point: Vec3) -> Vec3 {
        let placement = &self.placements[body.0];
        placement.position + placement.rotation.apply(point)
    }

    fn velocity(&self, body: BodyId, point: Vec3) -> Vec3 {
        let (placement, motion) = (&self.placements[body.0], &self.motions[body.0]);
        motion.velocity + (motion.angular_velocity).cross(placement.rotation.apply(point))
    }

    /// About the axis of a joint; the angle is without whole revolutions.
    fn turn(&self, joint: &Joint) -> Line {
        let [w, v] = joint.bodies.map(|b| self.motions[b.0].angular_velocity);
        let axis = self.axis(joint);
        Line {
            bodies: joint.bodies,
            points: [Vec3::ZERO; 2],
            along: axis,
            kind: LineKind::Angle {
                counts_turns: false,
            },
            value: Sides::of(joint, self.placements).angle(),
            rate: axis.dot(v - w),
        }
    }

    /// Along the axis of a joint, at the second body's point.
    fn slide(&self, joint: &Joint) -> Line {
        let ([a, b], axis) = (joint.bodies, self.axis(joint));
        let [from, to] = [0, 1].map(|k| self.point(joint.bodies[k], joint.sides[k].point));
        // The rate along the axis, seen from the first body.
        let first = &self.motions[a.0];
        let seen_from =
            first.velocity + (first.angular_velocity).cross(to - self.placements[a.0].position);
        let velocity = self.velocity(b, joint.sides[1].point) - seen_from;
        Line {
            bodies: joint.bodies,
            points: [to; 2],
            along: axis,
            kind: LineKind::Travel,
            value: axis.dot(to - from),
            rate: axis.dot(velocity),
        }
    }

    fn between(&self, bodies: [BodyId; 2], points: [Vec3; 2]) -> Line {
        let [from, to] = [0, 1].map(|k| self.point(bodies[k], points[k]));
        let [v, w] = [0, 1].map(|k| self.velocity(bodies[k], points[k]));
        let along = (to - from).scaled(1.0 / (to - from).norm());
        Line {
            bodies,
            points: [from, to],
            along,
            kind: LineKind::Distance,
            value: (to - from).norm(),
            rate: along.dot(w - v),
        }
    }

    /// A load where the bodies are.
    pub(super) fn placed(&self, kind: &LoadKind) -> PlacedLoad {
        let turned = |body: BodyId, direction: Direction| match direction {
            Direction::Ground(vector) => vector,
            Direction::Body(vector) => self.placements[body.0].rotation.apply(vector),
        };
        match *kind {
            LoadKind::Gravity { direction } => {
                let placed = |(b, mass): (usize, &Mass)| {
                    (BodyId(b), mass.mass, self.point(BodyId(b), mass.center))
                };
                let bodies = self.masses.iter().enumerate().map(placed);
                PlacedLoad::Weight(direction, bodies.collect())
            }
            LoadKind::Force {
                body,
                point,
                direction,
            } => PlacedLoad::Force {
                body,
                point: self.point(body, point),
                direction: turned(body, direction),
                turns: matches!(direction, Direction::Body(_)),
            },
            LoadKind::Drag { body, point } => PlacedLoad::Drag {
                body,
                point: self.point(body, point),
                velocity: self.velocity(body, point),
            },
            LoadKind::Along(along, law) => {
                let line = match along {
                    Coordinate::Angle(joint) => self.turn(&self.mechanism.joints[joint.0]),
                    Coordinate::Travel(joint) => self.slide(&self.mechanism.joints[joint.0]),
                    Coordinate::Distance { bodies, points } => self.between(bodies, points),
                };
                PlacedLoad::Along(line, law)
            }
            LoadKind::Special(DirectedCouple { bodies, direction }) => {
                let couple = turned(bodies[0], direction);
                let pair = BodyWrench::pair(bodies, Vec3::ZERO, Vec3::ZERO, couple);
                PlacedLoad::Given(pair.into())
            }
        }
    }
}
