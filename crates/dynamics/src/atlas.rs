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

mod guard;
mod journey;

use crate::bridge::{Bridge, BridgeError, Span, ahead, half_window};
use crate::drive::{Drive, DriveKind};
use crate::driver::integrate;
use crate::error::DynamicsError;
use crate::follow::{Event, Record, Trace};
use crate::machine::{Guidance, Machine, MachineError, MachineWork, Moving, all_loads};
use crate::options::Options;
use crate::system::Point;
use dwell_geometry::measure::{BodyStates, Measured};
use dwell_geometry::{
    Actuator, Body, BodyId, Coordinate, Drive as Drives, End, Joint, JointId, JointKind, Mechanism,
    Motion, Reaction, Relation, Start, Vec2,
};
use dwell_laws::{Law, Polynomial};
use dwell_kinetostatics::{Load, LoadKind, Magnitude, Mass, Model, ModelError, Signal};
use guard::{Guard, Turning};
pub use journey::{Change, Journey, Leg, Tracked, Why};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Times by which another coordinate must be the faster for the present one to be left.
const FOLDS: f64 = 8.0;
/// What an angle between two moving bodies counts against one from the ground: it may fold sooner.
const RELATIVE: f64 = 0.5;
/// Coordinates tried for a chart before the motion is given up.
const TRIES: usize = 6;
/// Charts in a row in which nothing moves before the motion is given up.
const MOST_IDLE: usize = 3;
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
    /// By coordinate: after how much its branches follow each other again, once that is known, rad.
    periods: Vec<(Coordinate, f64)>,
    size: f64,
}

/// A coordinate that a chart may have.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Candidate {
    name: String,
    coordinate: Coordinate,
    measured: Measured,
    /// What its speed is multiplied by to compare it.
    weight: f64,
}

