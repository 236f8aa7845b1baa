//! The forces of joints and actuators at points, and couples: from the definitions of
//! [`Component`](dwell_geometry::Component) and the positions of the bodies, never from the rows.

use crate::body_motion::{BodyMotion, slide_axis};
use crate::constraint_closing::Configuration;
use crate::dense::{DenseBody, DenseMechanism};
use dwell_geometry::{BodyId, Coordinate, Joint, JointKind, Mechanism, Vec2, vec2};

/// The force of a load on one body. A load between two bodies has two of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BodyWrench {
    /// The body.
    pub body: BodyId,
    /// The force, N, in the plane's directions.
    pub force: Vec2,
    /// The point of the plane where it acts, m.
    pub point: Vec2,
    /// The couple, N·m.
    pub couple: f64,
}

impl BodyWrench {
    /// Moment about a point.
    pub(crate) fn moment(&self, about: Vec2) -> f64 {
        (self.point - about).cross(self.force) + self.couple
    }

    /// Moment about a point with its terms taken as absolute values: what rounding is relative to.
    pub(crate) fn moment_terms(&self, about: Vec2) -> f64 {
        (self.point - about).norm() * self.force.norm() + self.couple.abs()
    }

    /// A force at a point and a couple on the second body, and their opposites on the first.
    pub(crate) fn pair(
        [first, second]: [BodyId; 2],
        force: Vec2,
        point: Vec2,
        couple: f64,
    ) -> [Self; 2] {
        [(first, -force, -couple), (second, force, couple)].map(|(body, force, couple)| Self {
            body,
            force,
            point,
            couple,
        })
    }
}

/// A sum of wrenches: x, y and the moment about a point.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct NetWrench {
    pub(crate) sum: [f64; 3],
    /// Sums of absolute forces, twice, and of absolute moments.
    pub(crate) terms: [f64; 3],
}

impl NetWrench {
    pub(crate) fn of<'a>(wrenches: impl Iterator<Item = &'a BodyWrench>, about: Vec2) -> Self {
        let mut net = Self::default();
        wrenches.for_each(|wrench| net.add(wrench, about));
        net
    }

    pub(crate) fn add(&mut self, wrench: &BodyWrench, about: Vec2) {
        self.sum[0] += wrench.force.x;
        self.sum[1] += wrench.force.y;
        self.sum[2] += wrench.moment(about);
        self.terms[0] += wrench.force.norm();
        self.terms[1] += wrench.force.norm();
        self.terms[2] += wrench.moment_terms(about);
    }
}

/// Gathers forces in pairs: that of the first body on the second, and the opposite on the first.
struct ActionReaction<'a> {
    mechanism: &'a Mechanism,
    motion: BodyMotion<'a>,
    wrenches: Vec<BodyWrench>,
}

