//! The forces of joints and actuators at points, and couples: from the definitions of
//! [`Component`](dwell_geometry::Component) and the positions of the bodies, never from the rows.

use crate::body_motion::slide_axis;
use crate::constraint_closing::Configuration;
use crate::dense::DenseMechanism;
use dwell_geometry::{BodyId, Coordinate, Joint, JointId, JointKind, Vec2, vec2};

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

/// One force on one body at a point of the plane, and a couple.
#[derive(Debug, Clone, Copy)]
pub(crate) struct DenseWrench {
    pub(crate) body: usize,
    pub(crate) force: Vec2,
    /// From the ground's moved origin.
    pub(crate) point: Vec2,
    pub(crate) couple: f64,
}

impl DenseWrench {
    /// Moment about a point.
    pub(crate) fn moment(&self, about: Vec2) -> f64 {
        (self.point - about).cross(self.force) + self.couple
    }

    /// Moment about a point with its terms taken as absolute values: what rounding is relative to.
    pub(crate) fn moment_terms(&self, about: Vec2) -> f64 {
        (self.point - about).norm() * self.force.norm() + self.couple.abs()
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
    pub(crate) fn of<'a>(wrenches: impl Iterator<Item = &'a DenseWrench>, about: Vec2) -> Self {
        let mut net = Self::default();
        wrenches.for_each(|wrench| net.add(wrench, about));
        net
    }

    pub(crate) fn add(&mut self, wrench: &DenseWrench, about: Vec2) {
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
    dense: &'a DenseMechanism,
    at: &'a Configuration,
    wrenches: Vec<DenseWrench>,
}

/// A joint's two points and its first body's rotation, in the plane.
struct JointGeometry {
    bodies: [BodyId; 2],
    points: [Vec2; 2],
    rotation: Vec2,
}

impl ActionReaction<'_> {
    fn add(&mut self, bodies: [BodyId; 2], force: Vec2, at: Vec2, couple: f64) {
        for (body, sign) in bodies.into_iter().zip([-1.0, 1.0]) {
            self.wrenches.push(DenseWrench {
                body: body.0,
                force: force * sign,
                point: at,
                couple: couple * sign,
            });
        }
    }

    fn force(&mut self, geometry: &JointGeometry, force: Vec2, at: Vec2) {
        self.add(geometry.bodies, force, at, 0.0);
    }

    fn couple(&mut self, bodies: [BodyId; 2], couple: f64) {
        self.add(bodies, Vec2::ZERO, Vec2::ZERO, couple);
    }

    fn joint_geometry(&self, bodies: [BodyId; 2], points: [Vec2; 2]) -> JointGeometry {
        let of = |i: usize| &self.dense.bodies[bodies[i].0];
        let column = of(0).column;
        JointGeometry {
            bodies,
            points: [0, 1].map(|i| self.dense.frame_point(of(i), &self.at.x, points[i])),
            rotation: column.map_or(Vec2::IDENTITY, |c| Vec2::from_angle(self.at.x[c + 2])),
        }
    }

