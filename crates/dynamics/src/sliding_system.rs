//! A system that may slide along a switch. Where the rates f⁻ and f⁺ on its two sides both lead back to it, the motion stays on
//! it (Filippov 1988):
//!
//! ```text
//! ẏ = (1 − α) f⁻ + α f⁺,    α = ġ⁻/(ġ⁻ − ġ⁺)          ġ = 0 along ẏ                    (1)
//! ```
//!
//! with the switching function g and its rates along f⁻ and f⁺. The motion leaves the switch where α comes to 0 or 1.

use crate::contact::ContactStep;
use crate::error::{DynamicsError, Result};
use crate::ode::{OdeState, OdeSystem};
use crate::shared_system::SharedSystem;
use crate::sliding::{SideRates, Sliding};
use dwell_laws::SwitchKind;

/// Step of the difference quotients of (1), as a part of a state.
const DIFFERENCE: f64 = 1e-7;

/// A system on the pieces that are held, or sliding along a switch between two of them.
pub(crate) struct SlidingSystem<'s, 'i> {
    shared: &'s SharedSystem<'i>,
    sliding: Option<Sliding>,
    /// On both sides: the rates, and the values and rates of all switching functions.
    rates: [Vec<f64>; 2],
    functions: [Vec<[f64; 2]>; 2],
}

impl<'s, 'i> SlidingSystem<'s, 'i> {
    /// The system, along a switch if one is given.
    pub(crate) fn new(shared: &'s SharedSystem<'i>, sliding: Option<Sliding>) -> Self {
        let (n, switches) = (shared.states(), shared.switches());
        Self {
            shared,
            sliding,
            rates: [vec![0.0; n], vec![0.0; n]],
            functions: [vec![[0.0; 2]; switches], vec![[0.0; 2]; switches]],
        }
    }

    /// Evaluates both sides.
    fn evaluate_sides(&mut self, t: f64, y: &[f64], sliding: &Sliding) -> Result<SideRates> {
        let mut system = self.shared;
        let sides = self.rates.iter_mut().zip(&mut self.functions);
        for ((rates, functions), pieces) in sides.zip(&sliding.sides) {
            system.hold_pieces(pieces);
            system.rhs(t, y, rates)?;
            system.switch_rates(t, y, rates, functions)?;
        }
        let first = sliding.switches[0];
        Ok(SideRates {
            sides: [self.functions[0][first], self.functions[1][first]],
        })
    }

    /// How far a sliding motion is from leaving its switch, and the part of the upper side; none where it does not slide.
    ///
    /// # Errors
    /// [`DynamicsError`](crate::DynamicsError) where the state cannot be evaluated.
    pub(crate) fn sliding_margin(&mut self, t: f64, y: &[f64]) -> Result<Option<SideRates>> {
        let Some(sliding) = self.sliding.take() else {
            return Ok(None);
        };
        let found = self.evaluate_sides(t, y, &sliding);
        self.sliding = Some(sliding);
        found.map(Some)
    }
}

impl OdeSystem for SlidingSystem<'_, '_> {
    fn size(&self) -> usize {
        self.shared.size()
    }

    fn rhs(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        let Some(sliding) = self.sliding.take() else {
            let mut shared = self.shared;
            return shared.rhs(t, y, out);
        };
        let sides = self.evaluate_sides(t, y, &sliding);
        let part = sides.map(|sides| sides.returning_part(&sliding));
        self.sliding = Some(sliding);
        let part = part?;
        let [lower, upper] = &self.rates;
        for (out, (lower, upper)) in out.iter_mut().zip(lower.iter().zip(upper)) {
            *out = lower + part * (upper - lower);
        }
        Ok(())
    }

    fn jacobian(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        if self.sliding.is_none() {
            let mut shared = self.shared;
            return shared.jacobian(t, y, out);
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

    fn switch_kinds(&self) -> &[SwitchKind] {
        self.shared.kinds()
    }

    fn switch_source(&self, switch: usize) -> usize {
        self.shared.switch_source(switch)
    }

    fn switch_values(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        let mut shared = self.shared;
        shared.switch_values(t, y, out)
    }

    fn switch_rates(
        &mut self,
        t: f64,
        y: &[f64],
        rates: &[f64],
        out: &mut [[f64; 2]],
    ) -> Result<bool> {
        let mut shared = self.shared;
        shared.switch_rates(t, y, rates, out)
    }

    fn record_sliding(&mut self, at: &OdeState, switch: usize, sliding: Option<&Sliding>) {
        let mut shared = self.shared;
        shared.record_sliding(at, switch, sliding);
    }

    fn hold_pieces(&mut self, pieces: &[Option<f64>]) {
        let mut shared = self.shared;
        shared.hold_pieces(pieces);
    }

    fn contact_count(&self) -> usize {
        self.shared.contact_count()
    }

    fn contact_without_mode(&self, contact: usize) -> DynamicsError {
        self.shared.contact_without_mode(contact)
    }

    fn speed_at_stop(&self, contact: usize, y: &[f64]) -> Option<(usize, f64)> {
        self.shared.speed_at_stop(contact, y)
    }

    fn contact_margins(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<bool> {
        let mut shared = self.shared;
        let Some(sliding) = &self.sliding else {
            return shared.contact_margins(t, y, out);
        };
        let sliding = sliding.clone();
        let part = self.evaluate_sides(t, y, &sliding)?.upper_part();
        // Held on the upper side now.
        let is_open = shared.contact_margins(t, y, out)?;
        let mut lower = vec![0.0; out.len()];
        shared.hold_pieces(&sliding.sides[0]);
        shared.contact_margins(t, y, &mut lower)?;
        for (out, lower) in out.iter_mut().zip(lower) {
            *out = lower + part * (*out - lower);
        }
        Ok(is_open)
    }

    fn pass_contacts(&mut self, t: f64, y: &mut [f64], step: &ContactStep<'_>) -> Result<()> {
        let mut shared = self.shared;
        shared.pass_contacts(t, y, step)
    }

    fn error_weight(&self, state: usize) -> f64 {
        self.shared.error_weight(state)
    }
}
