//! Samplers of the exact model, with exact derivatives.

use super::build::SlopeSampler;
use super::{Result, TableQuantity};
use crate::model::Workspace;
use crate::pass::InverseDynamics;
use crate::reduced::{Batch, Coefficients, ExactModel, ExactWorkspace, Inertia, ReducedModel};
use dwell_numerics::{Dual, Scalar};

/// m and ½m′ of an exact model.
pub struct InertiaSampler<'a> {
    exact: &'a ExactModel,
    workspace: ExactWorkspace,
    batch: Batch,
}

impl ExactModel {
    /// m and ½m′, for a [`TableBuilder`](super::TableBuilder).
    pub fn inertia_sampler(&self) -> InertiaSampler<'_> {
        InertiaSampler {
            exact: self,
            workspace: self.workspace(),
            batch: Batch::default(),
        }
    }
}

impl SlopeSampler for InertiaSampler<'_> {
    fn sample(&mut self, q: f64) -> Result<Inertia> {
        Ok(self.exact.inertia_derivatives(q, &mut self.workspace)?)
    }

    fn sample_many(&mut self, q: &[f64]) -> Result<Vec<[f64; 2]>> {
        self.exact.inertia_batch(q, &mut self.batch);
        if let Some(&(_, error)) = self.batch.errors.first() {
            return Err(error.into());
        }
        let Batch { m, half_dm, .. } = &self.batch;
        let pairs = m.iter().zip(half_dm);
        Ok(pairs.map(|(&m, &slope)| [m, slope]).collect())
    }
}

/// An exact model with the working memory to evaluate its reactions and loads.
pub(super) struct ModelSampler<'a> {
    exact: &'a ExactModel,
    workspace: Workspace<Dual>,
    result: InverseDynamics<Dual>,
    coefficients: Coefficients<Dual>,
}

impl<'a> ModelSampler<'a> {
    pub(super) fn new(exact: &'a ExactModel) -> Self {
        let model = exact.model();
        Self {
            exact,
            workspace: model.workspace(),
            result: model.result_buffer(),
            coefficients: model.coefficient_buffer(),
        }
    }

    /// The `quantities`, all of the reactions or all of the loads, with their derivatives by q.
    pub(super) fn sample(
        &mut self,
        quantities: &[TableQuantity],
        q: f64,
        out: &mut [Dual],
    ) -> Result<()> {
        let model = self.exact.model();
        let q = Dual::variable(q);
        let mut state = None;
        match quantities.first() {
            None => return Ok(()),
            Some(TableQuantity::A { .. }) => {
                model.reduce(q, &mut self.workspace, &mut self.coefficients)?;
            }
            Some(_) => {
                let unit = Dual::from_f64(1.0);
                state = Some(model.kinematic_state(&[q], &[unit], &mut self.workspace)?);
            }
        }
        let mut evaluated = None;
        for (out, quantity) in out.iter_mut().zip(quantities) {
            if let TableQuantity::W { load } | TableQuantity::C { load, .. } = *quantity
                && evaluated != Some(load)
                && let Some(state) = &mut state
            {
                state.unit_load_response(load, &mut self.result)?;
                evaluated = Some(load);
            }
            *out = match *quantity {
                TableQuantity::A { reaction } => self.coefficients.a[reaction],
                TableQuantity::B { reaction } => self.coefficients.b[reaction],
                TableQuantity::W { .. } => -self.result.tau[0],
                TableQuantity::C { reaction, .. } => self.result.reactions[reaction],
                // They are sampled as curves, or belong to machines.
                TableQuantity::M
                | TableQuantity::HalfDm
                | TableQuantity::V
                | TableQuantity::HalfDv
                | TableQuantity::S { .. }
                | TableQuantity::Ds { .. } => Dual::default(),
            };
        }
        Ok(())
    }
}

/// Whether two coefficients are of one kind: of the same sort, load and unit.
pub(super) fn same_kind(exact: &ExactModel, one: TableQuantity, other: TableQuantity) -> bool {
    let reactions = exact.model().reactions();
    let unit = |k: usize| reactions.get(k).map(|r| r.component.unit());
    let kind = |quantity: TableQuantity| match quantity {
        TableQuantity::A { reaction } => (TableQuantity::A { reaction: 0 }, unit(reaction)),
        TableQuantity::B { reaction } => (TableQuantity::B { reaction: 0 }, unit(reaction)),
        TableQuantity::C { load, reaction } => {
            let first = TableQuantity::C { load, reaction: 0 };
            (first, unit(reaction))
        }
        other => (other, None),
    };
    kind(one) == kind(other)
}
