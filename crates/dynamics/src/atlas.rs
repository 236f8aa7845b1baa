//! A motion of one degree of freedom followed through dead points and change points.
//!
//! A coordinate that folds back (a slider at its dead point) says less and less there about the motion,
//! and its inertia grows beyond all bounds. The motion then goes on in another coordinate of the same
//! mechanism: another *chart*, in which the actuator is replaced and all else, loads and drives, is the
//! same. A chart is left when some coordinate moves [`FOLDS`] times as fast as its own, lengths by the
//! mechanism's size; the new one is the fastest, so that it is not left again soon.
//!
//! A change point, where assembly branches meet, needs no other coordinate, but a chart on the branch
//! behind it, and a [`Bridge`] across.

mod candidates;
mod counting;
mod crossing;
mod guard;
mod journey;

use crate::bridge::{Bridge, BridgeError};
use crate::drive::Drive;
use crate::driver::{Dense, integrate};
use crate::error::DynamicsError;
use crate::follow::{Event, Record, Trace};
use crate::machine::{Guidance, Machine, MachineError, all_loads};
use crate::moving::Moving;
use crate::options::Options;
use crate::system::Point;
use candidates::{Candidate, actuator, candidates, size};
use counting::angles_used;
use crossing::Crossing;
use dwell_geometry::measure::{BodyStates, Measured};
use dwell_geometry::mechanism::Told;
use dwell_geometry::{BodyId, Coordinate, Joint, JointId, Mechanism, Reaction, Start};
use dwell_kinetostatics::{Load, Magnitude, Mass, Model, ModelError};
use guard::{Guard, Turning};
pub use journey::{Change, Journey, Leg, Tracked, Why};

/// Times by which another coordinate must be the faster for the present one to be left.
const FOLDS: f64 = 8.0;
/// Coordinates tried for a chart before the motion is given up.
const TRIES: usize = 6;
/// Charts in a row in which nothing moves before the motion is given up.
const MOST_IDLE: usize = 3;
/// What is left of the longest step where one was too rough.
const SHORTER: f64 = 0.25;
/// How far steps that may have led over a bridge are shortened.
const SLOWEST: f64 = 1e-2;
/// Two poses closer than this, rad, are one.
const SAME: f64 = 1e-6;

/// A mechanism of one degree of freedom with all that moves it.
#[derive(Debug, Clone, Copy)]
pub struct Site<'s> {
    /// The mechanism, with one actuator, whose coordinate is free.
    pub mechanism: &'s Mechanism,
    /// By body.
    pub masses: &'s [Mass],
    /// Where it is put together.
    pub start: &'s Start,
    /// What acts on it.
    pub loads: &'s [Load],
    /// What drives it.
    pub drives: &'s [Drive],
    /// The reactions of the shown models.
    pub reactions: &'s [Reaction],
}

/// The mechanism in one of its coordinates, on one assembly branch.
#[derive(Debug, Clone)]
pub struct Chart {
    /// What the coordinate is called: the actuator's name at first, then `angle of crank` and the like.
    pub name: String,
    /// The coordinate.
    pub coordinate: Coordinate,
    /// The machine that moves.
    pub machine: Machine,
    /// The model with all loads (the drives' last) and the reactions asked for.
    pub shown: Model,
    /// By end of its range: whether a bridge was looked for.
    looked: [bool; 2],
}

/// Why an atlas cannot be begun.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AtlasError {
    /// The mechanism cannot be put together.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// Its loads or drives do not fit.
    #[error(transparent)]
    Machine(#[from] MachineError),
}

/// The charts of a mechanism, as far as they were needed.
#[derive(Debug, Clone)]
pub struct Atlas<'s> {
    site: Site<'s>,
    coordinates: Vec<Candidate>,
    charts: Vec<Chart>,
    crossings: Vec<Crossing>,
    refused: Vec<(f64, BridgeError)>,
    /// What the bridges are good for.
    tolerance: f64,
    /// By coordinate: after how much its branches follow each other again, once that is known, rad.
    periods: Vec<(Coordinate, f64)>,
    size: f64,
}

