//! Integration across the switches of loads and drives that coordinates and speeds decide.
//!
//! While the pieces are held, everything is smooth, and a step may lead beyond a switch. Where it does, the switch is
//! located on the dense output, the motion is kept up to there, and the next integration begins with the piece beyond.
//! Where the rates on both pieces lead back to the switch, as of a brake at rest, the motion [slides](crate::sliding_system)
//! along it. Where that is not so simple, the switch is not held until it has kept its side for some steps.

use crate::crossings::{are_together, fall_below_zero, first_of, passed_soon};
use crate::error::{DynamicsError, Result};
use crate::ode::{OdeState, OdeSystem, Step};
use crate::sliding::Sliding;
use crate::sliding_system::SlidingSystem;
use dwell_laws::SwitchKind;
use windows::Between;

mod decisions;
mod slide;
mod windows;

/// Step along the rates that shows on which side of a switch they lead, as a part of the step before: the next switch
/// may be near.
const PROBE: f64 = 1e-7;
/// A first step, as a part of the motion.
const FIRST_STEP: f64 = 1e-3;
/// Steps for which a switch that is not held must keep its side to be held again, at first.
const PATIENCE: u32 = 4;
/// Steps after which a switch to which its own pieces lead back is given up: they are short.
const CHATTER_STEPS: u32 = 10_000;

/// A distance that grows so from one quarter of a step to the next, twice, is none of rounding: one that grows with the square or a higher power of
/// time grows by 1.7 and more.
const GROWTH: f64 = 1.5;

/// Watches the switches of a system during its integration.
pub(crate) struct SwitchMonitor {
    switches: Vec<MonitoredSwitch>,
    values: Vec<f64>,
    /// Length of the last step, s.
    step: f64,
    /// Along which switch the motion slides.
    sliding: Option<Sliding>,
    /// The length of the motion, s.
    span: f64,
    between: Option<Between>,
    /// The state at which the values, and the last sample between, are those on the held pieces: a step starts at the end of the
    /// last one.
    seen_at: Option<OdeState>,
}

#[derive(Debug, Clone)]
struct MonitoredSwitch {
    kind: SwitchKind,
    /// The switches whose pieces its value depends on: its operands', which come before it.
    inner: Vec<usize>,
    /// The piece that is held; `None` if it is not.
    piece: Option<f64>,
    /// Whether the piece has held since the integration began: at its start a switch may be within a rounding.
    is_inside: bool,
    /// Whether the motion has just left it after sliding along it: its function grows from zero with a rate of zero, and below its
    /// rounding only the rate decides the side.
    is_leaving: bool,
    /// Time of its last switch, s.
    switched: Option<f64>,
    /// If it is not held: its piece, the number of steps on this piece, and the number that is required.
    observed: (Option<f64>, u32),
    /// Steps since its own pieces led back to it; `None` if they do not.
    chatter: Option<u32>,
    patience: u32,
    /// Distances from the nearest bound at the last points of the step, the latest first.
    margins: [(f64, f64); 2],
}

/// Where an integration ends because a switch is passed.
pub(crate) struct Crossing {
    pub(crate) state: OdeState,
    /// The switches, and whether each passes its upper bound.
    passed: Vec<(usize, bool)>,
    /// The change of a motion that slides along a switch.
    slide: Option<SlideChange>,
}

/// The change of a motion that slides along a switch.
#[derive(Debug, Clone, Copy)]
enum SlideChange {
    /// It leaves the switch, upwards or not.
    Leaves(bool),
    /// Another switch is passed, upwards or not, on one side alone: the load on that side changes.
    PassesBeside {
        side: usize,
        switch: usize,
        upward: bool,
    },
}

impl Crossing {
    /// The load that switches, if one does.
    pub(crate) fn source(&self, system: &dyn OdeSystem) -> Option<usize> {
        let first = self.passed.first();
        first.map(|(k, _)| system.switch_source(*k))
    }
}

impl MonitoredSwitch {
    /// How far the value is within the bounds of the piece; negative beyond one. `None` if it is not watched.
    fn margin(&self, value: f64) -> Option<f64> {
        let [low, high] = self.kind.bounds(self.piece?);
        let margin = (value - low).min(high - value);
        (!margin.is_nan()).then_some(margin)
    }

