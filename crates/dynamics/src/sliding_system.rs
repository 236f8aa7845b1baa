//! A system that an integrator and the monitors of its events evaluate in turn, and that may slide along a switch. Where the
//! rates f⁻ and f⁺ on its two sides both lead back to it, the motion stays on it (Filippov 1988):
//!
//! ```text
//! ẏ = (1 − α) f⁻ + α f⁺,    α = ġ⁻/(ġ⁻ − ġ⁺)          ġ = 0 along ẏ                    (1)
//! ```
//!
//! with the switching function g and its rates along f⁻ and f⁺. The motion leaves the switch where α comes to 0 or 1.

use crate::contact::ContactStep;
use crate::error::{DynamicsError, Result};
use crate::ode::{OdeState, OdeSystem};
use crate::sliding::{SideRates, Sliding};
use crate::state_switches::Hidden;
use dwell_laws::SwitchKind;
use std::cell::{Cell, RefCell, RefMut};

/// Step of the difference quotients of (1), as a part of a state.
const DIFFERENCE: f64 = 1e-7;

/// A system that is integrated and, between its steps, inspected.
pub(crate) struct SharedSystem<'s> {
    kinds: Vec<SwitchKind>,
    inner: RefCell<&'s mut dyn OdeSystem>,
    event_evaluations: Cell<usize>,
}

impl<'s> SharedSystem<'s> {
    pub(crate) fn new(system: &'s mut dyn OdeSystem) -> Self {
        Self {
            kinds: system.switch_kinds().to_vec(),
            inner: RefCell::new(system),
            event_evaluations: Cell::new(0),
        }
    }

    /// How often it was evaluated for the monitors of events.
    pub(crate) fn event_evaluations(&self) -> usize {
        self.event_evaluations.get()
    }

    fn inner(&self) -> RefMut<'_, &'s mut dyn OdeSystem> {
        self.inner.borrow_mut()
    }

    /// The system, for one more evaluation of this kind.
    fn inner_for_event(&self) -> RefMut<'_, &'s mut dyn OdeSystem> {
        self.event_evaluations.set(self.event_evaluations.get() + 1);
        self.inner()
    }
}

/// Both sides of a switch: the rates of the state, the values and rates of all functions.
#[derive(Default)]
pub(crate) struct BothSides {
    pub(crate) rates: [Vec<f64>; 2],
    functions: [Vec<[f64; 2]>; 2],
}

impl BothSides {
    /// The values and rates of the functions at a state; `None` if the rates are unknown.
    pub(crate) fn at(
        sides: &[Vec<Option<f64>>; 2],
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<Option<Self>> {
        let mut both = Self::default();
        let are_known = both.evaluate(sides, system, at.t, &at.y)?;
        Ok(are_known.then_some(both))
    }

    /// Evaluates them; whether the rates of the functions are known.
    fn evaluate(
        &mut self,
        sides: &[Vec<Option<f64>>; 2],
        system: &mut dyn OdeSystem,
        t: f64,
        y: &[f64],
    ) -> Result<bool> {
        let each = self.rates.iter_mut().zip(&mut self.functions);
        for ((rates, functions), pieces) in each.zip(sides) {
            rates.resize(y.len(), 0.0);
            functions.resize(pieces.len(), [0.0; 2]);
            system.hold_pieces(pieces);
            system.rhs(t, y, rates)?;
            if !system.switch_rates(t, y, rates, functions)? {
                return Ok(false);
            }
        }
        Ok(true)
    }

    pub(crate) fn of(&self, k: usize) -> SideRates {
        SideRates {
            sides: [self.functions[0][k], self.functions[1][k]],
        }
    }
}

/// A system on the pieces that are held, or sliding along a switch between two of them.
pub(crate) struct SlidingSystem<'s, 'i> {
    shared: &'s SharedSystem<'i>,
    sliding: Option<Sliding>,
    sides: BothSides,
}

impl<'s, 'i> SlidingSystem<'s, 'i> {
    /// The system, along a switch if one is given.
    pub(crate) fn new(shared: &'s SharedSystem<'i>, sliding: Option<Sliding>) -> Self {
        let sides = BothSides::default();
        Self {
            shared,
            sliding,
            sides,
        }
    }

    /// Evaluates both sides, and the rates of the switching function on them; `None` if the motion does not slide.
    ///
    /// # Errors
    /// [`DynamicsError`](crate::DynamicsError) where the state cannot be evaluated.
    pub(crate) fn side_rates(&mut self, t: f64, y: &[f64]) -> Result<Option<SideRates>> {
        let Some(sliding) = self.sliding.take() else {
            return Ok(None);
        };
        let mut sides = std::mem::take(&mut self.sides);
        let evaluated = sides.evaluate(&sliding.sides, self, t, y);
        let first = sliding.switches[0];
        (self.sliding, self.sides) = (Some(sliding), sides);
        evaluated?;
        Ok(Some(self.sides.of(first)))
    }