impl<'s> Atlas<'s> {
    /// Begins with the chart of the mechanism's own actuator.
    ///
    /// # Errors
    /// [`AtlasError`] where that cannot be built.
    pub fn new(site: Site<'s>) -> Result<Self, AtlasError> {
        let size = size(site.mechanism);
        let coordinates = candidates(site.mechanism, size);
        let mut atlas = Self {
            site,
            coordinates,
            charts: Vec::new(),
            crossings: Vec::new(),
            refused: Vec::new(),
            tolerance: f64::INFINITY,
            periods: Vec::new(),
            size,
        };
        if site.mechanism.actuators.len() != 1 {
            return Err(MachineError::Guidance.into());
        }
        let home = atlas.build(site.mechanism, site.start)?;
        atlas.charts.push(home);
        Ok(atlas)
    }

    /// The charts that were needed so far; the first is that of the mechanism's own actuator.
    pub fn charts(&self) -> &[Chart] {
        &self.charts
    }

    /// The bridges across change points that were needed so far.
    pub fn bridges(&self) -> impl ExactSizeIterator<Item = &Bridge> {
        self.crossings.iter().map(|c| c.bridge.as_ref())
    }

    /// The change points that cannot be crossed, and why.
    pub fn refused(&self) -> &[(f64, BridgeError)] {
        &self.refused
    }

    fn build(&self, mechanism: &Mechanism, start: &Start) -> Result<Chart, AtlasError> {
        let Site {
            loads,
            drives,
            reactions,
            ..
        } = self.site;
        // Witnesses have no mass.
        let mut masses = self.site.masses.to_vec();
        masses.resize(mechanism.bodies.len().max(masses.len()), Mass::default());
        let frictions = loads.iter().filter_map(|load| match load.magnitude {
            Magnitude::Friction(friction) => Some(friction.reactions(mechanism)),
            _ => None,
        });
        let needed: Vec<Reaction> = frictions.flatten().collect();
        let model = Model::new(mechanism, &masses, start, &needed)?;
        let free = vec![Guidance::Free; model.plan().actuators()];
        let machine = Machine::new(mechanism, model, loads, free, drives)?;
        let all = all_loads(mechanism, loads, drives).map_err(MachineError::from)?;
        // Friction needs its reactions in the shown model too.
        let mut asked = reactions.to_vec();
        asked.extend(needed.iter().filter(|r| !reactions.contains(r)));
        let shown = Model::new(mechanism, &masses, start, &asked)?;
        let shown = shown.with_loads(mechanism, all);
        let (name, coordinate) = match mechanism.actuators.first() {
            Some(actuator) => (actuator.name.clone(), actuator.coordinate()),
            None => return Err(MachineError::Guidance.into()),
        };
        Ok(Chart {
            name,
            coordinate,
            machine,
            shown: shown.map_err(MachineError::from)?,
            looked: [false; 2],
        })
    }

    /// Drops the bridges where they were made for a looser tolerance than is asked for now.
    fn sharpen(&mut self, tolerance: f64) {
        if tolerance < self.tolerance {
            self.tolerance = tolerance;
            self.crossings.clear();
            self.refused.clear();
            self.periods.clear();
            for chart in &mut self.charts {
                chart.machine.bridges.clear();
                chart.looked = [false; 2];
            }
        }
    }