/// A bridge with the charts below and above it.
#[derive(Debug, Clone)]
pub(crate) struct Crossing {
    bridge: Arc<Bridge>,
    charts: [usize; 2],
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
            periods: Vec::new(),
            size,
        };
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
        let mut journey = Journey::default();
        let mut record = Record::new(start.t, events);
        let (mut chart, mut at) = (0, start.clone());
        let mut options = *options;
        let mut idle = 0;
        loop {
            self.prepare(chart, &options);
            let (trace, turning) = match self.leg(chart, &at, end, &options, &mut record) {
                // What is left after a change is nothing.
                Err(DynamicsError::TooShort) if !journey.legs.is_empty() => return Ok(journey),
                leg => leg?,
            };
            idle = if trace.steps.len() > 1 { 0 } else { idle + 1 };
            options.budget = options.budget.saturating_sub(trace.statistics.steps);
            if let Some(last) = trace.steps.last() {
                at.clone_from(last);
            }
            journey.stopped = trace.stopped;
            journey.failed = trace.failed.clone();
            journey.legs.push(Leg { chart, trace });
            if journey.stopped || (journey.failed.is_none() && at.t >= end) {
                return Ok(journey);
            }
            let turning = match turning {
                None => self.rescue(chart, &at),
                turning => turning,
            };
            // A chart that should be left and cannot be ends the motion; so do charts that lead from
            // one to another and nowhere else.
            let turning = turning.filter(|_| idle < MOST_IDLE);
            let next = turning.and_then(|turning| self.turn(chart, &at, &turning));
            let Some((to, y, why)) = next else {
                let (t, q) = (at.t, at.y.first().copied().unwrap_or(f64::NAN));
                journey
                    .failed
                    .get_or_insert(DynamicsError::Limit { t, q });
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
        let mut watch = |before: &Point, now: &Point, dense: crate::Dense<'_>| {
            guard.watch(before, now, dense, &mut left, |dense| {
                watcher.step(&mut trace, options, before, now, dense)
            })
        };
        let ended = integrate(&mut moving, at, Some(end), options, &mut watch)?;
        trace.failed = ended.failed;
        trace.statistics = ended.statistics;
        Ok((trace, left))
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
        let start = Start { q: vec![q], rough };
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

    /// A mechanism in which the turns of all angles are counted whose values loads depend on, and the
    /// angles of its bodies. Each such angle turns a massless witness.
    fn counting(
        &self,
        mut mechanism: Mechanism,
        states: &BodyStates,
    ) -> (Mechanism, Vec<Option<f64>>) {
        let angle = |b: usize| {
            let state = states.body(BodyId(b));
            Some(state.angle.unwrap_or_else(|| state.turn.angle()))
        };
        let mut rough: Vec<Option<f64>> = (0..mechanism.bodies.len()).map(angle).collect();
        let ground = BodyId(mechanism.ground);
        for bodies in angles_used(&self.site) {
            let by = Coordinate::Angle(bodies);
            if mechanism.actuators.iter().any(|a| a.coordinate() == by) {
                continue;
            }
            let witness = BodyId(mechanism.bodies.len());
            let name = format!("turns of {}", mechanism.body_name(bodies[1]));
            mechanism.bodies.push(Body { name: name.clone() });
            rough.push(Some(states.angle(bodies)[0]));
            let joint = |kind| Joint {
                name: name.clone(),
                bodies: [ground, witness],
                points: [Vec2::ZERO; 2],
                kind,
            };
            let relation = JointKind::Relation(mechanism.relations.len());
            mechanism
                .joints
                .extend([joint(JointKind::Revolute), joint(relation)]);
            mechanism.relations.push(Relation {
                of: Coordinate::Angle([ground, witness]),
                by,
                law: Law::Polynomial(Polynomial {
                    coefficients: vec![0.0, 1.0],
                }),
            });
        }
        (mechanism, rough)
    }

    /// Looks for bridges at the change points in which a chart's range ends.
    fn prepare(&mut self, chart: usize, options: &Options) {
        for (e, upwards) in [(0, false), (1, true)] {
            let own = &mut self.charts[chart];
            let end = own.machine.model.plan().ends()[e].filter(|end| end.change_point);
            let looked = std::mem::replace(&mut own.looked[e], true);
            let known = self.crossings.iter();
            let mut known = known.filter(|c| c.charts[usize::from(!upwards)] == chart);
            let Some(end) = end.filter(|_| !looked && known.next().is_none()) else {
                continue;
            };
            if let Err(error) = self.span(chart, end, upwards, options) {
                self.refused.push((end.q, error));
            }
        }
    }

    /// Builds the bridge across a change point, with the chart behind it.
    fn span(
        &mut self,
        chart: usize,
        end: End,
        upwards: bool,
        options: &Options,
    ) -> Result<(), BridgeError> {
        let own = &self.charts[chart];
        let plan = own.machine.model.plan();
        if own.machine.model.frictions().len() > 0 {
            return Err(BridgeError::Friction);
        }
        if plan.relations() > 0 {
            return Err(BridgeError::Relations);
        }
        let unit = if own.coordinate.is_angle() {
            1.0
        } else {
            self.size
        };
        let half = unit * half_window(plan, options.relative);
        let beyond = 1.5 * half;
        let way = if upwards { 1.0 } else { -1.0 };
        let to = (4.0 * half).max(0.1 * unit);
        let mut angles = ahead(&own.machine.model, end.q, upwards, [half, to], beyond)?;
        angles.truncate(self.site.mechanism.bodies.len());
        let q = end.q + way * beyond;
        let there = self.behind(chart, q, &angles)?;
        let (center, turns) = self.middle(end, there, upwards, half)?;
        let period = self.close_ring(chart, turns)?;
        let charts = if upwards {
            [chart, there]
        } else {
            [there, chart]
        };
        let sides = charts.map(|c| &self.charts[c].shown);
        let bridge = Bridge::new(self.site.mechanism, sides, center, [half, unit])?;
        let bridge = Arc::new(bridge);
        let far = if there == chart { half } else { bridge.reach };
        for (c, above, reach) in [
            (charts[0], false, [-half, far]),
            (charts[1], true, [-far, half]),
        ] {
            self.charts[c].machine.bridges.push(Span {
                bridge: bridge.clone(),
                crossing: self.crossings.len(),
                above,
                reach,
                period,
            });
        }
        self.crossings.push(Crossing { bridge, charts });
        Ok(())
    }

    /// Notes that a coordinate comes back to a chart after some turns (rad); the period that is known
    /// then, if one is.
    fn close_ring(&mut self, chart: usize, turns: f64) -> Result<Option<f64>, BridgeError> {
        let coordinate = self.charts[chart].coordinate;
        let mut known = self.periods.iter().filter(|(c, _)| *c == coordinate);
        let known = known.next().map(|(_, period)| *period);
        if turns == 0.0 {
            return Ok(known);
        }
        match known {
            Some(period) if (turns / period).fract() == 0.0 => Ok(known),
            Some(_) => Err(BridgeError::NotBehind),
            None => {
                self.periods.push((coordinate, turns.abs()));
                let charts = self.charts.iter_mut().filter(|c| c.coordinate == coordinate);
                for span in charts.flat_map(|c| &mut c.machine.bridges) {
                    span.period = Some(turns.abs());
                }
                Ok(Some(turns.abs()))
            }
        }
    }

    /// The change point between the end of one range and the beginning of the next: both stop equally
    /// far from it. The second number is the turns between the two, rad.
    fn middle(
        &self,
        end: End,
        there: usize,
        upwards: bool,
        half: f64,
    ) -> Result<(f64, f64), BridgeError> {
        let plan = self.charts[there].machine.model.plan();
        let [low, high] = plan.ends();
        let opposite = if upwards { low } else { high };
        let Some(opposite) = opposite else {
            return Ok((end.q, 0.0));
        };
        let apart = opposite.q - end.q;
        let turns = if plan.is_angle(0) {
            TAU * (apart / TAU).round()
        } else {
            0.0
        };
        let apart = apart - turns;
        if apart.abs() > 0.5 * half {
            return Err(BridgeError::NotBehind);
        }
        Ok((end.q + 0.5 * apart, turns))
    }

    /// The chart of the same coordinate on the branch with these angles of the bodies.
    fn behind(&mut self, chart: usize, q: f64, angles: &[f64]) -> Result<usize, BridgeError> {
        let own = &self.charts[chart];
        let (name, coordinate) = (own.name.clone(), own.coordinate);
        let on_branch = |chart: &Chart| {
            let plan = chart.machine.model.plan();
            let (mut pose, mut states) = (plan.pose(), BodyStates::new(plan));
            let placed = plan.place(&[q], &mut pose).is_ok();
            states.fill(plan, &pose, &plan.motion());
            let near = |(b, angle): (usize, &f64)| {
                let off = states.body(BodyId(b)).turn.angle() - angle;
                // Two branches part by about the distance from the change point.
                (off - TAU * (off / TAU).round()).abs() < 1e-3
            };
            placed && angles.iter().enumerate().all(near)
        };
        let known = |c: &Chart| c.coordinate == coordinate && on_branch(c);
        if let Some(found) = self.charts.iter().position(known) {
            return Ok(found);
        }
        let actuator = actuator(self.site.mechanism, name, coordinate);
        let mechanism = Mechanism {
            actuators: vec![actuator.ok_or(BridgeError::NotBehind)?],
            ..self.site.mechanism.clone()
        };
        let start = Start {
            q: vec![q],
            rough: angles.iter().map(|&a| Some(a)).collect(),
        };
        let built = self.build(&mechanism, &start);
        let built = built.map_err(|_| BridgeError::NotBehind)?;
        if !on_branch(&built) {
            return Err(BridgeError::NotBehind);
        }
        self.charts.push(built);
        Ok(self.charts.len() - 1)
    }
}

