//! Energies of a mechanism in space from the placements of its bodies.

use super::forces::SpaceBodies;
use super::state::SpaceCase;
use dwell_geometry::space::{BodyMotion, Placement};
use dwell_kinetostatics::space::{LoadKind, Mass};

/// The kinetic energy of all bodies, J.
pub fn kinetic_energy(
    case: &SpaceCase<'_>,
    placements: &[Placement],
    motions: &[BodyMotion],
) -> f64 {
    let bodies = case.masses.iter().zip(placements.iter().zip(motions));
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
pub fn potential_energy(
    case: &SpaceCase<'_>,
    placements: &[Placement],
    (kind, magnitude): (LoadKind, f64),
) -> Option<f64> {
    let at_rest = vec![BodyMotion::default(); placements.len()];
    let bodies = SpaceBodies {
        mechanism: case.mechanism,
        masses: case.masses,
        placements,
        motions: &at_rest,
    };
    bodies.placed(&kind).potential(magnitude)
}