    /// By side: the margin of each other function whose piece the side decides within this piece, and whether it would leave it
    /// upwards.
    ///
    /// # Errors
    /// As [`side_rates`](Self::side_rates).
    pub(crate) fn margins_beside(&mut self, t: f64, y: &[f64]) -> Result<Vec<MarginBeside>> {
        let beside = |sliding: &Sliding| {
            let beside = |k: &usize| sliding.decides(*k) && !sliding.switches.contains(k);
            (0..self.shared.kinds.len()).filter(beside).collect()
        };
        let switches: Vec<usize> = self.sliding.as_ref().map_or_else(Vec::new, beside);
        if switches.is_empty() {
            return Ok(Vec::new());
        }
        self.side_rates(t, y)?;
        let Some(sliding) = &self.sliding else {
            return Ok(Vec::new());
        };
        let (kinds, functions) = (&self.shared.kinds, &self.sides.functions);
        let of = |(side, k): (usize, usize)| {
            let [low, high] = kinds[k].bounds(sliding.sides[side][k]?);
            let [value, _] = functions[side][k];
            let (margin, upward) = ((value - low).min(high - value), value - low > high - value);
            Some(MarginBeside {
                side,
                switch: k,
                margin,
                upward,
            })
        };
        let each = switches.into_iter().flat_map(|k| [(0, k), (1, k)]);
        Ok(each.filter_map(of).collect())
    }
}

/// How far a function is within its piece on one side of the switch along which the motion slides.
pub(crate) struct MarginBeside {
    pub(crate) side: usize,
    pub(crate) switch: usize,
    pub(crate) margin: f64,
    pub(crate) upward: bool,
}

impl OdeSystem for SlidingSystem<'_, '_> {
    fn size(&self) -> usize {
        self.shared.inner().size()
    }

    fn rhs(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        let rates = self.side_rates(t, y)?;
        let (Some(rates), Some(sliding)) = (rates, &self.sliding) else {
            return self.shared.inner().rhs(t, y, out);
        };
        let part = rates.returning_part(sliding);
        let [lower, upper] = &self.sides.rates;
        for (out, (lower, upper)) in out.iter_mut().zip(lower.iter().zip(upper)) {
            *out = lower + part * (upper - lower);
        }
        Ok(())
    }

    fn jacobian(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        if self.sliding.is_none() {
            return self.shared.inner().jacobian(t, y, out);
        }
        // For Newton's method alone, whose result does not depend on it.
        let n = y.len();
        let (mut at, mut before, mut after) = (y.to_vec(), vec![0.0; n], vec![0.0; n]);
        self.rhs(t, y, &mut before)?;
        for j in 0..n {
            at[j] += DIFFERENCE * y[j].abs().max(1.0);
            let step = at[j] - y[j];
            self.rhs(t, &at, &mut after)?;
            at[j] = y[j];
            for (i, (after, before)) in after.iter().zip(&before).enumerate() {
                out[i * n + j] = (after - before) / step;
            }
        }
        Ok(())
    }

    fn own_function(&self) -> Option<usize> {
        self.shared.inner().own_function()
    }

    fn switch_kinds(&self) -> &[SwitchKind] {
        &self.shared.kinds
    }

    fn switch_source(&self, switch: usize) -> usize {
        self.shared.inner().switch_source(switch)
    }

    fn may_hide(&self) -> bool {
        self.shared.inner().may_hide()
    }

    fn followed_signals(&self) -> Option<Vec<usize>> {
        self.shared.inner().followed_signals()
    }

    fn read_signals(&self, out: &mut Vec<f64>) {
        self.shared.inner().read_signals(out);
    }

    fn hidden_in(&self, samples: &[Vec<f64>; 5], pieces: &[Option<f64>]) -> Option<Hidden> {
        self.shared.inner().hidden_in(samples, pieces)
    }

    fn switch_operands(&self, switch: usize) -> Vec<usize> {
        self.shared.inner().switch_operands(switch)
    }

    fn switch_values(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        self.shared.inner_for_event().switch_values(t, y, out)
    }

    fn switch_rates(
        &mut self,
        t: f64,
        y: &[f64],
        rates: &[f64],
        out: &mut [[f64; 2]],
    ) -> Result<bool> {
        let mut inner = self.shared.inner_for_event();
        inner.switch_rates(t, y, rates, out)
    }

    fn record_sliding(&mut self, at: &OdeState, switch: usize, sliding: Option<&Sliding>) {
        self.shared.inner().record_sliding(at, switch, sliding);
    }

    fn record_mode(&mut self, at: &OdeState, pieces: &[Option<f64>], sliding: Option<&Sliding>) {
        self.shared.inner().record_mode(at, pieces, sliding);
    }

    fn hold_pieces(&mut self, pieces: &[Option<f64>]) {
        self.shared.inner().hold_pieces(pieces);
    }

    fn contact_count(&self) -> usize {
        self.shared.inner().contact_count()
    }

    fn contact_without_mode(&self, contact: usize) -> DynamicsError {
        self.shared.inner().contact_without_mode(contact)
    }

    fn speed_at_stop(&self, contact: usize, y: &[f64]) -> Option<(usize, f64)> {
        self.shared.inner().speed_at_stop(contact, y)
    }

    fn contact_margins(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<bool> {
        let rates = self.side_rates(t, y)?;
        // Where it slides, held on the upper side now.
        let is_open = self.shared.inner_for_event().contact_margins(t, y, out)?;
        if let (Some(rates), Some(sliding)) = (rates, &self.sliding) {
            let part = rates.upper_part();
            let mut lower = vec![0.0; out.len()];
            let mut inner = self.shared.inner_for_event();
            inner.hold_pieces(&sliding.sides[0]);
            inner.contact_margins(t, y, &mut lower)?;
            for (out, lower) in out.iter_mut().zip(lower) {
                *out = lower + part * (*out - lower);
            }
        }
        Ok(is_open)
    }

    fn pass_contacts(&mut self, t: f64, y: &mut [f64], step: &ContactStep<'_>) -> Result<()> {
        self.shared.inner_for_event().pass_contacts(t, y, step)
    }

    fn balance(&mut self, at: &OdeState) -> Option<[f64; 2]> {
        self.shared.inner().balance(at)
    }

    fn error_weight(&self, state: usize) -> f64 {
        self.shared.inner().error_weight(state)
    }
}