    /// Follows the motion from a state of the first chart until a time, through as many charts as it
    /// takes. Where the first is enough, it is what [`follow`](crate::follow()) finds, to the last bit.
    ///
    /// # Errors
    /// [`DynamicsError`] where not even the start can be evaluated, or an option cannot be used. What
    /// ends the motion on the way is in [`Journey::failed`].
    pub fn follow(
        &mut self,
        start: &Point,
        end: f64,
        options: &Options,
        events: &[Event],
    ) -> Result<Journey, DynamicsError> {
        self.sharpen(options.relative);
        let mut journey = Journey::default();
        let mut record = Record::new(start.t, events);
        let (mut chart, mut at) = (0, start.clone());
        let asked = options;
        let (mut options, mut longest) = (*asked, None);
        let mut idle = 0;
        loop {
            self.prepare(chart);
            let (trace, turning) = match self.leg(chart, &at, end, &options, &mut record) {
                // What is left after a change is nothing.
                Err(DynamicsError::TooShort) if !journey.legs.is_empty() => return Ok(journey),
                Err(error) if !journey.legs.is_empty() => {
                    journey.failed = Some(error);
                    return Ok(journey);
                }
                leg => leg?,
            };
            idle = if trace.steps.len() > 1 { 0 } else { idle + 1 };
            options.budget = options.budget.saturating_sub(trace.statistics.steps);
            if let Some(last) = trace.steps.last() {
                at.clone_from(last);
            }
            journey.stopped = trace.stopped;
            journey.failed = trace.failed.clone();
            journey.take(chart, trace);
            if journey.stopped || (journey.failed.is_none() && at.t >= end) {
                return Ok(journey);
            }
            let turning = match turning {
                Some(Turning::Rough(step)) => {
                    options.longest = Some(SHORTER * step);
                    continue;
                }
                None if self.slow_down(chart, &at, &mut longest) => {
                    options.longest = longest;
                    continue;
                }
                None => self.rescue(chart, &at),
                turning => turning,
            };
            (longest, options.longest) = (None, asked.longest);
            // A chart that should be left and cannot be ends the motion; so do charts that lead from
            // one to another and nowhere else.
            let turning = turning.filter(|_| idle < MOST_IDLE);
            let next = turning.and_then(|turning| self.turn(chart, &at, &turning));
            let Some((to, y, why)) = next else {
                let (t, q) = (at.t, at.y.first().copied().unwrap_or(f64::NAN));
                journey.failed.get_or_insert(DynamicsError::Limit { t, q });
                return Ok(journey);
            };
            journey.changes.push(Change {
                t: at.t,
                from: chart,
                to,
                why,
            });
            (chart, at.y) = (to, y);
        }
    }

