//! Whether the steps of an integration make progress. At a jump that nobody has named, as of a load that a program computes, the error control of
//! every method makes them so short that the end would never be reached, while each of them is kept.

use crate::error::{DynamicsError, Result};
use crate::integration_parts::Part;
use crate::ode::OdeState;

/// Steps by which the progress is measured, without a load that a program computes and with one: that is expected to jump.
const STEPS: [usize; 2] = [10_000, 1000];
/// How many times the number of steps allowed it would take at their rate to reach the end: what is stiff or moves fast for a while needs less.
const HOPELESS: f64 = 1000.0;

/// The progress of an integration.
pub(super) struct Progress {
    end: f64,
    /// The highest number of steps at one rate.
    max_steps: f64,
    /// The first load that a program computes.
    function: Option<usize>,
    /// The time since which it is measured, s, and the number of steps since then.
    since: (f64, usize),
}

impl Progress {
    pub(super) fn new(part: &Part, function: Option<usize>) -> Self {
        Self {
            // Where the user has set the longest step, that says how many there are.
            end: match part.options.max_step {
                None => part
                    .end
                    .filter(|end| end.is_finite())
                    .unwrap_or(part.start.t),
                Some(_) => part.start.t,
            },
            max_steps: HOPELESS * part.options.max_steps as f64,
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
        let steps = STEPS[usize::from(self.function.is_some())];
        if self.since.1 < steps {
            return Ok(());
        }
        let step = (now.t - self.since.0) / steps as f64;
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
