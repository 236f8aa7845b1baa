//! Which pieces hold at a state: every decision of the loads and drives, operands before the operations on them.
//!
//! A function that is zero is decided by the side on which its own rates lead further into it. One that rests on zero, as
//! `step(x - 0.5) - 1` beyond 0.5, is held on zero itself: there `<` differs from `<=`.

use super::{Crossing, PROBE, SwitchMonitor};
use crate::error::Result;
use crate::ode::{OdeState, OdeSystem};
use dwell_laws::SwitchKind;

/// Relative to the last step: within this distance of its bound, a function at an event is on the bound, except for
/// rounding.
const ON_BOUND: f64 = 1e-13;

/// Largest number of functions that are tried together on all pieces on whose bound they are; others follow their own
/// rates.
const MAX_TOGETHER: usize = 6;

/// Decisions that are being taken.
struct Choice<'c> {
    /// By switch: whether it is to be decided, and whether it has changed.
    open: &'c [bool],
    changed: Vec<bool>,
    /// The functions on a bound with the signs of the rates that agree with their pieces, and how many there may be.
    ties: Vec<(usize, f64)>,
    most: usize,
}

/// The piece above a bound that a value is within a distance of.
fn piece_above_bound(kind: &SwitchKind, value: f64, within: f64) -> Option<f64> {
    let is_near = |bound: f64| (value - bound).abs() <= within;
    match kind {
        SwitchKind::Zero => is_near(0.0).then_some(1.0),
        SwitchKind::Integers => Some(value.round()).filter(|&whole| is_near(whole)),
        SwitchKind::Knots(knots) => {
            let near = knots.iter().position(|&knot| is_near(knot));
            near.map(|k| (k + 1) as f64)
        }
    }
}