    // Long: an arm for each kind of joint.
    fn joint(&mut self, joint: &Joint, reaction: &[f64]) {
        let geometry = self.joint_geometry(joint.bodies, joint.points);
        let [first, second] = geometry.points;
        let axis_in_plane = |axis: Vec2| axis.rotate(geometry.rotation);
        match (joint.kind, reaction) {
            (JointKind::Revolute, &[x, y]) => self.force(&geometry, vec2(x, y), second),
            (JointKind::Weld { .. }, &[x, y, moment]) => {
                self.add(joint.bodies, vec2(x, y), second, moment);
            }
            (JointKind::Prismatic { axes }, &[normal, moment]) => {
                let n = axis_in_plane(axes[0]).perp();
                self.add(joint.bodies, n * normal, second, moment);
            }
            (JointKind::Slot { axis }, &[normal]) => {
                self.force(&geometry, axis_in_plane(axis).perp() * normal, second);
            }
            (JointKind::Gear { radii, internal }, &[tooth]) => {
                // The pitch point is a radius from both centres: between them, or beyond the
                // centre of the smaller one of an internal pair.
                let line = unit(second - first);
                let outwards = if internal && radii[0] > radii[1] {
                    line
                } else {
                    -line
                };
                // Rotates the second gear counter-clockwise.
                let force = outwards.perp() * tooth;
                self.force(&geometry, force, second + outwards * radii[1]);
            }
            (JointKind::Rack { axis, radius }, &[tooth]) => {
                let t = axis_in_plane(axis);
                self.force(&geometry, t * tooth, second - t.perp() * radius);
            }
            (JointKind::Rolling { axis, radius }, &[normal, tangent]) => {
                let (t, n) = (axis_in_plane(axis), axis_in_plane(axis).perp());
                self.force(&geometry, n * normal + t * tangent, second - n * radius);
            }
            (JointKind::Distance { .. }, &[axial]) => {
                self.force(&geometry, unit(second - first) * axial, second);
            }
            (JointKind::Coupling(r), &[generalised_force]) => {
                let Some(relation) = self.dense.mechanism.couplings.get(r) else {
                    return;
                };
                // No work is lost: what the law gives to one coordinate it takes from the other.
                let value = self.coordinate_value(relation.independent);
                let slope = relation.law.eval(value)[1];
                self.force_along(relation.dependent, generalised_force);
                self.force_along(relation.independent, -slope * generalised_force);
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
            ) => {}
        }
    }

    /// The joint that a travel belongs to, and its axis in the first body.
    fn slide_axis(&self, joint: JointId) -> Option<(JointGeometry, Vec2)> {
        let joint = self.dense.mechanism.joints.get(joint.0)?;
        let axis = slide_axis(joint.kind)?;
        let geometry = self.joint_geometry(joint.bodies, joint.points);
        let axis = axis.rotate(geometry.rotation);
        Some((geometry, axis))
    }

    /// A force along a coordinate, of its first body on its second: it does positive work when
    /// the coordinate grows.
    fn force_along(&mut self, coordinate: Coordinate, generalised_force: f64) {
        match coordinate {
            Coordinate::Angle(bodies) => self.couple(bodies, generalised_force),
            Coordinate::Travel(joint) => {
                if let Some((geometry, axis)) = self.slide_axis(joint) {
                    self.force(&geometry, axis * generalised_force, geometry.points[1]);
                }
            }
            Coordinate::Length { bodies, points } => {
                let geometry = self.joint_geometry(bodies, points);
                let line = unit(geometry.points[1] - geometry.points[0]);
                self.force(&geometry, line * generalised_force, geometry.points[1]);
            }
        }
    }

    fn coordinate_value(&self, coordinate: Coordinate) -> f64 {
        let angle = |b: BodyId| {
            let column = self.dense.bodies[b.0].column;
            column.map_or(0.0, |c| self.at.x[c + 2])
        };
        match coordinate {
            Coordinate::Angle([first, second]) => angle(second) - angle(first),
            Coordinate::Travel(joint) => self.slide_axis(joint).map_or(0.0, |(geometry, axis)| {
                axis.dot(geometry.points[1] - geometry.points[0])
            }),
            Coordinate::Length { bodies, points } => {
                let [first, second] = self.joint_geometry(bodies, points).points;
                (second - first).norm()
            }
        }
    }
}

fn unit(v: Vec2) -> Vec2 {
    v * (1.0 / v.norm())
}

impl DenseMechanism {
    /// All forces of joints and actuators on bodies, the ground among them.
    pub(crate) fn joint_wrenches(
        &self,
        at: &Configuration,
        reactions: &[f64],
        tau: &[f64],
    ) -> Vec<DenseWrench> {
        let mut pairs = ActionReaction {
            dense: self,
            at,
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
