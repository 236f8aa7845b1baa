//! Energies of a mechanism in space from the placements of its bodies.

use super::DensePose;
use super::joints::Sides;
use dwell_geometry::space::{BodyMotion, Placement};
use dwell_kinetostatics::space::{Direction, LoadKind, Mass};
use std::f64::consts::TAU;

impl DensePose<'_> {
    /// The kinetic energy of all bodies at speeds of the actuators, J.
    pub fn kinetic_energy(&self, q_dot: &[f64]) -> f64 {
        let motions = self.velocities(q_dot);
        let bodies = self.masses.iter().zip(self.placements.iter().zip(&motions));
        let of_body = |(mass, (placement, motion)): (&Mass, (&Placement, &BodyMotion))| {
            let rotation = &placement.rotation;
            let velocity = motion.point_velocity(rotation.apply(mass.center));
            let turning = rotation.apply_inverse(motion.angular_velocity);
            mass.mass * velocity.dot(velocity) + turning.dot(mass.angular_momentum(turning))
        };
        0.5 * bodies.map(of_body).sum::<f64>()
    }

    /// The potential energy of a load of constant magnitude, J; none of one that has no potential. The angle of a spring is that nearest to
    /// its free angle.
    pub fn potential_energy(&self, (kind, magnitude): (LoadKind, f64)) -> Option<f64> {
        let placements = self.placements;
        let at =
            |body: usize, point| placements[body].position + placements[body].rotation.apply(point);
        let of_unit = match kind {
            LoadKind::Gravity(g) => {
                let weight =
                    |(body, mass): (usize, &Mass)| -mass.mass * g.dot(at(body, mass.center));
                self.masses.iter().enumerate().map(weight).sum()
            }
            LoadKind::Force {
                body,
                point,
                direction: Direction::Ground(u),
            } => -u.dot(at(body.0, point)),
            LoadKind::Spring {
                bodies: [a, b],
                points,
                free_length,
            } => {
                let d = at(b.0, points[1]) - at(a.0, points[0]);
                0.5 * (d.norm() - free_length).powi(2)
            }
            LoadKind::TorsionSpring { joint, free_angle } => {
                let sides = Sides::of(&self.mechanism.joints[joint.0], placements);
                let turn = sides.angle() - free_angle;
                0.5 * (turn - TAU * (turn / TAU).round()).powi(2)
            }
            LoadKind::Force { .. }
            | LoadKind::Torque { .. }
            | LoadKind::PointToPointForce { .. }
            | LoadKind::Damper { .. }
            | LoadKind::JointTorque(_)
            | LoadKind::RotationalDamper(_)
            | LoadKind::SlideForce(_)
            | LoadKind::SlideDamper(_) => return None,
        };
        Some(magnitude * of_unit)
    }
}
