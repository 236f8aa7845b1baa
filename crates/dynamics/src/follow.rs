//! A machine followed in time: its steps, equally spaced samples, and events.
//!
//! An event is a zero of a function of the state. It is looked for between several points of each step's
//! dense output, so that two in one step are found, and located there to rounding; how far the dense
//! output itself is from the motion is the integration's error.

use crate::driver::{Dense, Next, integrate};
use crate::error::DynamicsError;
use crate::machine::{Machine, MachineWork};
use crate::moving::Moving;
use crate::options::{Options, Statistics};
use crate::root;
use crate::system::{Point, System};
use dwell_geometry::BodyId;
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
    let mut moving = Moving::new(machine, start.t, &start.y)?;
    follow_by(&mut moving, machine, shown, start, end, options, events)
}

/// Follows a machine by another system of the same states, such as its [table](crate::Tabled); what events
/// look at is the machine's own.
///
/// # Errors
/// As [`follow`].
pub fn follow_by<S: System>(
    system: &mut S,
    machine: &Machine,
    shown: &Model,
    start: &Point,
    end: f64,
    options: &Options,
    events: &[Event],
) -> Result<Trace, DynamicsError> {
    let mut record = Record::new(start.t, events);
    let mut watcher = record.on(machine, shown, start)?;
    let mut trace = watcher.trace(start, options);
    let mut watch = |before: &Point, now: &Point, dense: Dense<'_>| {
        watcher.step(&mut trace, options, before, now, dense)
    };
    let ended = integrate(system, start, Some(end), options, &mut watch)?;
    trace.failed = ended.failed;
    trace.statistics = ended.statistics;
    Ok(trace)
}

/// What a motion remembers from one machine that carries it to the next.
pub(crate) struct Record<'e> {
    events: &'e [Event],
    lookouts: Vec<Lookout>,
    /// When the motion began, and the samples taken since.
    began: f64,
    sampled: usize,
}

impl<'e> Record<'e> {
    pub(crate) fn new(began: f64, events: &'e [Event]) -> Self {
        Self {
            events,
            lookouts: Vec::with_capacity(events.len()),
            began,
            sampled: 0,
        }
    }

    /// Goes on with a machine from a point.
    pub(crate) fn on<'m>(
        &'m mut self,
        machine: &'m Machine,
        shown: &'m Model,
        from: &Point,
    ) -> Result<Watcher<'m, 'e>, DynamicsError> {
        let mut eye = Eye::new(machine, shown);
        if self.lookouts.is_empty() {
            for &event in self.events {
                self.lookouts.push(Lookout::new(event, &mut eye, from)?);
            }
        } else {
            for lookout in &mut self.lookouts {
                lookout.go_on(&mut eye, from)?;
            }
        }
        Ok(Watcher { eye, record: self })
    }
}

/// Looks after the steps of one machine.
pub(crate) struct Watcher<'m, 'e> {
    eye: Eye<'m>,
    record: &'m mut Record<'e>,
}

impl Watcher<'_, '_> {
    /// A trace that begins at a point.
    pub(crate) fn trace(&mut self, start: &Point, options: &Options) -> Trace {
        let first = options.every.is_some() && self.record.sampled == 0;
        self.record.sampled += usize::from(first);
        Trace {
            steps: vec![start.clone()],
            samples: first.then(|| start.clone()).into_iter().collect(),
            ..Trace::default()
        }
    }

