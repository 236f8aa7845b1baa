//! Start and end of sliding motions along a switch.

use super::{Crossing, PROBE, SlideChange, SwitchMonitor};
use crate::error::{DynamicsError, Result};
use crate::ode::{OdeState, OdeSystem, Step};
use crate::sliding::{SideRates, Sliding};
use crate::sliding_system::{BothSides, SlidingSystem};
use dwell_laws::SwitchKind;
use dwell_numerics::root;

/// A function whose rate in a sliding motion is below this part of its rates on both sides stays at its switch, too.
const STAYS: f64 = 1e-6;
/// A distance from the switch, by rounding, decays so often in the motion.
const DECAY: f64 = 10.0;
/// A state is put on a bound so often until no rounding is left.
const ROUNDINGS: usize = 4;

impl BothSides {
    /// Whether a function keeps its value where the upper side has this part.
    fn stays(&self, k: usize, part: f64) -> bool {
        let [[_, lower], [_, upper]] = self.of(k).sides;
        let rate = lower + part * (upper - lower);
        rate.abs() <= STAYS * (lower.abs() + upper.abs())
    }

    /// Puts a state exactly on a bound of a switch, along the difference of the rates.
    fn put_on_switch(&self, k: usize, bound: f64, at: &mut OdeState) {
        let [[value, lower], [_, upper]] = self.of(k).sides;
        let shift = (value - bound) / (lower - upper);
        let [lower, upper] = &self.rates;
        for (y, (lower, upper)) in at.y.iter_mut().zip(lower.iter().zip(upper)) {
            *y += shift * (upper - lower);
        }
    }
}

impl SwitchMonitor {
    /// Begins to slide where the rates on both sides of a crossing lead back to it; whether it does.
    ///
    /// # Errors
    /// Where the state cannot be evaluated.
    pub(super) fn slide_from_crossing(
        &mut self,
        before: &[Option<f64>],
        crossing: &mut Crossing,
        system: &mut dyn OdeSystem,
    ) -> Result<bool> {
        let Some(&(first, upward)) = crossing.passed.first() else {
            return Ok(false);
        };
        let Some(piece) = before[first] else {
            return Ok(false);
        };
        let value = self.switches[first].kind.bounds(piece)[usize::from(upward)];
        let mut sides = [before.to_vec(), self.pieces()];
        if !upward {
            sides.reverse();
        }
        let switches = crossing.passed.iter().map(|(k, _)| *k).collect();
        self.slide(sides, switches, value, system, &mut crossing.state)
    }

    /// If a passed switch has no rate after the passage, puts the state exactly on it, where comparisons hold by equality. Returns
    /// whether the motion rests there: at a rounding beside the switch, it would be held on neither piece.
    pub(super) fn rest(
        &mut self,
        before: Vec<Option<f64>>,
        crossing: &mut Crossing,
        rates: &[[f64; 2]],
        system: &mut dyn OdeSystem,
    ) -> Result<bool> {
        let rests = |(k, _): &&(usize, bool)| rates[*k][1] == 0.0 && before[*k].is_some();
        let Some(&(k, upward)) = crossing.passed.iter().find(rests) else {
            return Ok(false);
        };
        let piece = before[k].unwrap_or_default();
        let bound = self.switches[k].kind.bounds(piece)[usize::from(upward)];
        let (sides, mut at) = ([before, self.pieces()], crossing.state.clone());
        for _ in 0..ROUNDINGS {
            let Some(both) = BothSides::at(&sides, system, &at)? else {
                break;
            };
            let [[_, came], [value, left]] = both.of(k).sides;
            if came == 0.0 || left != 0.0 {
                break;
            }
            if value != bound {
                both.put_on_switch(k, bound, &mut at);
                continue;
            }
            if !self.decide(system, &at)? {
                // It rests behind the bound, and not on it.
                self.take(&sides[1]);
                self.hold(system);
            }
            crossing.state = at;
            return Ok(true);
        }
        self.hold(system);
        Ok(false)
    }

