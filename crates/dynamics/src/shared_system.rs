//! A system that an integrator and the monitors of its events evaluate in turn.

use crate::contact::ContactStep;
use crate::error::Result;
use crate::ode::{OdeState, OdeSystem};
use crate::sliding::Sliding;
use dwell_laws::SwitchKind;
use std::cell::RefCell;

/// A system that is integrated and, between its steps, looked at.
pub(crate) struct SharedSystem<'s> {
    kinds: Vec<SwitchKind>,
    size: usize,
    inner: RefCell<&'s mut dyn OdeSystem>,
}

impl<'s> SharedSystem<'s> {
    pub(crate) fn new(system: &'s mut dyn OdeSystem) -> Self {
        Self {
            kinds: system.switch_kinds().to_vec(),
            size: system.size(),
            inner: RefCell::new(system),
        }
    }

    /// Number of its states.
    pub(crate) fn states(&self) -> usize {
        self.size
    }

    /// Number of its switches.
    pub(crate) fn switches(&self) -> usize {
        self.kinds.len()
    }

    /// At which values they switch.
    pub(crate) fn kinds(&self) -> &[SwitchKind] {
        &self.kinds
    }
}

impl OdeSystem for &SharedSystem<'_> {
    fn size(&self) -> usize {
        self.size
    }

    fn rhs(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        self.inner.borrow_mut().rhs(t, y, out)
    }

    fn jacobian(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        self.inner.borrow_mut().jacobian(t, y, out)
    }

    fn switch_kinds(&self) -> &[SwitchKind] {
        &self.kinds
    }

    fn switch_source(&self, switch: usize) -> usize {
        self.inner.borrow().switch_source(switch)
    }

    fn switch_values(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        self.inner.borrow_mut().switch_values(t, y, out)
    }

    fn switch_rates(
        &mut self,
        t: f64,
        y: &[f64],
        rates: &[f64],
        out: &mut [[f64; 2]],
    ) -> Result<bool> {
        self.inner.borrow_mut().switch_rates(t, y, rates, out)
    }

    fn record_sliding(&mut self, at: &OdeState, switch: usize, sliding: Option<&Sliding>) {
        self.inner.borrow_mut().record_sliding(at, switch, sliding);
    }

    fn hold_pieces(&mut self, pieces: &[Option<f64>]) {
        self.inner.borrow_mut().hold_pieces(pieces);
    }

    fn contact_count(&self) -> usize {
        self.inner.borrow().contact_count()
    }

    fn contact_source(&self, contact: usize) -> usize {
        self.inner.borrow().contact_source(contact)
    }

    fn contact_margins(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<bool> {
        self.inner.borrow_mut().contact_margins(t, y, out)
    }

    fn pass_contacts(&mut self, t: f64, y: &mut [f64], step: &ContactStep<'_>) -> Result<()> {
        self.inner.borrow_mut().pass_contacts(t, y, step)
    }

    fn error_weight(&self, state: usize) -> f64 {
        self.inner.borrow().error_weight(state)
    }
}
