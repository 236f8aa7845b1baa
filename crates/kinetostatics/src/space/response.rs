//! The responses of a model at rest to single loads, and their potentials.

use super::action::CompiledKind;
use super::load::LoadKind;
use super::model::{Model, Workspace};
use crate::error::PositionResult;
use crate::load::{LoadShape as _, Strength};
use crate::pass::InverseDynamics;
use dwell_geometry::space::Wrench;
use dwell_numerics::Scalar;

impl Model {
    /// The potential energy of a unit of a load at the last pose, J; `None` for a load without a potential.
    pub fn potential_energy(&self, load: &LoadKind, workspace: &Workspace) -> Option<f64> {
        let kind = CompiledKind::new(load, self.mechanism(), self.plan()).ok()?;
        kind.potential(self.plan(), &workspace.pose, self.inner_masses())
    }

    /// The response to a unit of a load, at rest; `None` if it has no direction.
    pub(super) fn respond<T: Scalar>(
        &self,
        kind: &CompiledKind,
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) -> Option<()> {
        let (unit, magnitude) = kind.unit_load();
        self.respond_to(&[(&unit, T::from_f64(magnitude))], workspace, result)
    }

    /// The response to some shapes with their magnitudes, at rest; `None` if one has no direction.
    pub(super) fn respond_to<T: Scalar>(
        &self,
        parts: &[(&CompiledKind, T)],
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) -> Option<()> {
        let Workspace { pose, forces, .. } = &mut *workspace;
        let required = &mut forces.required;
        required.fill([Wrench::default()]);
        for (kind, magnitude) in parts {
            kind.act(
                *magnitude,
                self.plan(),
                pose,
                self.inner_masses(),
                |(body, [arm, force, couple])| {
                    required[body][0].add_at(arm, -force, -couple);
                },
            )?;
        }
        self.balance(workspace, result);
        Some(())
    }

    /// The response to a [unit](crate::load::Strength::unit) of a load at `q` (rad or m) and unit speeds, without inertia: τ = −w and the reactions
    /// c. No numbers where the load has no direction or does not fit the mechanism.
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose at `q`.
    pub fn unit_load_response<T: Scalar>(
        &self,
        q: &[T],
        load: &LoadKind,
        workspace: &mut Workspace<T>,
        result: &mut InverseDynamics<T>,
    ) -> PositionResult {
        self.plan().positions(q, &mut workspace.pose)?;
        if load.strength() == Strength::Quadratic {
            let Workspace { pose, rates, .. } = &mut *workspace;
            rates.fill(T::from_f64(1.0));
            self.plan().velocities(rates, pose);
        }
        let kind = CompiledKind::new(load, self.mechanism(), self.plan()).ok();
        let responded = kind.and_then(|kind| self.respond(&kind, workspace, result));
        if responded.is_none() {
            result.tau.fill(T::from_f64(f64::NAN));
            result.reactions.fill(T::from_f64(f64::NAN));
        }
        Ok(())
    }
}