/// The angles whose values, not only speeds, a load or drive depends on.
fn angles_used(site: &Site<'_>) -> Vec<[BodyId; 2]> {
    let mut used = Vec::new();
    let mut of = |magnitude: &Magnitude| {
        let signals = match magnitude {
            Magnitude::Law(signal, _) => std::slice::from_ref(signal),
            Magnitude::Expression(_, signals) => signals.as_slice(),
            _ => &[],
        };
        for signal in signals {
            if let Signal::Value(Coordinate::Angle(bodies)) = signal {
                used.push(*bodies);
            }
        }
    };
    for load in site.loads {
        of(&load.magnitude);
    }
    for drive in site.drives {
        match &drive.kind {
            DriveKind::Action(magnitude) => of(magnitude),
            DriveKind::Motor(motor) => of(&motor.voltage),
            DriveKind::Regulator(regulator) => of(&regulator.speed),
        }
    }
    used.extend(site.loads.iter().filter_map(|load| match load.kind {
        LoadKind::TorsionSpring { bodies, .. } => Some(bodies),
        _ => None,
    }));
    used
}

/// An actuator of a coordinate; none of a joint that is not there.
fn actuator(mechanism: &Mechanism, name: String, coordinate: Coordinate) -> Option<Actuator> {
    let (bodies, drive) = match coordinate {
        Coordinate::Angle(bodies) => (bodies, Drives::Angle),
        Coordinate::Travel(joint) => {
            let bodies = mechanism.joints.get(joint.0)?.bodies;
            (bodies, Drives::Travel(joint))
        }
        Coordinate::Length { bodies, points } => (bodies, Drives::Length(points)),
    };
    Some(Actuator {
        name,
        bodies,
        drive,
    })
}