    /// Whether a value beyond the bounds is beyond the upper one.
    fn is_above(&self, value: f64) -> bool {
        let [low, high] = self.kind.bounds(self.piece.unwrap_or_default());
        value - low > high - value
    }

    /// Whether its value depends on the piece of one of these switches.
    fn depends_on(&self, changed: &[bool]) -> bool {
        self.inner.iter().any(|&j| changed[j])
    }
}

impl SwitchMonitor {
    /// Holds the pieces at the start of an integration of `span` (s).
    ///
    /// # Errors
    /// Where the start cannot be evaluated.
    pub(crate) fn new(system: &mut dyn OdeSystem, start: &OdeState, span: f64) -> Result<Self> {
        let kinds = system.switch_kinds().iter().enumerate();
        let switches = kinds.map(|(k, kind)| MonitoredSwitch {
            kind: kind.clone(),
            inner: system.switch_operands(k),
            piece: None,
            is_inside: false,
            is_leaving: false,
            switched: None,
            observed: (None, 0),
            chatter: None,
            patience: PATIENCE,
            margins: [(f64::NAN, f64::NAN); 2],
        });
        let switches: Vec<_> = switches.collect();
        let mut monitor = Self {
            values: vec![0.0; switches.len()],
            switches,
            step: FIRST_STEP * span,
            sliding: None,
            span,
            between: Between::of(system),
            seen_at: None,
        };
        monitor.decide(system, start)?;
        Ok(monitor)
    }

    /// Along which switch the motion slides.
    pub(crate) fn sliding(&self) -> Option<&Sliding> {
        self.sliding.as_ref()
    }

    /// Called after speeds or modes have jumped between two states of one time: the switches start again if one of them
    /// has jumped, too, or no longer holds the motion.
    ///
    /// # Errors
    /// Where a state cannot be evaluated.
    pub(crate) fn continue_after(
        &mut self,
        system: &mut dyn OdeSystem,
        before: &OdeState,
        now: &OdeState,
    ) -> Result<()> {
        /// A change below this part of a function is rounding.
        const ROUNDING: f64 = 1e-12;
        if self.switches.is_empty() {
            return Ok(());
        }
        self.hold(system);
        let mut values = self.values.clone();
        system.switch_values(before.t, &before.y, &mut values)?;
        system.switch_values(now.t, &now.y, &mut self.values)?;
        let jumps = |(before, now): (&f64, &f64)| {
            (before - now).abs() > ROUNDING * before.abs().max(now.abs())
        };
        if self.sliding.is_some() || values.iter().zip(&self.values).any(jumps) {
            self.decide(system, now)?;
        }
        Ok(())
    }

    fn hold(&mut self, system: &mut dyn OdeSystem) {
        self.seen_at = None;
        system.hold_pieces(&self.pieces());
    }

    /// By switch: the piece that is held, if one is.
    pub(crate) fn pieces(&self) -> Vec<Option<f64>> {
        self.switches.iter().map(|s| s.piece).collect()
    }

    /// The state at which the integration restarts after a step, because a switch was passed, or a switch becomes held.
    ///
    /// # Errors
    /// Where a state cannot be evaluated.
    pub(crate) fn after_step(
        &mut self,
        system: &mut SlidingSystem<'_, '_>,
        step: &mut Step<'_>,
    ) -> Result<Option<Crossing>> {
        if self.goes_straight_on(system, step)? {
            return Ok(None);
        }
        let crossing = self.first_crossing(system, step)?;
        let crossing = self.earlier_between(crossing, system, step)?;
        let until = crossing.as_ref().map_or(step.now, |c| &c.state);
        if let Some(leaving) = self.leaving(system, &mut step.until(until))? {
            return Ok(Some(leaving));
        }
        if crossing.is_some() || !self.holds_again(system, step.now)? {
            return Ok(crossing);
        }
        Ok(Some(Crossing::begin_anew(step.now.clone())))
    }

