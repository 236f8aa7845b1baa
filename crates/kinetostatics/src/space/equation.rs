//! The equation of motion of a mechanism in space with any number of coordinates.
//!
//! ```text
//! M(q) q̈ = Q − c(q, q̇)                                                                              (1)
//! ```
//!
//! Column i of M is what the actuators do at unit acceleration of coordinate i from rest; c − Q is what they do without
//! acceleration, under all loads. All passes share the pose and its factors.

use super::load::LoadKind;
use super::model::{Model, Workspace};
use crate::error::PositionResult;
use dwell_numerics::Scalar;

impl Model {
    /// M row by row, and Q − c, at coordinates (rad or m) and speeds under loads with their magnitudes.
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose at `q`.
    pub fn equation_of_motion<T: Scalar>(
        &self,
        [q, q_dot]: [&[T]; 2],
        loads: &[(LoadKind, f64)],
        workspace: &mut Workspace<T>,
        mass_matrix: &mut [T],
        forces: &mut [T],
    ) -> PositionResult {
        let (plan, n) = (self.plan(), q.len());
        plan.positions(q, &mut workspace.pose)?;
        for column in 0..n {
            workspace.rates.fill(T::from_f64(0.0));
            workspace.rates[column] = T::from_f64(1.0);
            plan.velocities(&workspace.rates, &mut workspace.pose);
            self.require_unit_acceleration(workspace);
            plan.balance(&workspace.pose, &mut workspace.forces);
            for row in 0..n {
                [mass_matrix[row * n + column]] = plan.actuator_action(&workspace.forces, row);
            }
        }
        workspace.rates.fill(T::from_f64(0.0));
        plan.velocities(q_dot, &mut workspace.pose);
        plan.accelerations(&workspace.rates, &mut workspace.pose);
        self.require_inertia(workspace);
        for (kind, magnitude) in loads {
            self.subtract_load(kind, *magnitude, workspace);
        }
        plan.balance(&workspace.pose, &mut workspace.forces);
        for (row, force) in forces.iter_mut().enumerate() {
            let [action] = plan.actuator_action(&workspace.forces, row);
            *force = -action;
        }
        Ok(())
    }
}
