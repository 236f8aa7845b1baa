//! Joins the parts of an integration that ends at each switch and starts again after it.

use crate::error::{DynamicsError, Result, bad_option};
use crate::ode::{OdeState, Termination};
use crate::options::{Options, Statistics};

/// A part of an integration.
#[derive(Clone)]
pub(crate) struct Part {
    pub(crate) start: OdeState,
    /// Until when, s; none: until the observer stops it.
    pub(crate) end: Option<f64>,
    pub(crate) options: Options,
    /// The first step, s, if one is known.
    pub(crate) first_step: Option<f64>,
}

impl Part {
    /// Its duration, s; 1 s without an end.
    pub(crate) fn span(&self) -> f64 {
        let span = self.end.map_or(f64::INFINITY, |end| end - self.start.t);
        if span.is_finite() { span } else { 1.0 }
    }
}

/// An integration in parts.
pub(crate) struct Parts {
    pub(crate) whole: Option<Termination>,
    /// The next part: its start, and the remaining steps.
    pub(crate) next: Part,
    max_steps: usize,
}

impl Parts {
    pub(crate) fn new(all: Part) -> Self {
        Self {
            whole: None,
            max_steps: all.options.max_steps,
            next: all,
        }
    }

    /// Adds a part, at whose end the next starts; returns whether an error ended it.
    ///
    /// # Errors
    /// That of the first part.
    pub(crate) fn add(&mut self, part: Result<Termination>) -> Result<bool> {
        let part = match (part, &mut self.whole) {
            // Between two switches lies less than a rounding of time.
            (Err(DynamicsError::DurationTooShort), Some(_)) => return Ok(false),
            (Ok(part), Some(_)) if part.error == Some(DynamicsError::DurationTooShort) => {
                return Ok(false);
            }
            (Ok(part), _) => part,
            (Err(error), None) => return Err(error),
            (Err(error), Some(before)) => {
                before.error = Some(error);
                return Ok(true);
            }
        };
        self.next.start.clone_from(&part.state);
        let max_steps = &mut self.next.options.max_steps;
        *max_steps = max_steps.saturating_sub(part.statistics.steps);
        let before = self.whole.take();
        let before = before.map_or_else(Statistics::default, |before| before.statistics);
        let last = self.whole.insert(Termination {
            statistics: before.plus(part.statistics),
            ..part
        });
        if let Some(
            DynamicsError::MaxStepsReached { max_steps, .. }
            | DynamicsError::TooSlow { max_steps, .. },
        ) = &mut last.error
        {
            // Those of the whole motion.
            *max_steps = self.max_steps;
        }
        Ok(last.error.is_some())
    }
}

/// Refuses a start or an end that is not finite, or an end before the start.
pub(crate) fn check_interval(Part { start, end, .. }: &Part) -> Result<()> {
    for &value in std::iter::once(&start.t).chain(&start.y) {
        if !value.is_finite() {
            return bad_option("the initial state", "finite number", value);
        }
    }
    match end.filter(|end| !(end.is_finite() && *end > start.t)) {
        Some(value) => bad_option("the end of the motion", "time after its start", value),
        None => Ok(()),
    }
}