    /// Takes a step into the trace, with the samples and events in it.
    pub(crate) fn step(
        &mut self,
        trace: &mut Trace,
        options: &Options,
        before: &Point,
        now: &Point,
        dense: Dense<'_>,
    ) -> Result<Next, DynamicsError> {
        let Self { eye, record } = self;
        let mut found = Vec::new();
        for (i, lookout) in record.lookouts.iter_mut().enumerate() {
            lookout.look(i, before, now, dense, eye, &mut found)?;
        }
        found.sort_by(|a, b| a.at.t.total_cmp(&b.at.t));
        let stop = found.iter().position(|o| record.events[o.event].stop);
        if let Some(stop) = stop {
            found.truncate(stop + 1);
        }
        let until = match (stop, found.last()) {
            (Some(_), Some(last)) => last.at.t,
            _ => now.t,
        };
        if let Some(every) = options.every {
            while let t = record.began + every * record.sampled as f64
                && t <= until
            {
                trace.samples.push(inside(t, now, dense)?);
                record.sampled += 1;
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
    }
}

/// The state at a time within a step that ends at `now`.
pub(crate) fn inside(t: f64, now: &Point, dense: Dense<'_>) -> Result<Point, DynamicsError> {
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

    fn value(&mut self, trigger: Trigger, point: &Point) -> Result<Seen, DynamicsError> {
        self.machine.evaluate(point.t, &point.y, &mut self.work)?;
        let states = self.work.inner.states();
        let seen = |measured: Measured, less: f64| {
            let [value, speed, _] = states.measure(measured);
            let counted = |b: BodyId| states.body(b).angle.is_some();
            Seen {
                value: value - less,
                speed,
                whole: match measured {
                    Measured::Angle(bodies) => Some(bodies.into_iter().all(counted)),
                    _ => None,
                },
            }
        };
        Ok(match trigger {
            Trigger::Reaches(measured, value) => seen(measured, value),
            Trigger::WholeTurn(measured) => seen(measured, 0.0),
            Trigger::Turns(measured) => Seen::plain(states.measure(measured)[1]),
            Trigger::Reaction(k, value) => {
                self.machine.show(
                    self.shown,
                    point.t,
                    &self.work,
                    &mut self.all,
                    &mut self.actions,
                )?;
                Seen::plain(self.actions.reactions[k] - value)
            }
        })
    }
}

/// The value of an event's function.
#[derive(Debug, Clone, Copy)]
struct Seen {
    value: f64,
    speed: f64,
    /// Of an angle: whether its whole turns are counted.
    whole: Option<bool>,
}

impl Seen {
    fn plain(value: f64) -> Self {
        Self {
            value,
            speed: 0.0,
            whole: None,
        }
    }
}

/// An event being looked for.
pub(crate) struct Lookout {
    event: Event,
    /// When it was last looked at, and the function then. Angles that are not counted go on from here.
    last: (f64, Seen),
    /// Whole turns that counted angles are ahead of what is seen, since another machine began.
    ahead: f64,
    /// Of whole turns: where they are counted from, and how many were passed.
    from: f64,
    turns: f64,
}

impl Lookout {
    fn new(event: Event, eye: &mut Eye<'_>, start: &Point) -> Result<Self, DynamicsError> {
        let seen = eye.value(event.trigger, start)?;
        Ok(Self {
            event,
            last: (start.t, seen),
            ahead: 0.0,
            from: seen.value,
            turns: 0.0,
        })
    }

    /// Goes on with another machine, whose angles may be whole turns away.
    fn go_on(&mut self, eye: &mut Eye<'_>, at: &Point) -> Result<(), DynamicsError> {
        let mut seen = eye.value(self.event.trigger, at)?;
        self.ahead = 0.0;
        if seen.whole.is_some() {
            let turns = TAU * ((self.last.1.value - seen.value) / TAU).round();
            seen.value += turns;
            self.ahead = turns;
        }
        self.last = (at.t, seen);
        Ok(())
    }

    /// The function with the whole turns that it has without a jump since it was `last`.
    fn see(&self, last: (f64, Seen), eye: &mut Eye<'_>, at: &Point) -> Result<Seen, DynamicsError> {
        let mut seen = eye.value(self.event.trigger, at)?;
        seen.value += match seen.whole {
            None => 0.0,
            Some(true) => self.ahead,
            Some(false) => {
                let (t, last) = last;
                let near = last.value + 0.5 * (last.speed + seen.speed) * (at.t - t);
                TAU * ((near - seen.value) / TAU).round()
            }
        };
        Ok(seen)
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
        for k in 1..=LOOKS {
            let t1 = before.t + (now.t - before.t) * k as f64 / LOOKS as f64;
            let point = inside(if k == LOOKS { now.t } else { t1 }, now, dense)?;
            let last = self.last;
            let (t0, v0) = (last.0, last.1.value);
            let seen = self.see(last, eye, &point)?;
            let v1 = seen.value;
            while let Some(target) = self.target(v0, v1) {
                let mut off = |t: f64| -> Result<f64, DynamicsError> {
                    let at = inside(t, now, dense)?;
                    Ok(self.see(last, eye, &at)?.value - target)
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
            self.last = (point.t, seen);
        }
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
