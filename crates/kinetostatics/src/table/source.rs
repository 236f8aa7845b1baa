//! What a table is made from: the exact model, with exact derivatives.

use super::make::Slopes;
use super::{Entry, TableError};
use crate::batch::Batch;
use crate::model::{Actions, Workspace};
use crate::reduced::{Coefficients, Exact, ExactWork, Inertia, Reduced};
use dwell_geometry::{Dual, Scalar};

/// m and ½m′ of an exact model.
pub struct Inertias<'a> {
    exact: &'a Exact,
    work: ExactWork,
    batch: Batch,
}

impl Exact {
    /// m and ½m′, for a [`Maker`](super::Maker).
    pub fn slopes(&self) -> Inertias<'_> {
        Inertias {
            exact: self,
            work: self.work(),
            batch: Batch::default(),
        }
    }
}

impl Slopes for Inertias<'_> {
    fn at(&mut self, q: f64) -> Result<Inertia, TableError> {
        Ok(self.exact.curvature(q, &mut self.work)?)
    }

    fn many(&mut self, q: &[f64]) -> Result<Vec<[f64; 2]>, TableError> {
        self.exact.inertia_all(q, &mut self.batch);
        if let Some(&(_, error)) = self.batch.errors.first() {
            return Err(error.into());
        }
        let Batch { m, half_dm, .. } = &self.batch;
        Ok(m.iter()
            .zip(half_dm)
            .map(|(&m, &slope)| [m, slope])
            .collect())
    }
}

/// An exact model with the working memory to evaluate its reactions and loads.
pub(super) struct Source<'a> {
    exact: &'a Exact,
    dual: Workspace<Dual>,
    actions: Actions<Dual>,
    at: Coefficients<Dual>,
}

impl<'a> Source<'a> {
    pub(super) fn new(exact: &'a Exact) -> Self {
        let model = exact.model();
        Self {
            exact,
            dual: model.workspace(),
            actions: model.actions(),
            at: model.coefficients(),
        }
    }

    /// The coefficients `which`, all of the reactions or all of the loads, with their derivatives by q.
    pub(super) fn fill(
        &mut self,
        which: &[Entry],
        q: f64,
        out: &mut [Dual],
    ) -> Result<(), TableError> {
        let model = self.exact.model();
        let q = Dual::variable(q);
        match which.first() {
            None => return Ok(()),
            Some(Entry::A { .. }) => model.reduce(q, &mut self.dual, &mut self.at)?,
            Some(_) => {
                let unit = Dual::lift(1.0);
                model.enter_shape(&[q], &[unit], &mut self.dual)?;
            }
        }
        let mut pushed = None;
        for (out, entry) in out.iter_mut().zip(which) {
            if let Entry::W { load } | Entry::C { load, .. } = *entry
                && pushed != Some(load)
            {
                model.channel(load, &mut self.dual, &mut self.actions)?;
                pushed = Some(load);
            }
            *out = match *entry {
                Entry::A { reaction } => self.at.a[reaction],
                Entry::B { reaction } => self.at.b[reaction],
                Entry::W { .. } => -self.actions.tau[0],
                Entry::C { reaction, .. } => self.actions.reactions[reaction],
                // Curves, and what only machines have.
                _ => Dual::default(),
            };
        }
        Ok(())
    }
}

/// Whether two coefficients are of one kind: of the same sort, load and unit.
pub(super) fn alike(exact: &Exact, one: Entry, other: Entry) -> bool {
    let reactions = exact.model().reactions();
    let unit = |k: usize| reactions.get(k).map(|r| r.component.unit());
    match (one, other) {
        (Entry::A { reaction: j }, Entry::A { reaction: k })
        | (Entry::B { reaction: j }, Entry::B { reaction: k }) => unit(j) == unit(k),
        (
            Entry::C {
                load: l,
                reaction: j,
            },
            Entry::C {
                load: n,
                reaction: k,
            },
        ) => l == n && unit(j) == unit(k),
        (one, other) => one == other,
    }
}