/// The mechanism's own coordinate, the angles of all bodies and of all hinges, and all travels.
fn candidates(mechanism: &Mechanism, size: f64) -> Vec<Candidate> {
    let mut found: Vec<Candidate> = Vec::new();
    let ground = BodyId(mechanism.ground);
    let mut add = |name: String, coordinate: Coordinate| {
        let turned = |c: Coordinate| match c {
            Coordinate::Angle([a, b]) => Coordinate::Angle([b, a]),
            other => other,
        };
        let known = |c: &Candidate| c.coordinate == coordinate || c.coordinate == turned(coordinate);
        if found.iter().any(known) {
            return;
        }
        let weight = match coordinate {
            Coordinate::Angle(bodies) if bodies.contains(&ground) => 1.0,
            Coordinate::Angle(_) => RELATIVE,
            _ => 1.0 / size,
        };
        if let Some(measured) = Measured::find(mechanism, coordinate) {
            found.push(Candidate {
                name,
                coordinate,
                measured,
                weight,
            });
        }
    };
    if let Some(own) = mechanism.actuators.first() {
        add(own.name.clone(), own.coordinate());
    }
    for b in (0..mechanism.bodies.len()).map(BodyId) {
        if b != ground {
            let name = format!("angle of {}", mechanism.body_name(b));
            add(name, Coordinate::Angle([ground, b]));
        }
    }
    for (j, joint) in mechanism.joints.iter().enumerate() {
        match joint.kind {
            JointKind::Revolute => {
                let name = format!("angle in {}", joint.name);
                add(name, Coordinate::Angle(joint.bodies));
            }
            JointKind::Prismatic { .. } | JointKind::Slot { .. } => {
                let name = format!("travel in {}", joint.name);
                add(name, Coordinate::Travel(JointId(j)));
            }
            _ => {}
        }
    }
    found
}

/// The largest distance of two points of one body, m.
fn size(mechanism: &Mechanism) -> f64 {
    let mut size = 0.0_f64;
    let mut first = vec![None; mechanism.bodies.len()];
    let joints = mechanism.joints.iter().map(|j| (j.bodies, j.points));
    let lengths = mechanism.actuators.iter().filter_map(|a| match a.drive {
        Drives::Length(points) => Some((a.bodies, points)),
        _ => None,
    });
    for (bodies, points) in joints.chain(lengths) {
        for (body, point) in bodies.iter().zip(points) {
            if let Some(first) = first.get_mut(body.0) {
                let first = first.get_or_insert(point);
                size = size.max((point - *first).norm());
            }
        }
    }
    if size > 0.0 { size } else { 1.0 }
}
