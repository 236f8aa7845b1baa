//! A machine followed in time: its steps, equally spaced samples, and events.
//!
//! An event is a zero of a function of the state. It is looked for between several points of each step's
//! dense output, so that two in one step are found, and located there to rounding; how far the dense
//! output itself is from the motion is the integration's error.

use crate::driver::{Dense, Next, integrate};
use crate::error::DynamicsError;
use crate::machine::{Machine, MachineWork, Moving};
use crate::options::{Options, Statistics};
use crate::root;
use crate::system::Point;
use dwell_geometry::measure::Measured;
use dwell_kinetostatics::{Actions, Model, Workspace};
use std::f64::consts::TAU;

/// Points of a step between which a sign is looked at.
const LOOKS: usize = 4;

/// What makes an event.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Trigger {
    /// A coordinate passes a value, rad or m.
    Reaches(Measured, f64),
    /// The speed of a coordinate changes its sign.
    Turns(Measured),
    /// A reaction of the shown model, by its place there, passes a value, N or N·m: at zero, a guide
    /// that only pushes lets go.
    Reaction(usize, f64),
    /// A coordinate completes a whole turn from where it started, either way.
    WholeTurn(Measured),
}

/// An event to look for.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Event {
    /// What makes it.
    pub trigger: Trigger,
    /// Whether the motion ends with it.
    pub stop: bool,
}

/// An event that happened.
#[derive(Debug, Clone, PartialEq)]
pub struct Occurrence {
    /// Index of the event.
    pub event: usize,
    /// When, and the state then.
    pub at: Point,
    /// Whether the function rose through zero.
    pub rising: bool,
}

/// A motion as far as it could be followed.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Trace {
    /// The start and the end of each step.
    pub steps: Vec<Point>,
    /// Equally spaced samples, if asked for.
    pub samples: Vec<Point>,
    /// What happened, in order.
    pub occurrences: Vec<Occurrence>,
    /// Whether an event ended it.
    pub stopped: bool,
    /// Why it could not go on, if it could not.
    pub failed: Option<DynamicsError>,
    /// The work done.
    pub statistics: Statistics,
}

/// Follows a machine from a point until a time.
///
/// `shown` is the same mechanism with the same loads (the drives' among them), for the reactions that
/// events name.
///
/// # Errors
/// [`DynamicsError`] where not even the start can be evaluated, or an option cannot be used. What ends
/// the motion on the way is in [`Trace::failed`].
pub fn follow(
    machine: &Machine,
    shown: &Model,
    start: &Point,
    end: f64,
    options: &Options,
    events: &[Event],
) -> Result<Trace, DynamicsError> {
    let mut eye = Eye::new(machine, shown);
    let mut trace = Trace {
        steps: vec![start.clone()],
        samples: options.every.map(|_| start.clone()).into_iter().collect(),
        ..Trace::default()
    };
    let mut lookouts = Vec::with_capacity(events.len());
    for &event in events {
        lookouts.push(Lookout::new(event, &mut eye, start)?);
    }
    let mut moving = Moving::new(machine, start.t, &start.y)?;
    let mut watch = |before: &Point, now: &Point, dense: Dense<'_>| {
        let mut found = Vec::new();
        for (i, lookout) in lookouts.iter_mut().enumerate() {
            lookout.look(i, before, now, dense, &mut eye, &mut found)?;
        }
        found.sort_by(|a, b| a.at.t.total_cmp(&b.at.t));
        let stop = found.iter().position(|o| events[o.event].stop);
        if let Some(stop) = stop {
            found.truncate(stop + 1);
        }
        let until = match (stop, found.last()) {
            (Some(_), Some(last)) => last.at.t,
            _ => now.t,
        };
        if let Some(every) = options.every {
            while let t = start.t + every * trace.samples.len() as f64
                && t <= until
            {
                trace.samples.push(inside(t, now, dense)?);
            }
        }
        let last = inside(until, now, dense)?;
        trace.steps.push(last);
        trace.occurrences.append(&mut found);
        trace.stopped = stop.is_some();
        Ok(if trace.stopped {
            Next::Stop
        } else {
            Next::GoOn
        })
    };
    let ended = integrate(&mut moving, start, Some(end), options, &mut watch)?;
    trace.failed = ended.failed;
    trace.statistics = ended.statistics;
    Ok(trace)
}

