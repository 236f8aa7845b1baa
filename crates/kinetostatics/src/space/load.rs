//! Loads in space: shapes, each times a magnitude.

use dwell_geometry::BodyId;
use dwell_geometry::space::{Plan, Pose, Vec3, Wrench};
use dwell_numerics::Scalar;

/// A direction in the axes of the ground or of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Direction {
    /// In those of the ground.
    Ground(Vec3),
    /// In those of the body that the load acts on.
    Body(Vec3),
}

/// How a load acts; its magnitude multiplies what is described here.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum LoadKind {
    /// On every mass, along this direction of the ground, N/kg.
    Gravity(Vec3),
    /// A force at a point (m in the body's frame), N.
    Force {
        /// The body.
        body: BodyId,
        /// Its point.
        point: Vec3,
        /// The direction.
        direction: Direction,
    },
    /// A torque on the second body, the opposite on the first, about a direction of the first or the ground, N·m.
    Torque {
        /// The bodies.
        bodies: [BodyId; 2],
        /// The direction.
        direction: Direction,
    },
    /// A force that pushes two points (m in the frames of the bodies) apart, N.
    PointToPointForce {
        /// The bodies.
        bodies: [BodyId; 2],
        /// Their points.
        points: [Vec3; 2],
    },
}

impl LoadKind {
    /// The potential energy of a unit of the load at a pose, J; none of one that has no potential.
    pub(super) fn potential(
        &self,
        plan: &Plan,
        pose: &Pose,
        masses: &[super::Mass],
    ) -> Option<f64> {
        match *self {
            Self::Gravity(direction) => {
                let weights = masses.iter().enumerate().map(|(body, mass)| {
                    let center = plan.frame(pose, body).point(mass.center);
                    -mass.mass * center.dot(direction)
                });
                Some(weights.sum())
            }
            Self::Force {
                body: BodyId(body),
                point,
                direction: Direction::Ground(direction),
            } => Some(-plan.point(pose, body, point).dot(direction)),
            Self::Force { .. } | Self::Torque { .. } | Self::PointToPointForce { .. } => None,
        }
    }

    /// Whether it has a potential.
    pub fn is_conservative(&self) -> bool {
        matches!(
            self,
            Self::Gravity(_)
                | Self::Force {
                    direction: Direction::Ground(_),
                    ..
                }
        )
    }

    /// Takes the load, with its magnitude, off what the bodies require.
    pub(super) fn subtract<T: Scalar>(
        &self,
        magnitude: f64,
        plan: &Plan,
        pose: &Pose<T>,
        masses: &[super::Mass],
        required: &mut [[Wrench<T>; 1]],
    ) {
        let arm = |body: usize, point: Vec3| {
            let local = plan
                .evaluation_frame(body)
                .rotation
                .apply_inverse(point - plan.evaluation_frame(body).position);
            plan.frame(pose, body).rotation.apply(local.cast())
        };
        let turned = |body: usize, direction: Direction| match direction {
            Direction::Ground(u) => u.scaled(magnitude).cast(),
            Direction::Body(u) => {
                let from_origin = u.scaled(magnitude) + plan.evaluation_frame(body).position;
                arm(body, from_origin)
            }
        };
        match *self {
            Self::Gravity(direction) => {
                for (body, mass) in masses.iter().enumerate() {
                    let at = plan.frame(pose, body).rotation.apply(mass.center.cast());
                    required[body][0].add_at(
                        at,
                        (-direction.scaled(magnitude * mass.mass)).cast(),
                        Vec3::zero(),
                    );
                }
            }
            Self::Force {
                body: BodyId(body),
                point,
                direction,
            } => {
                required[body][0].add_at(arm(body, point), -turned(body, direction), Vec3::zero());
            }
            Self::Torque {
                bodies: [a, b],
                direction,
            } => {
                let couple = turned(a.0, direction);
                required[b.0][0].moment -= couple;
                required[a.0][0].moment += couple;
            }
            Self::PointToPointForce { bodies, points } => {
                let [a, b] = [0, 1].map(|k| arm(bodies[k].0, points[k]));
                let [from, to] = bodies.map(|body| plan.frame(pose, body.0).origin);
                let d = to + b - (from + a);
                let along = d.scaled(T::from_f64(magnitude) / d.dot(d).sqrt());
                required[bodies[0].0][0].add_at(a, along, Vec3::zero());
                required[bodies[1].0][0].add_at(b, -along, Vec3::zero());
            }
        }
    }
}
