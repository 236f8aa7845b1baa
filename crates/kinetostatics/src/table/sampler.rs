//! Samplers of the exact model, with exact derivatives.

use super::build::SlopeSampler;
use super::{Result, TableQuantity};
use crate::model::{KinematicState, MachineModel, Model};
use crate::pass::InverseDynamics;
use crate::reduced::{Batch, Coefficients, ExactModel, Inertia, ReducedModel};
use crate::space;
use dwell_numerics::{Dual, Scalar};

/// A model whose reduced parameters and unit-load responses can be tabulated, in the plane or in space.
pub trait TableModel: MachineModel {
    /// The unit of a reaction: N or N m.
    fn reaction_unit(&self, reaction: usize) -> &'static str;

    /// m and ½m′ at many coordinates (rad or m).
    fn inertia_of_many(exact: &ExactModel<Self>, q: &[f64], out: &mut Batch);
}

impl TableModel for Model {
    fn reaction_unit(&self, reaction: usize) -> &'static str {
        let reaction = self.reactions().get(reaction);
        reaction.map_or("", |reaction| reaction.component.unit())
    }

    fn inertia_of_many(exact: &ExactModel, q: &[f64], out: &mut Batch) {
        exact.inertia_batch(q, out);
    }
}

impl TableModel for space::Model {
    fn reaction_unit(&self, reaction: usize) -> &'static str {
        match self.reactions().nth(reaction).map(|r| r.component) {
            Some(space::Component::Force(..)) => "N",
            Some(space::Component::Moment(..)) => "N m",
            None => "",
        }
    }

    fn inertia_of_many(exact: &ExactModel<Self>, q: &[f64], out: &mut Batch) {
        let mut workspace = ReducedModel::workspace(exact);
        *out = Batch::default();
        for (i, &q) in q.iter().enumerate() {
            let (m, half_dm) = exact.inertia(q, &mut workspace).unwrap_or_else(|error| {
                out.errors.push((i, error));
                (f64::NAN, f64::NAN)
            });
            out.m.push(m);
            out.half_dm.push(half_dm);
        }
    }
}

/// m and ½m′ of an exact model.
pub struct InertiaSampler<'a, M: TableModel = Model> {
    exact: &'a ExactModel<M>,
    workspace: <ExactModel<M> as ReducedModel>::Workspace,
    batch: Batch,
}

impl<M: TableModel> ExactModel<M> {
    /// m and ½m′, for a [`TableBuilder`](super::TableBuilder).
    pub fn inertia_sampler(&self) -> InertiaSampler<'_, M> {
        InertiaSampler {
            exact: self,
            workspace: ReducedModel::workspace(self),
            batch: Batch::default(),
        }
    }
}

impl<M: TableModel> SlopeSampler for InertiaSampler<'_, M> {
    fn sample(&mut self, q: f64) -> Result<Inertia> {
        Ok(self.exact.inertia_derivatives(q, &mut self.workspace)?)
    }

    fn sample_many(&mut self, q: &[f64]) -> Result<Vec<[f64; 2]>> {
        M::inertia_of_many(self.exact, q, &mut self.batch);
        if let Some(&(_, error)) = self.batch.errors.first() {
            return Err(error.into());
        }
        let Batch { m, half_dm, .. } = &self.batch;
        let pairs = m.iter().zip(half_dm);
        Ok(pairs.map(|(&m, &slope)| [m, slope]).collect())
    }
}

/// An exact model with the working memory to evaluate its reactions and loads.
pub(super) struct ModelSampler<'a, M: TableModel> {
    model: &'a M,
    reduction: M::Workspace<Dual>,
    workspace: M::Workspace<Dual>,
    result: InverseDynamics<Dual>,
    coefficients: Coefficients<Dual>,
}

impl<'a, M: TableModel> ModelSampler<'a, M> {
    pub(super) fn new(exact: &'a ExactModel<M>) -> Self {
        let model = exact.model();
        Self {
            model,
            reduction: model.pass_workspace(),
            workspace: model.pass_workspace(),
            result: model.result_buffer(),
            coefficients: Coefficients::buffer(model.reaction_count()),
        }
    }

    /// The `quantities`, all of the reactions or all of the loads, with their derivatives by q.
    pub(super) fn sample(
        &mut self,
        quantities: &[TableQuantity],
        q: f64,
        out: &mut [Dual],
    ) -> Result<()> {
        let model = self.model;
        let q = Dual::variable(q);
        let mut state = None;
        match quantities.first() {
            None => return Ok(()),
            Some(TableQuantity::A { .. }) => {
                model.reduce_at(q, &mut self.reduction, &mut self.coefficients)?;
            }
            Some(_) => {
                let unit = Dual::from_f64(1.0);
                let at = [&[q][..], &[unit]];
                state = Some(KinematicState::new(model, at, &mut self.workspace)?);
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

/// The weight of a coefficient of another sort, so that a coefficient that vanishes with its whole kind is not measured by
/// its rounding.
const OTHER_SORT: f64 = 1e-3;

/// The weight of another coefficient in the scale of one: 1 for the same sort, load and unit; less if both arise from the same forces, with
/// the size of the mechanism between force and moment; otherwise 0.
pub(super) fn relation(model: &impl TableModel, one: TableQuantity, other: TableQuantity) -> f64 {
    // Sort, load and whether it is a moment.
    let describe = |quantity: TableQuantity| match quantity {
        TableQuantity::A { reaction } => Some((0, None, model.reaction_unit(reaction) == "N m")),
        TableQuantity::B { reaction } => Some((1, None, model.reaction_unit(reaction) == "N m")),
        TableQuantity::W { load } => Some((2, Some(load), model.is_angle(0))),
        TableQuantity::C { load, reaction } => {
            Some((3, Some(load), model.reaction_unit(reaction) == "N m"))
        }
        // They are curves, or belong to machines.
        TableQuantity::M
        | TableQuantity::HalfDm
        | TableQuantity::V
        | TableQuantity::HalfDv
        | TableQuantity::S { .. }
        | TableQuantity::Ds { .. } => None,
    };
    let (Some(one), Some(other)) = (describe(one), describe(other)) else {
        return 0.0;
    };
    let arm = match (one.2, other.2) {
        (true, false) => model.size(),
        (false, true) => 1.0 / model.size(),
        (true, true) | (false, false) => 1.0,
    };
    match (one == other, one.1 == other.1) {
        (true, _) => 1.0,
        (false, true) => OTHER_SORT * arm,
        (false, false) => 0.0,
    }
}
