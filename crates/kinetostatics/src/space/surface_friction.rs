//! Dry friction of a cylindrical joint that holds at rest, in a mechanism of one coordinate: its travel s and its angle θ move together, and so
//! the surface of the pin slides along one line. With c the velocity of the surface at q̇ = 1, along the axis and around it,
//!
//! ```text
//! c = (s′, r θ′),   ĉ = c/|c|,   F = F ĉ:    force F ĉ₁ along the axis,  couple r F ĉ₂ about it                (1)
//! Q = F·c = F |c|                                                                                            (2)
//! slides   F = −µ N sign q̇         holds   |F| ≤ µₛ N
//! ```
//!
//! The part of a friction across ĉ does no virtual work, so equilibrium does not determine it. It is zero while the surfaces slide. While
//! they stick it is set to zero, which gives the least friction force that holds.

use super::action::CompiledKind;
use super::load::LoadKind;
use super::model::{Model, Workspace};
use crate::error::LoadError;
use crate::load::{FrictionContact, Strength};
use dwell_geometry::JointId;
use dwell_geometry::space::{Coordinate, CoordinateFunction, JointKind};
use dwell_numerics::Scalar;

/// Such a friction.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct SurfaceFriction {
    /// Its load.
    pub(super) load: usize,
    /// A force along the axis and a couple about it, and the coordinates of both.
    parts: [CompiledKind; 2],
    coordinates: [CoordinateFunction; 2],
    /// Radius of the pin, m.
    radius: f64,
}

impl SurfaceFriction {
    /// Its parts, each with its fraction of a unit of the friction, in this direction of (1).
    pub(super) fn parts<T: Scalar>(&self, direction: [T; 2]) -> [(&CompiledKind, T); 2] {
        let [along, around] = direction;
        let [force, couple] = &self.parts;
        [(force, along), (couple, around * T::from_f64(self.radius))]
    }
}

impl Model {
    /// Compiles those among the loads.
    ///
    /// # Errors
    /// [`LoadError`] for one whose joint moves in two ways.
    pub(super) fn compile_surface_frictions(&mut self) -> Result<(), LoadError> {
        let mut all = Vec::new();
        for (load, one) in self.loads.loads.iter().enumerate() {
            let wrong = |what| LoadError { load, what };
            let (Some(friction), LoadKind::Along(Coordinate::Travel(joint), Strength::Direct)) =
                (one.friction(), one.kind)
            else {
                continue;
            };
            let FrictionContact::Bearing { radius, .. } = friction.contact else {
                continue;
            };
            if friction.regularization_speed.is_some() || !self.is_cylindrical(joint) {
                continue;
            }
            if self.plan().actuators() != 1 {
                return Err(wrong(TWO_DIRECTIONS));
            }
            let (mechanism, plan) = (self.mechanism(), self.plan());
            let compiled = |kind: LoadKind| CompiledKind::new(&kind, mechanism, plan);
            let parts = [
                compiled(LoadKind::slide_force(joint)).map_err(wrong)?,
                compiled(LoadKind::couple(joint)).map_err(wrong)?,
            ];
            let of = |coordinate| plan.direction_function(mechanism, coordinate);
            let coordinates = [
                of(Coordinate::Travel(joint)).map_err(wrong)?,
                of(Coordinate::Angle(joint)).map_err(wrong)?,
            ];
            all.push(SurfaceFriction {
                load,
                parts,
                coordinates,
                radius,
            });
        }
        self.surface_frictions = all;
        Ok(())
    }

    fn is_cylindrical(&self, joint: JointId) -> bool {
        let joint = self.mechanism().joints.get(joint.0);
        joint.is_some_and(|joint| joint.kind == JointKind::Cylindrical)
    }

    /// The surface friction of a load, with its direction at the last pose.
    #[inline]
    pub(super) fn surface_friction<T: Scalar>(
        &self,
        load: usize,
        directions: &[[T; 2]],
    ) -> Option<(&SurfaceFriction, [T; 2])> {
        let at = self
            .surface_frictions
            .iter()
            .position(|one| one.load == load)?;
        Some((&self.surface_frictions[at], directions[at]))
    }

    /// The directions of (1) at a pose.
    pub(super) fn update_surface_directions<T: Scalar>(&self, workspace: &mut Workspace<T>) {
        let Workspace {
            pose,
            rates,
            virtual_motion,
            surface_directions,
            ..
        } = workspace;
        pose.swap_motion(virtual_motion);
        rates.fill(T::from_f64(1.0));
        self.plan().velocities(rates, pose);
        for (one, direction) in self.surface_frictions.iter().zip(surface_directions) {
            let [along, turn] = one
                .coordinates
                .map(|of| self.plan().coordinate_rate(pose, of));
            let around = turn * T::from_f64(one.radius);
            let square = along * along + around * around;
            *direction = [T::from_f64(0.0); 2];
            if square.value() > 0.0 {
                let length = square.sqrt();
                *direction = [along / length, around / length];
            }
        }
        pose.swap_motion(virtual_motion);
    }
}

/// Why there is none.
pub(super) const TWO_DIRECTIONS: &str = "would hold in two directions, which is not computed: several coordinates move its joint along the axis and about it";
