//! Energies of a mechanism in space from the placements of its bodies.

use super::DensePose;
use super::forces::SpaceBodies;
use dwell_geometry::space::{BodyMotion, Placement};
use dwell_kinetostatics::space::{LoadKind, Mass};

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

    /// The potential energy of a load of constant magnitude, J; `None` for a load without a potential. The angle of a spring is that
    /// nearest to its free angle.
    pub fn potential_energy(&self, (kind, magnitude): (LoadKind, f64)) -> Option<f64> {
        let at_rest = vec![BodyMotion::default(); self.placements.len()];
        let bodies = SpaceBodies {
            mechanism: self.mechanism,
            masses: self.masses,
            placements: self.placements,
            motions: &at_rest,
        };
        bodies.placed(&kind).potential(magnitude)
    }
}
