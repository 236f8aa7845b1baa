//! An integration that ends at each switch and begins again behind it, as one.

use crate::error::{DynamicsError, Result};
use crate::ode::{OdeState, Termination};
use crate::options::{Options, Statistics};

/// An integration in parts.
pub(crate) struct Parts {
    pub(crate) whole: Option<Termination>,
    /// Where the next part begins, and what is left for it.
    pub(crate) from: OdeState,
    pub(crate) remaining: Options,
    max_steps: usize,
}

impl Parts {
    pub(crate) fn new(start: &OdeState, options: &Options) -> Self {
        Self {
            whole: None,
            from: start.clone(),
            remaining: *options,
            max_steps: options.max_steps,
        }
    }

    /// Adds a part, at whose end the next begins; whether an error ended it.
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
        self.from.clone_from(&part.state);
        let steps = part.statistics.steps;
        self.remaining.max_steps = self.remaining.max_steps.saturating_sub(steps);
        let before = self.whole.take();
        let before = before.map_or_else(Statistics::default, |before| before.statistics);
        let last = self.whole.insert(Termination {
            statistics: before.plus(part.statistics),
            ..part
        });
        if let Some(DynamicsError::MaxStepsReached { max_steps, .. }) = &mut last.error {
            // Those of the whole motion.
            *max_steps = self.max_steps;
        }
        Ok(last.error.is_some())
    }
}

/// Refuses a start or an end that is not finite, or an end before the start.
pub(crate) fn check_interval(start: &OdeState, end: Option<f64>) -> Result<()> {
    for &value in std::iter::once(&start.t).chain(&start.y) {
        if !value.is_finite() {
            return Err(DynamicsError::BadOption {
                what: "the initial state",
                must: "finite number",
                value,
            });
        }
    }
    match end.filter(|end| !(end.is_finite() && *end > start.t)) {
        Some(value) => Err(DynamicsError::BadOption {
            what: "the end of the motion",
            must: "time after its start",
            value,
        }),
        None => Ok(()),
    }
}