/// The state at a time within a step that ends at `now`.
fn inside(t: f64, now: &Point, dense: Dense<'_>) -> Result<Point, DynamicsError> {
    let mut point = now.clone();
    if t < now.t {
        dense(t, &mut point.y)?;
        point.t = t;
    }
    Ok(point)
}

/// Evaluates what events look at.
struct Eye<'m> {
    machine: &'m Machine,
    shown: &'m Model,
    work: MachineWork<f64>,
    all: Workspace<f64>,
    actions: Actions<f64>,
}

impl<'m> Eye<'m> {
    fn new(machine: &'m Machine, shown: &'m Model) -> Self {
        Self {
            machine,
            shown,
            work: machine.work(),
            all: shown.workspace(),
            actions: shown.actions(),
        }
    }

    fn value(&mut self, trigger: Trigger, point: &Point) -> Result<f64, DynamicsError> {
        self.machine.evaluate(point.t, &point.y, &mut self.work)?;
        let states = self.work.inner.states();
        Ok(match trigger {
            Trigger::Reaches(measured, value) => states.measure(measured)[0] - value,
            Trigger::WholeTurn(measured) => states.measure(measured)[0],
            Trigger::Turns(measured) => states.measure(measured)[1],
            Trigger::Reaction(k, value) => {
                self.machine.show(
                    self.shown,
                    point.t,
                    &self.work,
                    &mut self.all,
                    &mut self.actions,
                )?;
                self.actions.reactions[k] - value
            }
        })
    }
}

/// An event being looked for.
struct Lookout {
    event: Event,
    /// The function's value at the end of the last step.
    last: f64,
    /// Of whole turns: where they are counted from, and how many were passed.
    from: f64,
    turns: f64,
}

impl Lookout {
    fn new(event: Event, eye: &mut Eye<'_>, start: &Point) -> Result<Self, DynamicsError> {
        let value = eye.value(event.trigger, start)?;
        Ok(Self {
            event,
            last: value,
            from: value,
            turns: 0.0,
        })
    }

    /// Looks through one step.
    fn look(
        &mut self,
        index: usize,
        before: &Point,
        now: &Point,
        dense: Dense<'_>,
        eye: &mut Eye<'_>,
        found: &mut Vec<Occurrence>,
    ) -> Result<(), DynamicsError> {
        let trigger = self.event.trigger;
        let (mut t0, mut v0) = (before.t, self.last);
        for k in 1..=LOOKS {
            let t1 = before.t + (now.t - before.t) * k as f64 / LOOKS as f64;
            let point = inside(if k == LOOKS { now.t } else { t1 }, now, dense)?;
            let v1 = eye.value(trigger, &point)?;
            while let Some(target) = self.target(v0, v1) {
                let mut off = |t: f64| -> Result<f64, DynamicsError> {
                    let at = inside(t, now, dense)?;
                    Ok(eye.value(trigger, &at)? - target)
                };
                // What was zero already has happened before.
                let t = if v0 == target {
                    None
                } else {
                    root::zero(&mut off, t0, point.t)?
                };
                let Some(t) = t else {
                    break;
                };
                found.push(Occurrence {
                    event: index,
                    at: inside(t, now, dense)?,
                    rising: v1 > v0,
                });
                if !matches!(trigger, Trigger::WholeTurn(_)) {
                    break;
                }
                self.turns += (v1 - v0).signum();
            }
            (t0, v0) = (point.t, v1);
        }
        self.last = v0;
        Ok(())
    }

    /// The value that is passed between two others, if one is.
    fn target(&self, v0: f64, v1: f64) -> Option<f64> {
        let passes = |target: f64| (v0 - target) * (v1 - target) < 0.0 || v1 == target;
        if matches!(self.event.trigger, Trigger::WholeTurn(_)) {
            let next = [1.0, -1.0].map(|way| self.from + TAU * (self.turns + way));
            // Forwards and back over the same mark is no second turn.
            return next
                .into_iter()
                .find(|&target| v0 != target && passes(target));
        }
        (v0 != 0.0 && passes(0.0)).then_some(0.0)
    }
}