impl ActionReaction<'_> {
    fn add(&mut self, bodies: [BodyId; 2], force: Vec2, at: Vec2, couple: f64) {
        self.wrenches
            .extend(BodyWrench::pair(bodies, force, at, couple));
    }

    // Long: an arm for each kind of joint. Without a value is what the mechanism does not have.
    fn joint(&mut self, joint: &Joint, reaction: &[f64]) -> Option<()> {
        let bodies = joint.bodies;
        let [first, second] = self.motion.points(bodies, joint.points)?;
        let rotation = self.motion.rotation(bodies[0])?;
        let axis_in_plane = |axis: Vec2| axis.rotate(rotation);
        let (force, point, moment) = match (joint.kind, reaction) {
            (JointKind::Revolute, &[x, y]) => (vec2(x, y), second, 0.0),
            (JointKind::Weld { .. }, &[x, y, moment]) => (vec2(x, y), second, moment),
            (JointKind::Prismatic { axes }, &[normal, moment]) => {
                (axis_in_plane(axes[0]).perp() * normal, second, moment)
            }
            (JointKind::Slot { axis }, &[normal]) => {
                (axis_in_plane(axis).perp() * normal, second, 0.0)
            }
            (JointKind::Gear { radii, internal }, &[tooth]) => {
                // The pitch point is a radius from both centres: between them, or beyond the
                // centre of the smaller one of an internal pair.
                let line = unit(second - first);
                let beyond = internal && radii[0] > radii[1];
                let outwards = if beyond { line } else { -line };
                // Rotates the second gear counter-clockwise.
                let force = outwards.perp() * tooth;
                (force, second + outwards * radii[1], 0.0)
            }
            (JointKind::Rack { axis, radius }, &[tooth]) => {
                let t = axis_in_plane(axis);
                (t * tooth, second - t.perp() * radius, 0.0)
            }
            (JointKind::Rolling { axis, radius }, &[normal, tangent]) => {
                let (t, n) = (axis_in_plane(axis), axis_in_plane(axis).perp());
                (n * normal + t * tangent, second - n * radius, 0.0)
            }
            (JointKind::Distance { .. }, &[axial]) => (unit(second - first) * axial, second, 0.0),
            (JointKind::Coupling(r), &[generalised_force]) => {
                let relation = self.mechanism.couplings.get(r)?;
                // No work is lost: what the law gives to one coordinate it takes from the other.
                let independent = relation.independent;
                let [value, _] = self.motion.coordinate(self.mechanism, independent)?;
                let slope = relation.law.eval(value)[1];
                self.force_along(relation.dependent, generalised_force)?;
                return self.force_along(independent, -slope * generalised_force);
            }
            // The reactions are not those of the mechanism: another check has refused it.
            (
                JointKind::Revolute
                | JointKind::Weld { .. }
                | JointKind::Prismatic { .. }
                | JointKind::Slot { .. }
                | JointKind::Gear { .. }
                | JointKind::Rack { .. }
                | JointKind::Rolling { .. }
                | JointKind::Distance { .. }
                | JointKind::Coupling(_),
                _,
            ) => return None,
        };
        self.add(bodies, force, point, moment);
        Some(())
    }

    /// A force along a coordinate, of its first body on its second: it does positive work when
    /// the coordinate grows.
    fn force_along(&mut self, coordinate: Coordinate, generalised_force: f64) -> Option<()> {
        let (bodies, points, axis) = match coordinate {
            Coordinate::Angle(bodies) => {
                self.add(bodies, Vec2::ZERO, Vec2::ZERO, generalised_force);
                return Some(());
            }
            Coordinate::Travel(joint) => {
                let joint = self.mechanism.joints.get(joint.0)?;
                (joint.bodies, joint.points, Some(slide_axis(joint.kind)?))
            }
            Coordinate::Length { bodies, points } => (bodies, points, None),
        };
        let [first, second] = self.motion.points(bodies, points)?;
        let line = match axis {
            Some(axis) => self.motion.direction(bodies[0], axis)?,
            None => unit(second - first),
        };
        self.add(bodies, line * generalised_force, second, 0.0);
        Some(())
    }
}

fn unit(v: Vec2) -> Vec2 {
    v * (1.0 / v.norm())
}

impl DenseMechanism {
    /// Forces on bodies at points of the plane, with their points from the ground's moved origin.
    pub(crate) fn shifted_wrenches(&self, wrenches: &[BodyWrench]) -> Vec<BodyWrench> {
        let ground = self.bodies[self.mechanism.ground].shift;
        let shifted = wrenches.iter().map(|wrench| BodyWrench {
            // A pure couple acts nowhere, and its point, wherever it was put, must not cost digits.
            point: match wrench.force {
                Vec2::ZERO => Vec2::ZERO,
                _ => wrench.point - ground,
            },
            ..*wrench
        });
        shifted.collect()
    }

    /// Adds `sign` times forces on bodies, at points from the ground's moved origin, to the forces of the coordinates `x`.
    pub(crate) fn add_wrenches<'w>(
        &self,
        x: &[f64],
        wrenches: impl IntoIterator<Item = &'w BodyWrench>,
        sign: f64,
        forces: &mut [f64],
    ) {
        for wrench in wrenches {
            if let Some(c) = self.bodies[wrench.body.0].column {
                forces[c] += sign * wrench.force.x;
                forces[c + 1] += sign * wrench.force.y;
                forces[c + 2] += sign * wrench.moment(vec2(x[c], x[c + 1]));
            }
        }
    }

    /// All forces of joints and actuators on bodies, the ground among them, at points from the ground's moved origin.
    pub(crate) fn joint_wrenches(
        &self,
        at: &Configuration,
        reactions: &[f64],
        tau: &[f64],
    ) -> Vec<BodyWrench> {
        let pose = |body: &DenseBody| {
            body.column
                .map_or([0.0; 3], |c| [0, 1, 2].map(|i| at.x[c + i]))
        };
        let poses: Vec<[f64; 3]> = self.bodies.iter().map(pose).collect();
        let mut pairs = ActionReaction {
            mechanism: &self.mechanism,
            // Forces do not depend on velocities.
            motion: BodyMotion {
                poses: &poses,
                velocities: &vec![[0.0; 3]; poses.len()],
            },
            wrenches: Vec::new(),
        };
        let mut remaining = reactions;
        for joint in &self.mechanism.joints {
            let rows = joint.kind.components(&self.mechanism.couplings).len();
            let (of_joint, others) = remaining.split_at(rows.min(remaining.len()));
            pairs.joint(joint, of_joint);
            remaining = others;
        }
        for (actuator, &tau) in self.mechanism.actuators.iter().zip(tau) {
            pairs.force_along(actuator.coordinate(), tau);
        }
        pairs.wrenches
    }
}
