//! What came of following a motion through its charts.

use super::Atlas;
use crate::error::DynamicsError;
use crate::follow::{Occurrence, Trace};
use crate::options::Statistics;
use crate::system::Point;
use dwell_geometry::BodyId;
use dwell_geometry::measure::Measured;
use std::f64::consts::TAU;

/// A motion through one or more charts.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Journey {
    /// The parts of it in one chart each, in order; samples go on from one to the next.
    pub legs: Vec<Leg>,
    /// Where and why the chart was changed: one fewer than the legs, or as many if it ended with one.
    pub changes: Vec<Change>,
    /// Whether an event ended it.
    pub stopped: bool,
    /// Why it could not go on, if it could not.
    pub failed: Option<DynamicsError>,
}

/// A part of a motion in one chart.
#[derive(Debug, Clone, PartialEq)]
pub struct Leg {
    /// Index in [`Atlas::charts`].
    pub chart: usize,
    /// The motion, in states of that chart's machine. Its `failed` is set too where another chart
    /// then went on.
    pub trace: Trace,
}

/// A change of chart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Change {
    /// When, s.
    pub t: f64,
    /// From which chart, and to which.
    pub from: usize,
    /// To which chart.
    pub to: usize,
    /// Why.
    pub why: Why,
}

/// Why a chart was left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Why {
    /// Its coordinate folds back: another was so many times as fast.
    Folds {
        /// How many times, lengths by the mechanism's size.
        times: f64,
    },
    /// It could not be followed any further.
    Ends,
    /// A change point was crossed, to the same coordinate on the branch behind.
    Crosses {
        /// Index in [`Atlas::bridges`].
        bridge: usize,
    },
}

/// A coordinate along a motion: value, speed and acceleration, rad or m, per s, per s².
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Tracked {
    /// By leg, at its steps.
    pub steps: Vec<Vec<[f64; 3]>>,
    /// By leg, at its samples.
    pub samples: Vec<Vec<[f64; 3]>>,
}

impl Journey {
    /// Adds what one chart made of the motion; it goes on from the last leg if the chart is the same.
    pub(super) fn take(&mut self, chart: usize, trace: Trace) {
        let same = self.legs.len() == self.changes.len() + 1;
        let Some(leg) = self.legs.last_mut().filter(|_| same) else {
            self.legs.push(Leg { chart, trace });
            return;
        };
        leg.trace.steps.extend(trace.steps.into_iter().skip(1));
        leg.trace.samples.extend(trace.samples);
        leg.trace.occurrences.extend(trace.occurrences);
        leg.trace.stopped = trace.stopped;
        leg.trace.failed = trace.failed;
        leg.trace.statistics = sum(leg.trace.statistics, trace.statistics);
    }

    /// What happened, in order, with the leg it happened in.
    pub fn occurrences(&self) -> impl Iterator<Item = (usize, &Occurrence)> {
        let legs = self.legs.iter().enumerate();
        legs.flat_map(|(i, leg)| leg.trace.occurrences.iter().map(move |o| (i, o)))
    }

    /// The work of all legs together.
    pub fn statistics(&self) -> Statistics {
        let legs = self.legs.iter().map(|leg| leg.trace.statistics);
        legs.fold(Statistics::default(), sum)
    }

    /// The last state, with the chart it is of.
    pub fn last(&self) -> Option<(usize, &Point)> {
        let leg = self.legs.last()?;
        Some((leg.chart, leg.trace.steps.last()?))
    }
}

impl Atlas<'_> {
    /// The coordinate of the mechanism's own actuator.
    pub fn own(&self) -> Measured {
        self.coordinates[0].measured
    }

    /// A coordinate along a motion. Angles have no jumps: where no chart counts their turns, they go on
    /// from what they were; the first is in the chart's own count.
    ///
    /// # Errors
    /// [`DynamicsError`] where a state cannot be evaluated.
    pub fn track(&self, journey: &Journey, measured: Measured) -> Result<Tracked, DynamicsError> {
        let mut tracked = Tracked::default();
        let mut last: Option<(f64, [f64; 3])> = None;
        for Leg { chart, trace } in &journey.legs {
            let machine = &self.charts[*chart].machine;
            let mut work = machine.work();
            let mut found = [Vec::new(), Vec::new()];
            // Whole turns that this chart's count is off, if it counts.
            let mut ahead: Option<f64> = None;
            let (steps, samples) = (&trace.steps, &trace.samples);
            let (mut i, mut k) = (0, 0);
            while i < steps.len() || k < samples.len() {
                let first = match (steps.get(i), samples.get(k)) {
                    (Some(step), Some(sample)) => step.t <= sample.t,
                    (step, _) => step.is_some(),
                };
                let point = if first { &steps[i] } else { &samples[k] };
                machine.evaluate(point.t, &point.y, &mut work)?;
                if machine.bridge_at(point.y.first()).is_none() {
                    machine.model.accelerate(&work.q_ddot, &mut work.inner);
                }
                let states = work.inner.states();
                let mut now = states.measure(measured);
                if let (Measured::Angle(bodies), Some((t, before))) = (measured, last) {
                    let counts = |b: BodyId| states.body(b).angle.is_some();
                    let near = before[0] + 0.5 * (before[1] + now[1]) * (point.t - t);
                    let turns = TAU * ((near - now[0]) / TAU).round();
                    now[0] += match ahead {
                        Some(ahead) => ahead,
                        None => turns,
                    };
                    if bodies.into_iter().all(counts) {
                        ahead.get_or_insert(turns);
                    }
                } else if last.is_none() {
                    ahead = all_counted(measured, states).then_some(0.0);
                }
                last = Some((point.t, now));
                if first {
                    found[0].push(now);
                    i += 1;
                } else {
                    found[1].push(now);
                    k += 1;
                }
            }
            let [steps, samples] = found;
            tracked.steps.push(steps);
            tracked.samples.push(samples);
        }
        Ok(tracked)
    }
}

fn sum(a: Statistics, b: Statistics) -> Statistics {
    Statistics {
        steps: a.steps + b.steps,
        rejected: a.rejected + b.rejected,
        stiff: a.stiff + b.stiff,
        evaluations: a.evaluations + b.evaluations,
        jacobians: a.jacobians + b.jacobians,
        factorisations: a.factorisations + b.factorisations,
    }
}

/// Whether the whole turns of an angle are counted.
fn all_counted(measured: Measured, states: &dwell_geometry::measure::BodyStates) -> bool {
    match measured {
        Measured::Angle(bodies) => bodies.into_iter().all(|b| states.body(b).angle.is_some()),
        _ => false,
    }
}