    /// Follows one chart as far as it goes.
    fn leg(
        &self,
        chart: usize,
        at: &Point,
        end: f64,
        options: &Options,
        record: &mut Record<'_>,
    ) -> Result<(Trace, Option<Turning>), DynamicsError> {
        let own = &self.charts[chart];
        let mut watcher = record.on(&own.machine, &own.shown, at)?;
        let mut trace = watcher.trace(at, options);
        let mut guard = Guard::new(self, chart);
        if let Some(turning) = guard.folds(at)? {
            return Ok((trace, Some(turning)));
        }
        let mut moving = Moving::new(&own.machine, at.t, &at.y)?;
        let mut left = None;
        let mut watch = |before: &Point, now: &Point, dense: Dense<'_>| {
            guard.watch(before, now, dense, &mut left, |dense| {
                watcher.step(&mut trace, options, before, now, dense)
            })
        };
        let ended = integrate(&mut moving, at, Some(end), options, &mut watch)?;
        trace.failed = ended.failed;
        trace.statistics = ended.statistics;
        Ok((trace, left))
    }

    /// Shorter steps for a chart that failed, if it has a bridge that they may have led over.
    fn slow_down(&self, chart: usize, at: &Point, longest: &mut Option<f64>) -> bool {
        let spans = self.charts[chart].machine.bridges.iter();
        let near = spans.map(|span| span.bridge.reach).reduce(f64::min);
        let (Some(reach), Some(&speed)) = (near, at.y.get(1)) else {
            return false;
        };
        let first = 0.5 * reach / speed.abs();
        let next = longest.map_or(first, |last| 0.25 * last);
        let worth = next.is_finite() && next > SLOWEST * first;
        *longest = Some(next);
        worth
    }

    /// The best coordinates besides the present one where a chart ends, if there are better ones.
    fn rescue(&self, chart: usize, at: &Point) -> Option<Turning> {
        let ranks = Guard::new(self, chart).ranks(at).ok()?;
        ranks.better_than(1.0).map(Turning::Ends)
    }

    /// The chart to which a motion turns, with its state there.
    fn turn(
        &mut self,
        from: usize,
        at: &Point,
        turning: &Turning,
    ) -> Option<(usize, Vec<f64>, Why)> {
        match turning {
            Turning::Rough(_) => None,
            Turning::Crosses { crossing, above } => {
                let to = self.crossings[*crossing].charts[usize::from(*above)];
                let why = Why::Crosses { bridge: *crossing };
                Some((to, at.y.clone(), why))
            }
            Turning::Folds(ranks) | Turning::Ends(ranks) => {
                let why = match turning {
                    Turning::Folds(_) => Why::Folds {
                        times: ranks.times(),
                    },
                    _ => Why::Ends,
                };
                let tried = ranks.best().take(TRIES);
                let tried: Vec<usize> = tried.collect();
                tried.into_iter().find_map(|candidate| {
                    let (to, y) = self.change(from, at, candidate)?;
                    Some((to, y, why))
                })
            }
        }
    }

    /// The state in the chart of another coordinate, which may have to be built.
    fn change(&mut self, from: usize, at: &Point, candidate: usize) -> Option<(usize, Vec<f64>)> {
        let Candidate {
            name,
            coordinate,
            measured,
            ..
        } = self.coordinates[candidate].clone();
        let machine = &self.charts[from].machine;
        let mut work = machine.work();
        machine.evaluate(at.t, &at.y, &mut work).ok()?;
        let states = work.inner.states().clone();
        let [q, q_dot, _] = states.measure(measured);
        let mut y = at.y.clone();
        (y[0], y[1]) = (q, q_dot);
        let there = Point { t: at.t, y };
        for (to, chart) in self.charts.iter().enumerate() {
            if chart.coordinate == coordinate {
                let mut there = there.clone();
                // Within its own range: which bridge lies at which end depends on whole turns.
                there.y[0] = chart.machine.model.plan().range().fold(q).unwrap_or(q);
                if self.agrees(chart, &there, &states) {
                    return Some((to, there.y));
                }
            }
        }
        let mechanism = Mechanism {
            actuators: vec![actuator(self.site.mechanism, name, coordinate)?],
            ..self.site.mechanism.clone()
        };
        let (mechanism, rough) = self.counting(mechanism, &states);
        let mut joints = told(self.site.mechanism, &states);
        joints.resize(mechanism.joints.len(), None);
        let start = Start {
            q: vec![q],
            rough,
            joints,
        };
        let chart = self.build(&mechanism, &start).ok()?;
        if !self.agrees(&chart, &there, &states) {
            return None;
        }
        self.charts.push(chart);
        Some((self.charts.len() - 1, there.y))
    }

    /// Whether a chart has the bodies where they are, and measures the angles that loads depend on alike.
    fn agrees(&self, chart: &Chart, at: &Point, states: &BodyStates) -> bool {
        let mut work = chart.machine.work();
        if chart.machine.evaluate(at.t, &at.y, &mut work).is_err() {
            return false;
        }
        let own = work.inner.states();
        // Beyond the mechanism's bodies come those that its actuator adds.
        let mut bodies = (0..self.site.mechanism.bodies.len()).map(BodyId);
        let counted = |s: &BodyStates, b: BodyId| s.body(b).angle.is_some();
        let alike = |bodies: [BodyId; 2]| {
            let apart = own.angle(bodies)[0] - states.angle(bodies)[0];
            let loses = bodies
                .iter()
                .any(|&b| counted(states, b) && !counted(own, b));
            apart.abs() < SAME && !loses
        };
        bodies.all(|b| (own.body(b).turn - states.body(b).turn).norm() < SAME)
            && angles_used(&self.site).into_iter().all(alike)
    }
}

/// What the bodies tell of each joint: its travel, or the direction of its line.
fn told(mechanism: &Mechanism, states: &BodyStates) -> Vec<Option<f64>> {
    let joints = mechanism.joints.iter().enumerate();
    let of = |(j, joint): (usize, &Joint)| match joint.kind.told()? {
        Told::Travel => {
            let travel = Measured::find(mechanism, Coordinate::Travel(JointId(j)))?;
            Some(states.measure(travel)[0])
        }
        Told::Direction => {
            let line = states.separation(joint.bodies, joint.points).direction?;
            Some(line.angle())
        }
    };
    joints.map(of).collect()
}
