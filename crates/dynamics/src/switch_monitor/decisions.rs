//! Which pieces hold at a state: every decision of the loads and drives, operands before the operations on them.
//!
//! A function that is zero is decided by the side on which its own rates lead further into it. One that rests on zero, as
//! `step(x - 0.5) - 1` beyond 0.5, is held on zero itself: there `<` differs from `<=`.

use super::{Crossing, PROBE, SwitchMonitor};
use crate::error::Result;
use crate::ode::{OdeState, OdeSystem};
use dwell_laws::SwitchKind;

/// Within this part of the last step a function that an event leaves beside its bound is on it, but for rounding.
const ON_BOUND: f64 = 1e-13;

impl SwitchMonitor {
    /// Holds the pieces in which a state is.
    pub(super) fn decide(&mut self, system: &mut dyn OdeSystem, at: &OdeState) -> Result<()> {
        self.sliding = None;
        for switch in &mut self.switches {
            (switch.piece, switch.is_inside, switch.is_leaving) = (None, false, false);
        }
        self.hold(system);
        system.switch_values(at.t, &at.y, &mut self.values)?;
        for (switch, &value) in self.switches.iter_mut().zip(&self.values) {
            switch.piece = switch.kind.piece_at(value);
        }
        let undecided = |k: &usize| self.switches[*k].piece.is_none() && !self.values[*k].is_nan();
        let mut changed = self.marked((0..self.switches.len()).filter(undecided));
        let (mut moving, all) = (Vec::new(), changed.clone());
        for k in (0..all.len()).filter(|&k| all[k]) {
            if !self.switches[k].depends_on(&all) && !self.rests_on_zero(k, system, at)? {
                moving.push(k);
            }
        }
        if self.slide_from_rest(&moving, system, at)? {
            return Ok(());
        }
        for k in moving {
            self.decide_at_zero(k, system, at)?;
        }
        self.settle(&mut changed, system, at)?;
        self.hold(system);
        Ok(())
    }

    /// Marks switches by index.
    pub(super) fn marked(&self, switches: impl Iterator<Item = usize>) -> Vec<bool> {
        let mut marked = vec![false; self.switches.len()];
        switches.for_each(|k| marked[k] = true);
        marked
    }

    /// Takes these pieces.
    pub(super) fn take(&mut self, pieces: &[Option<f64>]) {
        for (switch, &piece) in self.switches.iter_mut().zip(pieces) {
            switch.piece = piece;
        }
    }

    /// Takes the decisions anew that depend on others which have changed; what changes by that is marked, too.
    ///
    /// # Errors
    /// Where the state cannot be evaluated.
    pub(super) fn settle(
        &mut self,
        changed: &mut [bool],
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<()> {
        for k in 0..changed.len() {
            if self.switches[k].depends_on(changed) {
                let before = self.switches[k].piece;
                self.decide_anew(k, changed[k], system, at)?;
                changed[k] = self.switches[k].piece != before;
            }
        }
        Ok(())
    }

    /// Passes with a switch those of its operands that are passed within a rounding of the same time: what they decide comes first.
    ///
    /// # Errors
    /// Where the state cannot be evaluated.
    pub(super) fn add_operands(
        &mut self,
        crossing: &mut Crossing,
        system: &mut dyn OdeSystem,
    ) -> Result<()> {
        let near = ON_BOUND * self.step.max(crossing.state.t.abs());
        let inner = |(k, _): &(usize, bool)| self.switches[*k].inner.clone();
        for j in crossing.passed.iter().flat_map(inner).collect::<Vec<_>>() {
            let [value, rate] = self.motion_of(j, system, &crossing.state)?;
            let soon = value + near * rate;
            let is_beyond = self.switches[j]
                .margin(soon)
                .is_some_and(|margin| margin < 0.0);
            if is_beyond && crossing.passed.iter().all(|(k, _)| *k != j) {
                crossing.passed.push((j, self.switches[j].is_above(soon)));
            }
        }
        Ok(())
    }

    /// Decides a switch by its value on the pieces of its operands; one that is on its bound, or was passed, by where it
    /// leads.
    fn decide_anew(
        &mut self,
        k: usize,
        is_passed: bool,
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<()> {
        self.switches[k].piece = None;
        self.hold(system);
        let near = if is_passed { PROBE } else { ON_BOUND };
        let [value, rate] = self.motion_of(k, system, at)?;
        let step = near * self.step;
        let switch = &mut self.switches[k];
        let by_value = switch.kind.piece_at(value + step * rate);
        switch.piece = by_value;
        // There a rounding would choose the piece whose rates are asked.
        if switch.kind == SwitchKind::Zero && value.abs() <= step * rate.abs() {
            self.decide_at_zero(k, system, at)?;
        }
        let switch = &mut self.switches[k];
        switch.piece = switch.piece.or(by_value);
        (switch.switched, switch.chatter, switch.is_inside) = (None, None, false);
        Ok(())
    }

    /// Holds a function that is zero on zero if it does not move there on either side; whether it does.
    fn rests_on_zero(
        &mut self,
        k: usize,
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<bool> {
        let rests =
            self.rate_on(-1.0, k, system, at)? == 0.0 && self.rate_on(1.0, k, system, at)? == 0.0;
        self.switches[k].piece = rests.then_some(0.0);
        self.hold(system);
        Ok(rests)
    }

    /// Holds the side of zero on which its own rates lead further into it; where both do, the one to which the operation at
    /// zero leads, and zero itself where that holds it there.
    fn decide_at_zero(
        &mut self,
        k: usize,
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<()> {
        let mut rate = |side: f64| self.rate_on(side, k, system, at);
        let [below, level, above] = [rate(-1.0)?, rate(0.0)?, rate(1.0)?];
        let on_zero = (level == 0.0).then_some(0.0);
        self.switches[k].piece = match [below < 0.0, above > 0.0] {
            [true, false] => Some(-1.0),
            [false, true] => Some(1.0),
            [true, true] => on_zero.or((!level.is_nan()).then_some(level.signum())),
            [false, false] => on_zero,
        };
        self.hold(system);
        Ok(())
    }

    /// The rate of a function soon behind a state, where it is held on a side of zero.
    fn rate_on(
        &mut self,
        side: f64,
        k: usize,
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<f64> {
        self.switches[k].piece = Some(side);
        self.hold(system);
        let mut rates = vec![0.0; at.y.len()];
        system.rhs(at.t, &at.y, &mut rates)?;
        let h = PROBE * self.step;
        let y = at.y.iter().zip(&rates).map(|(y, rate)| y + h * rate);
        let (t, y) = (at.t + h, y.collect());
        let [_, rate] = self.motion_of(k, system, &OdeState { t, y })?;
        Ok(rate)
    }

    /// The value and the rate of a function on the pieces that are held.
    fn motion_of(
        &mut self,
        k: usize,
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<[f64; 2]> {
        let mut rates = vec![0.0; at.y.len()];
        system.rhs(at.t, &at.y, &mut rates)?;
        let mut functions = vec![[f64::NAN; 2]; self.switches.len()];
        system.switch_rates(at.t, &at.y, &rates, &mut functions)?;
        Ok(functions[k])
    }
}
