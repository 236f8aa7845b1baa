//! Whether an integration comes to its end in the steps that are allowed.
//!
//! Steps are counted in windows. Where one window has led so short a way that the rest would take many times the steps allowed, the
//! integration ends at once: it would end there a little later, after the last step allowed.

use crate::error::{DynamicsError, Result};
use crate::integration_parts::Part;

/// The steps allowed are so many windows.
const WINDOWS: usize = 40;
/// The pace of fewer steps shows nothing.
const MIN_WINDOW: usize = 5;
/// A pace at which the rest takes so many times the steps allowed is too slow: what only begins slowly becomes faster by less.
const TOO_MANY: f64 = 20.0;

/// Switches are counted by so many.
const SWITCHES: usize = 2000;
/// As `TOO_MANY`, of switches, each of which costs more than a step.
const TOO_MANY_SWITCHES: f64 = 1.0;

/// The steps of an integration, and how far the last of them have led.
#[derive(Debug, Clone)]
pub(crate) struct Pace {
    end: f64,
    max_steps: usize,
    steps: usize,
    /// When the window began, s.
    from: f64,
}

impl Pace {
    /// Of an integration that begins.
    pub(crate) fn new(of: &Part) -> Self {
        Self {
            // Without an end nothing is left that could take too long.
            end: of
                .end
                .filter(|end| end.is_finite())
                .unwrap_or(f64::NEG_INFINITY),
            max_steps: of.options.max_steps,
            steps: 0,
            from: of.start.t,
        }
    }

    /// The steps so far.
    pub(crate) fn steps(&self) -> usize {
        self.steps
    }

    /// Whether the rest, from a time (s), takes more than so many times the steps allowed if some steps lead on by `advance`, s.
    pub(crate) fn is_too_slow(&self, (t, times): (f64, f64), steps: usize, advance: f64) -> bool {
        (self.end - t) * steps as f64 > advance * times * self.max_steps as f64
    }

    /// After a step that has ended at a time, s. The first window does not count: a method begins with short steps.
    ///
    /// # Errors
    /// [`DynamicsError::TooSlow`].
    #[inline]
    pub(crate) fn step_taken(&mut self, t: f64) -> Result<()> {
        self.count((t, TOO_MANY), self.max_steps / WINDOWS)
    }

    /// The same after a switch, where switches are counted instead of steps: next to where they accumulate there is one in each step.
    ///
    /// # Errors
    /// [`DynamicsError::TooSlow`].
    pub(crate) fn switch_passed(&mut self, t: f64) -> Result<()> {
        self.count((t, TOO_MANY_SWITCHES), SWITCHES)
    }

    #[inline]
    fn count(&mut self, (t, times): (f64, f64), window: usize) -> Result<()> {
        self.steps += 1;
        if window < MIN_WINDOW || !self.steps.is_multiple_of(window) {
            return Ok(());
        }
        let advance = t - std::mem::replace(&mut self.from, t);
        if self.steps == window || !self.is_too_slow((t, times), window, advance) {
            return Ok(());
        }
        Err(DynamicsError::TooSlow {
            t,
            steps: self.steps,
            needed: (self.end - t) / advance * window as f64,
            max_steps: self.max_steps,
        })
    }
}
