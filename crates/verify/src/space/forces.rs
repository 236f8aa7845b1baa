//! What loads do to the bodies, from the definitions of [`LoadKind`] and the positions and motions of the bodies.

use super::joints::Sides;
use crate::wrenches::BodyWrench;
use dwell_geometry::space::{BodyMotion, Mechanism, Placement, Vec3};
use dwell_geometry::{BodyId, JointId};
use dwell_kinetostatics::space::{Direction, LoadKind, Mass};

/// The forces of loads of some magnitudes on bodies.
pub fn load_wrenches(
    (mechanism, masses, placements): (&Mechanism, &[Mass], &[Placement]),
    motions: &[BodyMotion],
    loads: &[(LoadKind, f64)],
) -> Vec<BodyWrench> {
    let bodies = Bodies {
        mechanism,
        masses,
        placements,
        motions,
    };
    loads
        .iter()
        .flat_map(|load| bodies.wrenches(load))
        .collect()
}

/// The bodies in a pass.
struct Bodies<'a> {
    mechanism: &'a Mechanism,
    masses: &'a [Mass],
    placements: &'a [Placement],
    motions: &'a [BodyMotion],
}

impl Bodies<'_> {
    // Long because it has one arm for each kind of load.
    fn wrenches(&self, (kind, magnitude): &(LoadKind, f64)) -> Vec<BodyWrench> {
        let f = *magnitude;
        let turned = |body: usize, direction: Direction| match direction {
            Direction::Ground(u) => u,
            Direction::Body(u) => self.turned(body, u),
        };
        match *kind {
            LoadKind::Gravity(u) => {
                let weight = |(body, mass): (usize, &Mass)| {
                    self.force(BodyId(body), mass.center, u.scaled(f * mass.mass))
                };
                self.masses.iter().enumerate().map(weight).collect()
            }
            LoadKind::Force {
                body,
                point,
                direction,
            } => vec![self.force(body, point, turned(body.0, direction).scaled(f))],
            LoadKind::Torque {
                bodies: [a, b],
                direction,
            } => {
                let couple = turned(a.0, direction).scaled(f);
                BodyWrench::pair([a, b], Vec3::ZERO, Vec3::ZERO, couple).into()
            }
            LoadKind::PointToPointForce { bodies, points } => {
                let d = self.gap(bodies, points);
                self.push_apart(bodies, points, d.scaled(f / d.norm()))
            }
            LoadKind::Spring {
                bodies,
                points,
                free_length,
            } => {
                let d = self.gap(bodies, points);
                let tension = f * (d.norm() - free_length);
                self.push_apart(bodies, points, d.scaled(-tension / d.norm()))
            }
            LoadKind::Damper { bodies, points } => {
                let d = self.gap(bodies, points);
                let [from, to] = [0, 1].map(|k| self.velocity(bodies[k], points[k]));
                let line = d.scaled(1.0 / d.norm());
                self.push_apart(bodies, points, line.scaled(-f * line.dot(to - from)))
            }
            LoadKind::JointTorque(joint) => self.turn(joint, f),
            LoadKind::TorsionSpring { joint, free_angle } => {
                let sides = Sides::of(&self.mechanism.joints[joint.0], self.placements);
                // Without whole revolutions.
                self.turn(joint, -f * (sides.angle() - free_angle))
            }
            LoadKind::RotationalDamper(joint) => {
                let of = &self.mechanism.joints[joint.0];
                let [w, v] = of.bodies.map(|b| self.motions[b.0].angular_velocity);
                let rate = self.axis(joint).dot(v - w);
                self.turn(joint, -f * rate)
            }
            LoadKind::SlideForce(joint) => self.slide(joint, f),
            LoadKind::SlideDamper(joint) => {
                let of = &self.mechanism.joints[joint.0];
                let [a, b] = of.bodies;
                let second = self.point(b, of.sides[1].point);
                // The rate along the axis, seen from the first body.
                let first = &self.motions[a.0];
                let of_first = first.velocity
                    + (first.angular_velocity).cross(second - self.placements[a.0].position);
                let seen = self.velocity(b, of.sides[1].point) - of_first;
                self.slide(joint, -f * self.axis(joint).dot(seen))
            }
        }
    }

    fn turned(&self, body: usize, v: Vec3) -> Vec3 {
        self.placements[body].rotation.apply(v)
    }

    fn point(&self, body: BodyId, point: Vec3) -> Vec3 {
        self.placements[body.0].position + self.turned(body.0, point)
    }

    fn velocity(&self, body: BodyId, point: Vec3) -> Vec3 {
        let motion = &self.motions[body.0];
        motion.velocity + motion.angular_velocity.cross(self.turned(body.0, point))
    }

    /// The vector from a point of a body to that of another.
    fn gap(&self, bodies: [BodyId; 2], points: [Vec3; 2]) -> Vec3 {
        self.point(bodies[1], points[1]) - self.point(bodies[0], points[0])
    }

    /// The axis of a joint, of its first body.
    fn axis(&self, joint: JointId) -> Vec3 {
        let joint = &self.mechanism.joints[joint.0];
        self.turned(joint.bodies[0].0, joint.sides[0].axis)
    }

    fn force(&self, body: BodyId, point: Vec3, force: Vec3) -> BodyWrench {
        BodyWrench {
            body,
            force,
            point: self.point(body, point),
            couple: Vec3::ZERO,
        }
    }

    /// A force on the second point, and its reaction on the first.
    fn push_apart(&self, bodies: [BodyId; 2], points: [Vec3; 2], force: Vec3) -> Vec<BodyWrench> {
        let both = [-force, force].into_iter().enumerate();
        both.map(|(k, force)| self.force(bodies[k], points[k], force))
            .collect()
    }

    /// A couple on a joint's second body about the axis, and its reaction on the first.
    fn turn(&self, joint: JointId, couple: f64) -> Vec<BodyWrench> {
        let bodies = self.mechanism.joints[joint.0].bodies;
        let couple = self.axis(joint).scaled(couple);
        BodyWrench::pair(bodies, Vec3::ZERO, Vec3::ZERO, couple).into()
    }

    /// A force on a joint's second body along the axis at that body's point, and its reaction on the first there.
    fn slide(&self, joint: JointId, force: f64) -> Vec<BodyWrench> {
        let of = &self.mechanism.joints[joint.0];
        let at = self.point(of.bodies[1], of.sides[1].point);
        let force = self.axis(joint).scaled(force);
        BodyWrench::pair(of.bodies, force, at, Vec3::ZERO).into()
    }
}
