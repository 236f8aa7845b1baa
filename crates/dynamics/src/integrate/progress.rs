//! Whether steps lead on. At a jump that nobody has named, as of a load that a program computes, the error control of every method makes them so
//! short that the end would never be reached, while each of them is kept.

use crate::error::{DynamicsError, Result};
use crate::integration_parts::Part;
use crate::ode::OdeState;

/// Steps by which the progress is judged.
const JUDGED_STEPS: usize = 10_000;
/// So many times the number of steps allowed, at the rate of the last ones, are never taken: what is stiff or moves fast for a while needs
/// less. Loads that a program computes are expected to jump.
const HOPELESS: f64 = 1000.0;

/// The progress of an integration.
pub(super) struct Progress {
    end: f64,
    max_steps: f64,
    /// The first load that a program computes.
    function: Option<usize>,
    /// The time at which the steps judged next begin, s, and their number so far.
    since: (f64, usize),
}

impl Progress {
    pub(super) fn new(part: &Part, function: Option<usize>) -> Self {
        let factor = if function.is_some() { 1.0 } else { HOPELESS };
        Self {
            // Where the user has set the longest step, that says how many there are.
            end: match part.options.max_step {
                None => part.end.unwrap_or(part.start.t),
                Some(_) => part.start.t,
            },
            max_steps: factor * part.options.max_steps as f64,
            function,
            since: (part.start.t, 0),
        }
    }

    /// After a step to a state.
    ///
    /// # Errors
    /// [`DynamicsError::NoProgress`].
    pub(super) fn step_taken(&mut self, now: &OdeState) -> Result<()> {
        self.since.1 += 1;
        if self.since.1 < JUDGED_STEPS {
            return Ok(());
        }
        let step = (now.t - self.since.0) / JUDGED_STEPS as f64;
        if self.end - now.t > self.max_steps * step {
            return Err(DynamicsError::NoProgress {
                function: self.function,
                t: now.t,
                step,
            });
        }
        self.since = (now.t, 0);
        Ok(())
    }
}
