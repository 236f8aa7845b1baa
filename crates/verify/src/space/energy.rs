//! Energies of a mechanism in space from the placements of its bodies.

use super::rows::{Bodies, Sides};
use super::state::{SpaceCase, product};
use dwell_geometry::space::{BodyMotion, Placement};
use dwell_kinetostatics::space::{Direction, LoadKind, Mass};
use std::f64::consts::TAU;

/// The kinetic energy of all bodies, J.
pub fn kinetic_energy(
    case: &SpaceCase<'_>,
    placements: &[Placement],
    motions: &[BodyMotion],
) -> f64 {
    0.5 * product(case, placements, [motions, motions])
}

/// The potential energy of a load of constant magnitude, J; none of one that has no potential. The angle of a spring is that nearest to
/// its free angle.
pub fn potential_energy(
    case: &SpaceCase<'_>,
    placements: &[Placement],
    (kind, magnitude): (LoadKind, f64),
) -> Option<f64> {
    let bodies = Bodies::at_rest(case.mechanism, placements);
    let of_unit = match kind {
        LoadKind::Gravity(g) => {
            let weight =
                |(body, mass): (usize, &Mass)| -mass.mass * g.dot(bodies.point(body, mass.center));
            case.masses.iter().enumerate().map(weight).sum()
        }
        LoadKind::Force {
            body,
            point,
            direction: Direction::Ground(u),
        } => -u.dot(bodies.point(body.0, point)),
        LoadKind::Spring {
            bodies: [a, b],
            points,
            free_length,
        } => {
            let d = bodies.point(b.0, points[1]) - bodies.point(a.0, points[0]);
            0.5 * (d.norm() - free_length).powi(2)
        }
        LoadKind::TorsionSpring { joint, free_angle } => {
            let sides = Sides::of(&case.mechanism.joints[joint.0], placements);
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
