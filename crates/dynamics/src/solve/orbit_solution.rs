//! The solution along an orbit of a machine, which is known at every time: no integration.

use super::orbit_events::OrbitEvents;
use super::{Event, Observed, Solution};
use crate::error::Result;
use crate::ode::OdeState;
use crate::options::{Options, Statistics};
use crate::orbit::Orbit;

/// Parts of the first period whose ends are among the steps: every later period is like it.
const PARTS: usize = 64;

/// The solution along an orbit until `end` (s), or until a terminal event, at a cost proportional to its samples and
/// events, independent of the number of periods. The tolerances of the options are the error of the orbit, by which an
/// event must pass its value.
///
/// # Errors
/// [`DynamicsError`](crate::DynamicsError) where the start cannot be evaluated, or an option cannot be used. If there
/// are more events than can be stored, [`Solution::error`] has the error, and the solution ends there.
pub fn solve_orbit<O: Observed>(
    orbit: &Orbit,
    observed: O,
    end: f64,
    options: &Options,
    events: &[Event<O::Coordinate>],
) -> Result<Solution> {
    options.check()?;
    // As given: a speed of zero is no rounding of one.
    let start = OdeState::from(orbit.initial_state());
    let found = OrbitEvents::find(orbit, observed, end, options, events)?;
    let terminated_by_event = matches!(found.end, Some((_, None)));
    let (last, error) = found.end.unwrap_or_else(|| (point(orbit, end), None));
    let mut samples = Vec::new();
    if let Some(sample_interval) = options.sample_interval {
        samples.push(start.clone());
        let times = (1_u32..).map(|k| start.t + sample_interval * f64::from(k));
        samples.extend(times.take_while(|&t| t <= last.t).map(|t| point(orbit, t)));
    }
    let parts = orbit.times_of_parts(PARTS).into_iter();
    let parts = parts.map(|after| point(orbit, start.t + after));
    let mut steps: Vec<OdeState> = samples.iter().skip(1).cloned().chain(parts).collect();
    steps.retain(|step| step.t > start.t && step.t < last.t);
    steps.sort_by(|a, b| a.t.total_cmp(&b.t));
    steps.dedup_by(|a, b| a.t == b.t);
    steps.insert(0, start.clone());
    if last.t > start.t {
        steps.push(last);
    }
    Ok(Solution {
        statistics: Statistics {
            steps: steps.len() - 1,
            evaluations: orbit.points,
            ..Statistics::default()
        },
        steps,
        samples,
        terminated_by_event,
        event_occurrences: found.occurrences,
        error,
        ..Solution::default()
    })
}

/// The state of an orbit at a time.
pub(super) fn point(orbit: &Orbit, t: f64) -> OdeState {
    OdeState::from(orbit.state_at(t))
}