    /// Begins to slide at a state exactly on some switches; whether it does.
    ///
    /// # Errors
    /// Where the state cannot be evaluated.
    pub(super) fn slide_from_rest(
        &mut self,
        undecided: &[usize],
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<bool> {
        let Some(&first) = undecided.first() else {
            return Ok(false);
        };
        // Which of the others pass zero upwards where the first one does: by what its sides do to their rates.
        let mut sides = [self.pieces(), self.pieces()];
        sides[0][first] = Some(-1.0);
        sides[1][first] = Some(1.0);
        let Some(both) = BothSides::at(&sides, system, at)? else {
            return Ok(false);
        };
        let change = |k: usize| {
            let [[_, lower], [_, upper]] = both.of(k).sides;
            upper - lower
        };
        let mut switches = vec![first];
        for &k in &undecided[1..] {
            let same = change(k) * change(first);
            if same == 0.0 || same.is_nan() || self.switches[k].kind != SwitchKind::Zero {
                return Ok(false);
            }
            sides[0][k] = Some(-same.signum());
            sides[1][k] = Some(same.signum());
            switches.push(k);
        }
        let before = self.pieces();
        for side in &mut sides {
            self.take(side);
            let mut changed = self.marked(switches.iter().copied());
            let none = self.marked(std::iter::empty());
            self.settle(&none, &[], &mut changed, system, at)?;
            *side = self.pieces();
        }
        self.take(&before);
        self.slide(sides, switches, 0.0, system, &mut at.clone())
    }

    /// Slides along switches, if both sides lead back to the first of them and the others stay with it.
    fn slide(
        &mut self,
        mut sides: [Vec<Option<f64>>; 2],
        switches: Vec<usize>,
        value: f64,
        system: &mut dyn OdeSystem,
        at: &mut OdeState,
    ) -> Result<bool> {
        let Some(both) = BothSides::at(&sides, system, at)? else {
            return Ok(false);
        };
        self.decide_by_values(&mut sides, &switches, &both, system, at)?;
        let Some(both) = BothSides::at(&sides, system, at)? else {
            return Ok(false);
        };
        let first = both.of(switches[0]);
        let part = first.upper_part();
        let together = switches[1..].iter().all(|&k| both.stays(k, part));
        if !(first.both_return() && together) {
            return Ok(false);
        }
        let sliding = Sliding {
            sides,
            switches,
            value,
            decay: DECAY / self.span,
        };
        both.put_on_switch(sliding.switches[0], value, at);
        system.record_sliding(at, sliding.switches[0], Some(&sliding));
        self.watch_others(&sliding);
        self.hold(system);
        self.sliding = Some(sliding);
        Ok(true)
    }

    /// Decides the functions that depend on a switch by the values on each side of it: the motions on both sides may
    /// lead back.
    fn decide_by_values(
        &self,
        sides: &mut [Vec<Option<f64>>; 2],
        switches: &[usize],
        both: &BothSides,
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<()> {
        // Across the switch, along the difference of the rates on its sides.
        let [lower, upper] = &both.rates;
        let across = |y: &f64, k: usize, h: f64| y + h * (upper[k] - lower[k]);
        let h = PROBE * self.step;
        let beside = [-h, h].map(|h| {
            let all = at.y.iter().enumerate();
            all.map(|(k, y)| across(y, k, h)).collect::<Vec<f64>>()
        });
        let mut values = [(); 2].map(|()| vec![f64::NAN; self.switches.len()]);
        for (number, pieces) in sides.iter_mut().enumerate() {
            let mut changed = self.marked(switches.iter().copied());
            let mut anew = self.marked(std::iter::empty());
            for (k, switch) in self.switches.iter().enumerate() {
                if changed[k] || !switch.depends_on(&changed) {
                    continue;
                }
                changed[k] = true;
                system.hold_pieces(pieces);
                for (y, values) in beside.iter().zip(&mut values) {
                    system.switch_values(at.t, y, values)?;
                }
                let [below, above] = [&values[0], &values[1]];
                let first = switches[0];
                let is_above = (number == 1) == (above[first] > below[first]);
                let own = [below[k], above[k]].map(|value| switch.kind.piece_at(value));
                // What depends on one that is decided otherwise here is decided here, too.
                if own[0] != own[1] || switch.depends_on(&anew) {
                    let before = pieces[k];
                    pieces[k] = own[usize::from(is_above)].or(before);
                    anew[k] = pieces[k] != before;
                }
            }
        }
        Ok(())
    }

    /// Watches the switches that are the same on both sides alone.
    fn watch_others(&mut self, sliding: &Sliding) {
        self.take(&sliding.sides[0]);
        for (k, switch) in self.switches.iter_mut().enumerate() {
            switch.piece = switch.piece.filter(|_| !sliding.decides(k));
        }
    }

    /// The change of a sliding motion in a step: it leaves its switch, or another switch is passed on one side alone.
    ///
    /// # Errors
    /// Where a state cannot be evaluated.
    pub(super) fn leaving(
        &mut self,
        system: &mut SlidingSystem<'_, '_>,
        step: &mut Step<'_>,
    ) -> Result<Option<Crossing>> {
        if self.sliding.is_none() {
            return Ok(None);
        }
        let beside = self.passing_beside(system, step)?;
        let until = beside.as_ref().map_or(step.now, |c| &c.state);
        let mut from = step.before.t;
        let mut step = step.until(until);
        let times = step.root_subintervals();
        let mut sides_at = |t: f64| -> Result<(OdeState, Option<SideRates>)> {
            let state = step.state_from_start(t)?;
            let sides = system.side_rates(t, &state.y)?;
            Ok((state, sides))
        };
        let margin = |sides: Option<SideRates>| sides.map_or(f64::NAN, |sides| sides.margin());
        for t in times {
            let (_, sides) = sides_at(t)?;
            if margin(sides) >= 0.0 || sides.is_none() {
                from = t;
                continue;
            }
            let margin_at = |t: f64| -> Result<f64> { Ok(margin(sides_at(t)?.1)) };
            let found = root::find(margin_at, from, t)?;
            let (state, sides) = sides_at(found.unwrap_or(from))?;
            let upward = sides.is_some_and(|sides| sides.leaves_upward());
            return Ok(Some(Crossing {
                state,
                passed: Vec::new(),
                slide: Some(SlideChange::Leaves(upward)),
            }));
        }
        Ok(beside)
    }

    /// The first time in a step at which a switch that depends on the side leaves its piece on that side: the function of a load beside the
    /// switch changes although the motion does not go there.
    fn passing_beside(
        &self,
        system: &mut SlidingSystem<'_, '_>,
        step: &mut Step<'_>,
    ) -> Result<Option<Crossing>> {
        let start = system.margins_beside(step.before.t, &step.before.y)?;
        let mut from = step.before.t;
        if start.is_empty() {
            return Ok(None);
        }
        for t in step.root_subintervals() {
            let state = step.state_at(t)?;
            let now = system.margins_beside(t, &state.y)?;
            let mut first: Option<(f64, SlideChange)> = None;
            let passed = |k: &usize| start[*k].margin > 0.0 && now[*k].margin < 0.0;
            for k in (0..now.len()).filter(passed) {
                let margin_at = |t: f64| -> Result<f64> {
                    let state = step.state_from_start(t)?;
                    Ok(system.margins_beside(t, &state.y)?[k].margin)
                };
                let at = root::find(margin_at, from, t)?.unwrap_or(t);
                if first.is_none_or(|(before, _)| at < before) {
                    let change = SlideChange::PassesBeside {
                        side: now[k].side,
                        switch: now[k].switch,
                        upward: now[k].upward,
                    };
                    first = Some((at, change));
                }
            }
            if let Some((at, change)) = first {
                return Ok(Some(Crossing {
                    state: step.state_from_start(at)?,
                    passed: Vec::new(),
                    slide: Some(change),
                }));
            }
            from = t;
        }
        Ok(None)
    }

    /// Takes a change of a sliding motion.
    ///
    /// # Errors
    /// Where the state cannot be evaluated; [`DynamicsError::SlidesOnSeveral`].
    pub(super) fn change_slide(
        &mut self,
        change: SlideChange,
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<()> {
        let (side, k, upward) = match change {
            SlideChange::Leaves(upward) => {
                self.leave(upward, system, at);
                return Ok(());
            }
            SlideChange::PassesBeside {
                side,
                switch,
                upward,
            } => (side, switch, upward),
        };
        let Some(mut sliding) = self.sliding.take() else {
            return Ok(());
        };
        self.take(&sliding.sides[side]);
        let switch = &mut self.switches[k];
        switch.piece = switch.piece.map(|piece| switch.kind.next(piece, upward));
        let (none, mut changed) = (
            self.marked(std::iter::empty()),
            self.marked([k].into_iter()),
        );
        self.settle(&none, &[], &mut changed, system, at)?;
        sliding.sides[side] = self.pieces();
        self.slide_on(sliding, &[], system, at)
    }

    /// Holds the side to which the motion leaves its switch.
    pub(super) fn leave(&mut self, upward: bool, system: &mut dyn OdeSystem, at: &OdeState) {
        if let Some(sliding) = self.sliding.take() {
            for (k, switch) in self.switches.iter_mut().enumerate() {
                if sliding.decides(k) {
                    switch.piece = sliding.sides[usize::from(upward)][k];
                    (switch.switched, switch.chatter) = (None, None);
                    switch.is_leaving = true;
                }
            }
            system.record_sliding(at, sliding.switches[0], None);
        }
        self.hold(system);
    }

    /// Passes another switch while the motion slides: it slides on, leaves its switch, or the two hold it together.
    ///
    /// # Errors
    /// [`DynamicsError::SlidesOnSeveral`]; where the state cannot be evaluated.
    pub(super) fn pass_while_sliding(
        &mut self,
        crossing: &Crossing,
        passed: &[bool],
        system: &mut dyn OdeSystem,
    ) -> Result<()> {
        let Some(mut sliding) = self.sliding.take() else {
            return Ok(());
        };
        let at = &crossing.state;
        let beside = self.pieces();
        let decided: Vec<bool> = (0..beside.len()).map(|k| sliding.decides(k)).collect();
        for side in &mut sliding.sides {
            for (k, piece) in side.iter_mut().enumerate() {
                *piece = if decided[k] { *piece } else { beside[k] };
            }
            self.take(side);
            let none = self.marked(std::iter::empty());
            self.settle(&none, &[], &mut passed.to_vec(), system, at)?;
            *side = self.pieces();
        }
        self.slide_on(sliding, &crossing.passed, system, at)
    }

    /// Continues the sliding with other pieces on the sides, after some switches are `passed`; or leaves the switch.
    fn slide_on(
        &mut self,
        sliding: Sliding,
        passed: &[(usize, bool)],
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<()> {
        self.watch_others(&sliding);
        let first = sliding.switches[0];
        let source_index = system.switch_source(first);
        let several = DynamicsError::SlidesOnSeveral {
            source_index,
            t: at.t,
        };
        let Some(both) = BothSides::at(&sliding.sides, system, at)? else {
            return Err(several);
        };
        let rates = both.of(first);
        let (stays, leaves_upward) = (rates.margin() > 0.0, rates.leaves_upward());
        let part = if stays {
            rates.upper_part()
        } else {
            f64::from(leaves_upward)
        };
        for &(k, upward) in passed {
            let [[_, lower], [_, upper]] = both.of(k).sides;
            let rate = lower + part * (upper - lower);
            if (rate < 0.0) == upward {
                return Err(several);
            }
        }
        self.sliding = Some(sliding);
        if stays {
            self.hold(system);
        } else {
            self.leave(leaves_upward, system, at);
        }
        Ok(())
    }

    /// Refuses a change of contacts in a sliding motion.
    ///
    /// # Errors
    /// [`DynamicsError::SlidesOnSeveral`].
    pub(crate) fn refuse_to_slide(&self, system: &dyn OdeSystem, t: f64) -> Result<()> {
        self.sliding.as_ref().map_or(Ok(()), |sliding| {
            let source_index = system.switch_source(sliding.switches[0]);
            Err(DynamicsError::SlidesOnSeveral { source_index, t })
        })
    }
}