    /// The first passage of a switch in a step, if there is one.
    fn first_crossing(
        &mut self,
        system: &mut dyn OdeSystem,
        step: &mut Step<'_>,
    ) -> Result<Option<Crossing>> {
        if self.switches.is_empty() && self.between.is_none() {
            return Ok(None);
        }
        self.step = step.duration();
        let start = step.before;
        if self.seen_at.take().is_some_and(|seen| seen == *start) {
            self.repeat_last_sample();
        } else {
            system.switch_values(start.t, &start.y, &mut self.values)?;
            self.sample(0, system);
        }
        for (switch, &value) in self.switches.iter_mut().zip(&self.values) {
            let margin = switch.margin(value).unwrap_or(f64::NAN);
            switch.margins = [(start.t, margin), (f64::NAN, f64::NAN)];
            switch.is_inside |= margin > 0.0 && !switch.is_leaving;
        }
        for (point, t) in step.root_subintervals().enumerate() {
            let state = step.state_at(t)?;
            system.switch_values(t, &state.y, &mut self.values)?;
            self.sample(point + 1, system);
            let each = 0..self.switches.len();
            let times = each.map(|k| self.crossing_time(k, t, system, step));
            if let Some((at, passed)) = first_of(times)? {
                let (state, slide) = (step.state_from_start(at)?, None);
                return Ok(Some(Crossing {
                    state,
                    passed,
                    slide,
                }));
            }
        }
        self.seen_at = Some(step.now.clone());
        Ok(None)
    }

    /// When a switch is passed between the last point of the step and `t`: with its index, and whether upwards.
    fn crossing_time(
        &mut self,
        k: usize,
        t: f64,
        system: &mut dyn OdeSystem,
        step: &mut Step<'_>,
    ) -> Result<Option<(f64, (usize, bool))>> {
        let value = self.values[k];
        if self.switches[k].is_leaving
            && self.goes_on_leaving(k, value, system, &step.state_at(t)?)?
        {
            return Ok(None);
        }
        let switch = &mut self.switches[k];
        let Some(margin) = switch.margin(value) else {
            return Ok(None);
        };
        let earlier = switch.margins;
        switch.margins = [(t, margin), earlier[0]];
        let was_inside = switch.is_inside;
        switch.is_inside |= margin > 0.0;
        let (mut values, mut beyond) = (Vec::new(), None);
        let mut margin_at = |at: f64| -> Result<f64> {
            let state = step.state_from_start(at)?;
            values.resize(self.values.len(), 0.0);
            system.switch_values(at, &state.y, &mut values)?;
            beyond.get_or_insert(values[k]);
            Ok(switch.margin(values[k]).unwrap_or(f64::NAN))
        };
        let found = if margin < 0.0 && !was_inside {
            passed_soon([earlier[0].0, t], &mut margin_at)?
        } else {
            fall_below_zero(earlier, (t, margin), margin_at)?
        };
        let upward = switch.is_above(if was_inside {
            beyond.unwrap_or(value)
        } else {
            value
        });
        Ok(found.map(|at| (at, (k, upward))))
    }

    /// Whether the rates at a state lead away from a switch that the motion has left, until its distance has grown from point to point.
    fn goes_on_leaving(
        &mut self,
        k: usize,
        value: f64,
        system: &mut dyn OdeSystem,
        at: &OdeState,
    ) -> Result<bool> {
        let mut rates = vec![0.0; at.y.len()];
        let mut functions = vec![[0.0; 2]; self.switches.len()];
        system.rhs(at.t, &at.y, &mut rates)?;
        let is_known = system.switch_rates(at.t, &at.y, &rates, &mut functions)?;
        let switch = &mut self.switches[k];
        let (margin, [_, rate]) = (switch.margin(value).unwrap_or(f64::NAN), functions[k]);
        let leads_away = is_known && (rate < 0.0) == switch.is_above(value) && rate != 0.0;
        let [last, before] = switch.margins;
        let has_grown = before.1 > 0.0 && last.1 > GROWTH * before.1 && margin > GROWTH * last.1;
        switch.is_leaving = leads_away && !has_grown;
        if leads_away {
            switch.margins = [(at.t, margin), last];
            switch.is_inside = has_grown;
        }
        Ok(leads_away)
    }

