//! What bodies require in a motion, and what loads do to them.

use super::rows::{Bodies, Sides};
use dwell_geometry::space::{Vec3, Wrench};
use dwell_geometry::{BodyId, JointId};
use dwell_kinetostatics::space::{Direction, LoadKind, Mass};

impl Bodies<'_> {
    /// M ẍ + h less the loads, about the origins of the frames.
    pub(super) fn required(&self, masses: &[Mass], loads: &[(LoadKind, f64)]) -> Vec<Wrench> {
        let mut required = vec![Wrench::default(); self.placements.len()];
        for (body, mass) in masses.iter().enumerate() {
            let motion = &self.motions[body];
            let c = self.arm(body, mass.center);
            let w = motion.angular_velocity;
            let force =
                (motion.acceleration + motion.angular_acceleration.cross(c) + w.cross(w.cross(c)))
                    .scaled(mass.mass);
            let tensor = |v: Vec3| {
                let rotation = &self.placements[body].rotation;
                rotation.apply(mass.angular_momentum(rotation.apply_inverse(v)))
            };
            let couple = tensor(motion.angular_acceleration) + w.cross(tensor(w));
            required[body].add_at(c, force, couple);
        }
        for (kind, magnitude) in loads {
            self.subtract_load(kind, *magnitude, masses, &mut required);
        }
        required
    }

    /// What a load does to the bodies, about the origins of their frames.
    pub(super) fn load_wrenches(
        &self,
        (kind, magnitude): &(LoadKind, f64),
        masses: &[Mass],
    ) -> Vec<Wrench> {
        let mut wrenches = vec![Wrench::default(); self.placements.len()];
        self.subtract_load(kind, -magnitude, masses, &mut wrenches);
        wrenches
    }

    // Long because it has one arm for each kind of load.
    fn subtract_load(&self, kind: &LoadKind, f: f64, masses: &[Mass], required: &mut [Wrench]) {
        let turned = |body: usize, direction: Direction| match direction {
            Direction::Ground(u) => u,
            Direction::Body(u) => self.arm(body, u),
        };
        match *kind {
            LoadKind::Gravity(u) => {
                for (body, mass) in masses.iter().enumerate() {
                    let weight = u.scaled(-f * mass.mass);
                    required[body].add_at(self.arm(body, mass.center), weight, Vec3::ZERO);
                }
            }
            LoadKind::Force {
                body,
                point,
                direction,
            } => {
                let force = turned(body.0, direction).scaled(-f);
                required[body.0].add_at(self.arm(body.0, point), force, Vec3::ZERO);
            }
            LoadKind::Torque {
                bodies: [a, b],
                direction,
            } => {
                let couple = turned(a.0, direction).scaled(f);
                required[a.0].moment += couple;
                required[b.0].moment -= couple;
            }
            LoadKind::PointToPointForce { bodies, points } => {
                let d = self.gap(bodies, points);
                self.pull_together(bodies, points, -d.scaled(f / d.norm()), required);
            }
            LoadKind::Spring {
                bodies,
                points,
                free_length,
            } => {
                let d = self.gap(bodies, points);
                let tension = f * (d.norm() - free_length);
                self.pull_together(bodies, points, d.scaled(tension / d.norm()), required);
            }
            LoadKind::Damper { bodies, points } => {
                let d = self.gap(bodies, points);
                let [from, to] = [0, 1].map(|k| self.point_velocity(bodies[k].0, points[k]));
                let tension = f * d.dot(to - from) / d.norm();
                self.pull_together(bodies, points, d.scaled(tension / d.norm()), required);
            }
            LoadKind::JointTorque(joint) => self.turn(joint, f, required),
            LoadKind::TorsionSpring { joint, free_angle } => {
                let sides = Sides::of(&self.mechanism.joints[joint.0], self.placements);
                // Without whole revolutions.
                self.turn(joint, -f * (sides.angle() - free_angle), required);
            }
            LoadKind::RotationalDamper(joint) => {
                let of = &self.mechanism.joints[joint.0];
                let [w, v] = of.bodies.map(|b| self.motions[b.0].angular_velocity);
                let rate = self.arm(of.bodies[0].0, of.sides[0].axis).dot(v - w);
                self.turn(joint, -f * rate, required);
            }
            LoadKind::SlideForce(joint) => self.slide(joint, f, required),
            LoadKind::SlideDamper(joint) => {
                let of = &self.mechanism.joints[joint.0];
                let [a, b] = of.bodies;
                let u = self.arm(a.0, of.sides[0].axis);
                let q = self.point(b.0, of.sides[1].point);
                // The rate along the axis, seen from the first body.
                let of_first = self.motions[a.0].velocity
                    + (self.motions[a.0].angular_velocity).cross(q - self.point(a.0, Vec3::ZERO));
                let seen = self.point_velocity(b.0, of.sides[1].point) - of_first;
                self.slide(joint, -f * u.dot(seen), required);
            }
        }
    }

    /// The vector from a point of a body to that of another.
    fn gap(&self, bodies: [BodyId; 2], points: [Vec3; 2]) -> Vec3 {
        self.point(bodies[1].0, points[1]) - self.point(bodies[0].0, points[0])
    }

    /// The velocity of a point of a body.
    fn point_velocity(&self, body: usize, point: Vec3) -> Vec3 {
        let motion = &self.motions[body];
        motion.velocity + motion.angular_velocity.cross(self.arm(body, point))
    }

    /// Takes off a tension, along the vector from the first point to the second.
    fn pull_together(
        &self,
        bodies: [BodyId; 2],
        points: [Vec3; 2],
        tension: Vec3,
        required: &mut [Wrench],
    ) {
        for (k, force) in [-tension, tension].into_iter().enumerate() {
            let body = bodies[k].0;
            required[body].add_at(self.arm(body, points[k]), force, Vec3::ZERO);
        }
    }

    /// Takes off a couple on a joint's second body about the axis, and its reaction on the first.
    fn turn(&self, joint: JointId, couple: f64, required: &mut [Wrench]) {
        let joint = &self.mechanism.joints[joint.0];
        let [a, b] = joint.bodies;
        let couple = self.arm(a.0, joint.sides[0].axis).scaled(couple);
        required[a.0].moment += couple;
        required[b.0].moment -= couple;
    }

    /// Takes off a force on a joint's second body along the axis at that body's point, and its reaction on the first there.
    fn slide(&self, joint: JointId, force: f64, required: &mut [Wrench]) {
        let joint = &self.mechanism.joints[joint.0];
        let [a, b] = joint.bodies;
        let force = self.arm(a.0, joint.sides[0].axis).scaled(force);
        let at = self.point(b.0, joint.sides[1].point);
        let from = |body: usize| at - self.point(body, Vec3::ZERO);
        required[a.0].add_at(from(a.0), force, Vec3::ZERO);
        required[b.0].add_at(from(b.0), -force, Vec3::ZERO);
    }
}
