//! A system that an integrator and the monitors of its events evaluate in turn.

use crate::contact::ContactStep;
use crate::error::{DynamicsError, Result};
use crate::ode::{OdeState, OdeSystem};
use crate::sliding::Sliding;
use dwell_laws::SwitchKind;
use std::cell::{Cell, RefCell, RefMut};

/// A system that is integrated and, between its steps, looked at.
pub(crate) struct SharedSystem<'s> {
    kinds: Vec<SwitchKind>,
    size: usize,
    inner: RefCell<&'s mut dyn OdeSystem>,
    event_evaluations: Cell<usize>,
}

impl<'s> SharedSystem<'s> {
    pub(crate) fn new(system: &'s mut dyn OdeSystem) -> Self {
        Self {
            kinds: system.switch_kinds().to_vec(),
            size: system.size(),
            inner: RefCell::new(system),
            event_evaluations: Cell::new(0),
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

    /// How often it was evaluated for the monitors of events.
    pub(crate) fn event_evaluations(&self) -> usize {
        self.event_evaluations.get()
    }

    /// The system, for one more evaluation of this kind.
    fn inner_for_event(&self) -> RefMut<'_, &'s mut dyn OdeSystem> {
        self.event_evaluations.set(self.event_evaluations.get() + 1);
        self.inner.borrow_mut()
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
        self.inner_for_event().switch_values(t, y, out)
    }

    fn switch_rates(
        &mut self,
        t: f64,
        y: &[f64],
        rates: &[f64],
        out: &mut [[f64; 2]],
    ) -> Result<bool> {
        self.inner_for_event().switch_rates(t, y, rates, out)
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

    fn contact_without_mode(&self, contact: usize) -> DynamicsError {
        self.inner.borrow().contact_without_mode(contact)
    }

    fn speed_at_stop(&self, contact: usize, y: &[f64]) -> Option<(usize, f64)> {
        self.inner.borrow().speed_at_stop(contact, y)
    }

    fn contact_margins(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<bool> {
        self.inner_for_event().contact_margins(t, y, out)
    }

    fn pass_contacts(&mut self, t: f64, y: &mut [f64], step: &ContactStep<'_>) -> Result<()> {
        self.inner_for_event().pass_contacts(t, y, step)
    }

    fn error_weight(&self, state: usize) -> f64 {
        self.inner.borrow().error_weight(state)
    }
}