    /// Holds the pieces beyond a crossing, unless the rates there lead back: then the motion slides, from the state that is
    /// put exactly on the switch.
    ///
    /// # Errors
    /// Where the state cannot be evaluated; [`DynamicsError::SlidesOnSeveral`].
    pub(crate) fn pass(
        &mut self,
        crossing: &mut Crossing,
        system: &mut dyn OdeSystem,
    ) -> Result<()> {
        for switch in &mut self.switches {
            switch.is_inside = false;
        }
        if let Some(change) = crossing.slide {
            return self.change_slide(change, system, &crossing.state);
        }
        let before: Vec<Option<f64>> = self.pieces();
        self.add_operands(crossing, system)?;
        for &(k, upward) in &crossing.passed {
            let switch = &mut self.switches[k];
            switch.piece = switch.piece.map(|piece| switch.kind.next(piece, upward));
        }
        // What depends on another one that is passed is decided with it.
        let mut changed = self.marked(crossing.passed.iter().map(|(k, _)| *k));
        let all = changed.clone();
        let is_independent = |(k, _): &(usize, bool)| !self.switches[*k].depends_on(&all);
        crossing.passed.retain(is_independent);
        if self.sliding.is_some() {
            return self.pass_while_sliding(crossing, &all, system);
        }
        let none = self.marked(std::iter::empty());
        let (passed, at) = (&crossing.passed, &crossing.state);
        self.settle(&none, passed, &mut changed, system, at)?;
        if self.slide_from_crossing(&before, crossing, system)? {
            return Ok(());
        }
        self.hold(system);
        let rates = self.rates_at(system, &crossing.state)?;
        if self.rest(before, crossing, &rates, system)? {
            return Ok(());
        }
        self.release(crossing, &rates);
        self.hold(system);
        Ok(())
    }

    /// Releases a switch to which the motion returns, and everything that depends on it.
    fn release(&mut self, crossing: &Crossing, rates: &[[f64; 2]]) {
        let t = crossing.state.t;
        let mut released = self.marked(std::iter::empty());
        for &(k, upward) in &crossing.passed {
            // Not by a step along the rates: it may lead through a window.
            let returns = if upward {
                rates[k][1] < 0.0
            } else {
                rates[k][1] > 0.0
            };
            let switch = &mut self.switches[k];
            let again = |last: f64| are_together(t, last);
            if returns || switch.switched.is_some_and(again) {
                switch.piece = None;
                switch.observed = (None, 0);
                switch.chatter = Some(0);
                released[k] = true;
            }
            switch.switched = Some(t);
        }
        for (k, switch) in self.switches.iter_mut().enumerate() {
            if switch.depends_on(&released) {
                (switch.piece, switch.observed) = (None, (None, 0));
                released[k] = true;
            }
        }
    }

    /// Called after a step: whether a switch that is not held has kept its side for so long that it is held again, so
    /// that the integration restarts.
    ///
    /// # Errors
    /// [`DynamicsError::Chatters`]; where the state cannot be evaluated.
    fn holds_again(&mut self, system: &mut dyn OdeSystem, now: &OdeState) -> Result<bool> {
        if self.switches.iter().all(|s| s.piece.is_some()) {
            return Ok(false);
        }
        system.switch_values(now.t, &now.y, &mut self.values)?;
        let mut changed = false;
        for (k, (switch, &value)) in self.switches.iter_mut().zip(&self.values).enumerate() {
            let slides = |sliding: &Sliding| sliding.decides(k);
            if switch.piece.is_some() || self.sliding.as_ref().is_some_and(slides) {
                continue;
            }
            if let Some(steps) = &mut switch.chatter {
                *steps += 1;
                if *steps > CHATTER_STEPS {
                    let source_index = system.switch_source(k);
                    return Err(DynamicsError::Chatters {
                        source_index,
                        t: now.t,
                    });
                }
            }
            let piece = switch.kind.piece_at(value);
            let (last, steps) = switch.observed;
            switch.observed = (piece, if piece == last { steps + 1 } else { 0 });
            if piece.is_some() && switch.observed.1 >= switch.patience {
                switch.piece = piece;
                switch.chatter = None;
                switch.patience = switch.patience.saturating_mul(2);
                changed = true;
            }
        }
        if changed {
            self.hold(system);
        }
        Ok(changed)
    }
}
