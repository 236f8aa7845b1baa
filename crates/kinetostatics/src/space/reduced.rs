//! The reduced model of a mechanism of one degree of freedom in space, by two unit passes.

use super::model::{Model, Workspace};
use crate::error::PositionResult;
use crate::reduced::{Coefficients, Inertia, ReducedModel};
use dwell_geometry::Range;
use dwell_numerics::{Dual, Scalar};

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
        let (zero, one) = (T::from_f64(0.0), T::from_f64(1.0));
        let plan = self.plan();
        plan.positions(&[q], &mut workspace.pose)?;
        plan.velocities(&[one], &mut workspace.pose);
        self.require_unit_acceleration(workspace);
        plan.balance(&mut workspace.pose, &mut workspace.forces);
        out.m = plan.actuator_action(&workspace.forces, 0);
        self.read_all(workspace, &mut out.a);
        plan.accelerations(&[zero], &mut workspace.pose);
        self.require_inertia(workspace);
        plan.balance(&mut workspace.pose, &mut workspace.forces);
        out.half_dm = plan.actuator_action(&workspace.forces, 0);
        self.read_all(workspace, &mut out.b);
        Ok(())
    }

    /// A buffer for the coefficients of this model.
    pub fn coefficient_buffer<T: Scalar>(&self) -> Coefficients<T> {
        let zeros = vec![T::from_f64(0.0); self.reactions().len()];
        Coefficients {
            a: zeros.clone(),
            b: zeros,
            ..Coefficients::default()
        }
    }
}

/// Working memory of the exact reduced model: one for values, one for derivatives.
#[derive(Debug, Clone)]
pub struct ExactWorkspace {
    real: Workspace<f64>,
    dual: Workspace<Dual>,
}

/// The reduced model evaluated from the mechanism itself.
#[derive(Debug, Clone)]
pub struct ExactModel {
    model: Model,
    inertia_model: Model,
}

impl ExactModel {
    /// The reduced model; none unless there is exactly one actuator.
    pub fn new(model: Model) -> Option<Self> {
        let inertia_model = model.without_reactions();
        (model.plan().actuators() == 1).then_some(Self {
            model,
            inertia_model,
        })
    }

    /// The model that is evaluated.
    pub fn model(&self) -> &Model {
        &self.model
    }
}

impl ReducedModel for ExactModel {
    type Workspace = ExactWorkspace;

    fn workspace(&self) -> ExactWorkspace {
        ExactWorkspace {
            real: self.model.workspace(),
            dual: self.inertia_model.workspace(),
        }
    }

    fn reactions(&self) -> usize {
        self.model.reactions().len()
    }

    fn range(&self) -> Range {
        self.model.plan().range()
    }

    fn inertia(&self, q: f64, work: &mut ExactWorkspace) -> PositionResult<(f64, f64)> {
        let mut out = Coefficients::default();
        self.inertia_model.reduce(q, &mut work.real, &mut out)?;
        Ok((out.m, out.half_dm))
    }

    fn inertia_derivatives(&self, q: f64, work: &mut ExactWorkspace) -> PositionResult<Inertia> {
        let mut out = Coefficients::default();
        self.inertia_model
            .reduce(Dual::variable(q), &mut work.dual, &mut out)?;
        Ok(Inertia {
            m: out.m.v,
            half_dm: out.half_dm.v,
            half_ddm: out.half_dm.d,
        })
    }

    fn coefficients(
        &self,
        q: f64,
        work: &mut ExactWorkspace,
        out: &mut Coefficients,
    ) -> PositionResult {
        self.model.reduce(q, &mut work.real, out)
    }
}
