//! The reduced model of a mechanism of one degree of freedom in space, by two unit passes.

use super::model::{Model, Workspace};
use crate::error::PositionResult;
use crate::reduced::{Coefficients, ReducibleModel};
use dwell_geometry::Range;
use dwell_numerics::Scalar;

impl Model {
    /// The reduced coefficients at `q` (rad or m) in any kind of number, for one actuator.
    ///
    /// # Errors
    /// [`PositionError`](dwell_geometry::PositionError) when there is no pose at `q`.
    pub fn reduce<T: Scalar>(
        &self,
        q: T,
        workspace: &mut Workspace<T>,
        out: &mut Coefficients<T>,
    ) -> PositionResult {
        if self.reduce_in_plane(q, workspace, out) {
            return Ok(());
        }
        let (zero, one) = (T::from_f64(0.0), T::from_f64(1.0));
        let plan = self.plan();
        plan.positions(&[q], &mut workspace.pose)?;
        plan.velocities(&[one], &mut workspace.pose);
        plan.accelerations(&[zero], &mut workspace.pose);
        let (pose, forces) = (&workspace.pose, &mut workspace.unit_forces);
        self.pass_model.require_unit_inertia(pose, forces);
        plan.balance(pose, forces);
        [out.m, out.half_dm] = plan.actuator_action(forces, 0);
        self.pass_model.read_all(pose, forces, |k, coefficients| {
            [out.a[k], out.b[k]] = coefficients;
        });
        Ok(())
    }

    /// A buffer for the coefficients of this model.
    pub fn coefficient_buffer<T: Scalar>(&self) -> Coefficients<T> {
        Coefficients::buffer(self.reactions().len())
    }
}

impl ReducibleModel for Model {
    type Workspace<T: Scalar> = Workspace<T>;

    fn pass_workspace<T: Scalar>(&self) -> Workspace<T> {
        self.workspace()
    }

    fn actuators(&self) -> usize {
        self.plan().actuators()
    }

    fn reaction_count(&self) -> usize {
        self.reactions().len()
    }

    fn range(&self) -> Range {
        self.plan().range()
    }

    fn for_coefficients(self) -> Self {
        self.reduced_in_plane()
    }

    fn for_inertia(&self) -> Self {
        self.inertia_only()
    }

    fn reduce_at<T: Scalar>(
        &self,
        q: T,
        workspace: &mut Workspace<T>,
        out: &mut Coefficients<T>,
    ) -> PositionResult {
        self.reduce(q, workspace, out)
    }

    fn unit_turns(&self, workspace: &Workspace<f64>) -> Vec<[f64; 2]> {
        match self.in_plane_turns(workspace) {
            Some(turns) => turns,
            None => self.plan().unit_turns(&workspace.pose),
        }
    }
}