impl SwitchMonitor {
    /// Holds the pieces in which a state is; whether the motion agrees with them.
    pub(super) fn decide(&mut self, system: &mut dyn OdeSystem, at: &OdeState) -> Result<bool> {
        self.sliding = None;
        for switch in &mut self.switches {
            (switch.piece, switch.is_inside, switch.is_leaving) = (None, false, false);
        }
        // Those that depend on others, on the pieces of those: within a rounding of a bound a value may be on the other side of it.
        for _ in 0..=self.switches.len() {
            self.hold(system);
            let before = self.pieces();
            system.switch_values(at.t, &at.y, &mut self.values)?;
            for (switch, &value) in self.switches.iter_mut().zip(&self.values) {
                switch.piece = switch.kind.piece_at(value);
            }
            if self.pieces() == before {
                break;
            }
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
            return Ok(true);
        }
        // On a whole number, or a point of a table, a function is on the piece above it or below it, whichever the motion leads into.
        let is_on_bound = |k: &usize| {
            let (kind, value) = (&self.switches[*k].kind, self.values[*k]);
            *kind != SwitchKind::Zero && piece_above_bound(kind, value, 0.0).is_some()
        };
        moving.extend((0..all.len()).filter(is_on_bound));
        let moving = self.marked(moving.into_iter());
        let agrees = self.settle(&moving, &[], &mut changed, system, at)?;
        self.hold(system);
        Ok(agrees)
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

    /// Repeats the decisions that are `open` or depend on changed ones, so that the motion on all pieces agrees with them and, if
    /// possible, leads away from the switches that it has just `passed`. Further changes are marked, too. If no motion agrees, each
    /// function is decided by its own rate. Returns whether a motion agrees.
    ///
    /// # Errors
    /// Where the state cannot be evaluated.
    pub(super) fn settle(
        &mut self,
        open: &[bool],
        passed: &[(usize, bool)],
        changed: &mut [bool],
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<bool> {
        let signs = passed
            .iter()
            .map(|&(k, up)| (k, if up { 1.0 } else { -1.0 }));
        let mut choice = Choice {
            open,
            changed: changed.to_vec(),
            most: MAX_TOGETHER + passed.len(),
            ties: signs.collect(),
        };
        let mut agrees = self.choose(0, &mut choice, system, at)?;
        if !agrees {
            // The motion comes back to what it has passed, as one that slides does.
            choice.ties.clear();
            agrees = !passed.is_empty() && self.choose(0, &mut choice, system, at)?;
        }
        if !agrees {
            choice.most = 0;
            self.choose(0, &mut choice, system, at)?;
        }
        changed.copy_from_slice(&choice.changed);
        Ok(agrees)
    }

    /// Adds the operands of a passed switch that are passed within a rounding of the same time, because their decisions come first.
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
            let [value, rate] = self.rates_at(system, &crossing.state)?[j];
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

    /// Decides the switches from one on; whether the motion agrees.
    fn choose(
        &mut self,
        from: usize,
        choice: &mut Choice<'_>,
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<bool> {
        let is_due = |k: &usize| choice.open[*k] || self.switches[*k].depends_on(&choice.changed);
        let Some(k) = (from..self.switches.len()).find(is_due) else {
            return Ok(choice.most == 0 || self.agrees(&choice.ties, system, at)?);
        };
        let (before, was_passed, ties) =
            (self.switches[k].piece, choice.changed[k], choice.ties.len());
        self.switches[k].piece = None;
        let pieces = self.possible_pieces(k, was_passed, system, at)?;
        let is_tie = pieces.len() > 1;
        let tried = if ties < choice.most { pieces.len() } else { 1 };
        for &(piece, rate_sign) in &pieces[..tried] {
            self.switches[k].piece = piece;
            choice.changed[k] = piece != before;
            choice.ties.extend(is_tie.then_some((k, rate_sign)));
            if self.choose(k + 1, choice, system, at)? {
                let switch = &mut self.switches[k];
                (switch.switched, switch.chatter, switch.is_inside) = (None, None, false);
                return Ok(true);
            }
            choice.ties.truncate(ties);
        }
        (self.switches[k].piece, choice.changed[k]) = (before, was_passed);
        Ok(false)
    }

    /// The pieces on which a function may be, with the sign of its rate there: by its value on the pieces of its operands. On its bound, or
    /// after its passage, the piece to which it leads is first.
    fn possible_pieces(
        &mut self,
        k: usize,
        is_passed: bool,
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<Vec<(Option<f64>, f64)>> {
        self.hold(system);
        let near = if is_passed { PROBE } else { ON_BOUND };
        let [value, rate] = self.rates_at(system, at)?[k];
        let reach = near * self.step * rate;
        let kind = &self.switches[k].kind;
        let by_rate = kind.piece_at(value + reach);
        let Some(above) = piece_above_bound(kind, value, reach.abs()) else {
            return Ok(vec![(by_rate, 0.0)]);
        };
        Ok(match (kind, by_rate) {
            (SwitchKind::Zero, None) => [0.0, 1.0, -1.0].map(|side| (Some(side), side)).to_vec(),
            (SwitchKind::Zero, Some(side)) => {
                let sides = [side, -side, 0.0];
                sides.map(|side| (Some(side), side)).to_vec()
            }
            _ => {
                let mut sides = vec![(Some(above), 1.0), (Some(above - 1.0), -1.0)];
                if by_rate < Some(above) {
                    sides.reverse();
                }
                sides
            }
        })
    }

    /// Whether the rates of some functions shortly after a state, on the held pieces, have these signs.
    fn agrees(
        &mut self,
        ties: &[(usize, f64)],
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<bool> {
        if ties.is_empty() {
            return Ok(true);
        }
        self.hold(system);
        let rates = self.shortly_after(system, at)?;
        // A function that rests on a whole number, or a point of a table, is on the piece above it.
        Ok(ties.iter().all(|&(k, sign)| {
            let [_, rate] = rates[k];
            match self.switches[k].kind {
                SwitchKind::Zero if sign == 0.0 => rate == 0.0,
                SwitchKind::Zero => rate * sign > 0.0,
                SwitchKind::Integers | SwitchKind::Knots(_) => (rate < 0.0) == (sign < 0.0),
            }
        }))
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

    /// The rate of a function shortly after a state, held on a side of zero.
    fn rate_on(
        &mut self,
        side: f64,
        k: usize,
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<f64> {
        self.switches[k].piece = Some(side);
        self.hold(system);
        let [_, rate] = self.shortly_after(system, at)?[k];
        Ok(rate)
    }

    /// The values and the rates of all functions shortly after a state, on the held pieces. Functions that start at rest have moved there,
    /// too, by the second order of a step.
    fn shortly_after(
        &mut self,
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<Vec<[f64; 2]>> {
        let mut rates = vec![0.0; at.y.len()];
        system.rhs(at.t, &at.y, &mut rates)?;
        let h = PROBE * self.step;
        let along = |rates: &[f64]| -> Vec<f64> {
            let moved = at.y.iter().zip(rates).map(|(y, rate)| y + h * rate);
            moved.collect()
        };
        let (t, mut later) = (at.t + h, rates.clone());
        system.rhs(t, &along(&rates), &mut later)?;
        for (rate, later) in rates.iter_mut().zip(later) {
            *rate = 0.5 * (*rate + later);
        }
        let y = along(&rates);
        self.rates_at(system, &OdeState { t, y })
    }

    /// The values and the rates of all functions on the pieces that are held.
    pub(super) fn rates_at(
        &mut self,
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<Vec<[f64; 2]>> {
        let mut rates = vec![0.0; at.y.len()];
        system.rhs(at.t, &at.y, &mut rates)?;
        let mut functions = vec![[f64::NAN; 2]; self.switches.len()];
        system.switch_rates(at.t, &at.y, &rates, &mut functions)?;
        Ok(functions)
    }
}
