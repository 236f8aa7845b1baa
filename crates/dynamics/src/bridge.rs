//! Change points crossed on their branch: a parallelogram passing its flat position.
//!
//! Dyad by dyad, ½m′/m errs there as N·eps/|sin θ|³ (N dyads, θ from the flat position), though the branch
//! itself is smooth. So poses from both sides of a window, where that exceeds the tolerance, are fitted by
//! polynomials orthogonal on their nodes, and the window is bridged:
//!
//! ```text
//! m = Σ m v² + I ω²,  ½m′ = Σ m v·a + I ω α,  Q = Σ F·v     at q̇ = 1, q̈ = 0             (1)
//! ```
//!
//! There is no multiplier in (1). Reactions that the flat position determines are fitted across it too,
//! at the state's own speed and acceleration; of the others, which grow beyond all bounds, there is none.

mod fit;

use crate::error::DynamicsError;
use crate::machine::{Machine, MachineWork};
use dwell_geometry::measure::BodyStates;
use dwell_geometry::mobility::mobility_here;
use dwell_geometry::{Mechanism, Motion, PlaceError, Plan, Pose, Reaction, Scalar};
use dwell_kinetostatics::{Actions, Model, Workspace};
use fit::{Fit, nodes};
use std::f64::consts::TAU;
use std::sync::Arc;

/// Nodes of a fit on each side of the window, and its highest degree.
const NODES: usize = 24;
const HIGHEST: usize = 20;
/// The same of the reactions.
const REACTION_NODES: usize = 8;
const REACTION_DEGREE: usize = 8;
/// Degree of the fit from one side that leads to the other: it need only tell the branches apart.
const AHEAD_DEGREE: usize = 5;
/// Half the widest window, rad, and the tightest tolerance that one is made for.
const WIDEST: f64 = 0.2;
const TIGHTEST: f64 = 1e-12;
/// A looser tolerance is no reason for a window in which nothing is known.
const LOOSEST: f64 = 1e-9;
/// How far from the change point poses are fitted, rad: the farthest of the good ones is taken.
const REACHES: [f64; 5] = [0.15, 0.3, 0.5, 0.8, 1.2];
/// Largest gap between a bridge and the plan at its ends, in first and second derivatives.
const MEETS: f64 = 1e-6;
/// A gap below this is as good as any.
const ROUNDING: f64 = 1e-11;

/// Why a change point cannot be crossed.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum BridgeError {
    /// Friction depends on reactions that grow beyond all bounds there.
    #[error("friction depends on reactions that are not determined at the change point")]
    Friction,
    /// Whole turns are counted in it.
    #[error("a mechanism with gears or related coordinates is not carried through a change point")]
    Relations,
    /// There is no pose next to it.
    #[error(transparent)]
    Place(#[from] PlaceError),
    /// What comes on the other side does not go together.
    #[error("the branch cannot be put together behind the change point")]
    NotBehind,
    /// The branch is not smooth.
    #[error("the branch is not smooth there: its fit is {gap:.1e} off the plan")]
    NotSmooth {
        /// Largest gap in the derivatives of the angles.
        gap: f64,
    },
}

/// The way across one change point.
#[derive(Debug, Clone, PartialEq)]
pub struct Bridge {
    /// The change point, rad or m.
    pub center: f64,
    /// Half the window in which the fit takes the place of the plan, rad or m.
    pub half: f64,
    /// How far the fit is good to either side, rad or m.
    pub reach: f64,
    /// How far it is off the plan at the window's ends, in the first two derivatives of the angles (and
    /// travels over the mechanism's size) by the coordinate.
    pub gap: f64,
    /// Degrees of freedom at the change point; elsewhere there is one.
    pub mobility: usize,
    /// The reactions that the loads do not determine there.
    pub not_unique: Vec<Reaction>,
    /// The branch before and behind, by the coordinate, with all the reactions that are shown.
    pub(crate) sides: [Model; 2],
    fit: Fit,
}

/// The part of the coordinate on which a machine goes by a bridge.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Span {
    pub(crate) bridge: Arc<Bridge>,
    /// Index of the crossing it belongs to, and whether the machine is that of the branch above.
    pub(crate) crossing: usize,
    pub(crate) above: bool,
    /// From and to, from the change point.
    pub(crate) reach: [f64; 2],
    /// After how much the branches before and behind follow each other again, rad.
    pub(crate) period: Option<f64>,
}

impl Span {
    /// How far a coordinate is from the change point, if it is on the bridge.
    fn on(&self, q: f64) -> Option<f64> {
        let x = self.offset(q);
        (self.reach[0]..=self.reach[1]).contains(&x).then_some(x)
    }

    fn offset(&self, q: f64) -> f64 {
        let x = q - self.bridge.center;
        x - self
            .period
            .map_or(0.0, |period| period * (x / period).round())
    }

    /// Whether a coordinate is so far behind the window that the machine of the branch there goes on.
    pub(crate) fn crossed(&self, q: f64) -> bool {
        let half = self.bridge.half;
        let behind = |x: f64| if self.above { x < -half } else { x > half };
        self.on(q).is_some_and(behind)
    }
}

/// Half the window for a tolerance, rad: where N·eps/|sin θ|³ exceeds it.
pub(crate) fn half_window(plan: &Plan, tolerance: f64) -> f64 {
    let groups = plan.group_kinds().len() as f64;
    let tolerance = tolerance.clamp(TIGHTEST, LOOSEST);
    (groups * f64::EPSILON / tolerance).cbrt().min(WIDEST)
}

/// Angles of the frames, each next to the one before, and travels of the slides.
fn sample(
    plan: &Plan,
    q: f64,
    pose: &mut Pose<f64>,
    last: Option<&Vec<f64>>,
) -> Result<Vec<f64>, PlaceError> {
    plan.place(&[q], pose)?;
    let angle = |(f, turn): (usize, &dwell_geometry::Vec2)| {
        let angle = turn.angle();
        let near = last.map_or(angle, |last| last[f]);
        angle + TAU * ((near - angle) / TAU).round()
    };
    let mut found: Vec<f64> = pose.turn.iter().enumerate().map(angle).collect();
    found.extend_from_slice(&pose.slide);
    Ok(found)
}

/// The angles of all bodies at a distance `x` behind a change point at `center`, from the poses between
/// the distances `from` and `to` before it; `upwards` if it lies above them.
pub(crate) fn ahead(
    model: &Model,
    center: f64,
    upwards: bool,
    [from, to]: [f64; 2],
    x: f64,
) -> Result<Vec<f64>, BridgeError> {
    let plan = model.plan();
    let way = if upwards { 1.0 } else { -1.0 };
    let mut pose = plan.pose();
    let nodes: Vec<f64> = nodes(from, to, NODES).map(|d| -way * d).collect();
    let mut samples: Vec<Vec<f64>> = Vec::new();
    for &node in &nodes {
        samples.push(sample(plan, center + node, &mut pose, samples.last())?);
    }
    let fit = Fit::new(&nodes, &samples, to, AHEAD_DEGREE);
    let mut values = fit.room();
    fit.at(way * x, &mut Vec::new(), &mut values);
    let mut own = CrossWork::new(model);
    own.values = values;
    own.impose(plan, &[center + way * x], &mut pose);
    own.moves.fill(plan, &pose, &own.trial);
    let bodies = (0..own.moves.len()).map(dwell_geometry::BodyId);
    Ok(bodies.map(|b| own.moves.body(b).turn.angle()).collect())
}

impl Bridge {
    /// The bridge between the branch below and the one above a change point, with half its window; `unit`
    /// is 1 for an angle and the mechanism's size for a length.
    ///
    /// # Errors
    /// [`BridgeError`] where the branch is not smooth enough.
    pub(crate) fn new(
        mechanism: &Mechanism,
        sides: [&Model; 2],
        center: f64,
        [half, unit]: [f64; 2],
    ) -> Result<Self, BridgeError> {
        let room = |model: &Model| match model.plan().range().limits() {
            Some((from, to)) => 0.45 * (to - from),
            None => f64::INFINITY,
        };
        let most = room(sides[0]).min(room(sides[1]));
        let reaches = REACHES.map(|reach| (reach * unit).max(1.5 * half).min(most));
        let mut fits: Vec<(f64, f64, Fit)> = Vec::with_capacity(reaches.len());
        for reach in reaches {
            let fit = Self::fit(sides, center, half, reach)?;
            let gap = gap(&fit, sides, center, [half, unit])?;
            fits.push((gap, reach, fit));
        }
        let least = fits.iter().map(|f| f.0).fold(f64::INFINITY, f64::min);
        // A far reach catches steps that lead over the window.
        let good = |gap: f64| gap <= (10.0 * least).max(ROUNDING);
        let best = fits.into_iter().rev().find(|f| good(f.0));
        let Some((gap, reach, fit)) = best.filter(|f| f.0 <= MEETS) else {
            return Err(BridgeError::NotSmooth { gap: least });
        };
        let mut bridge = Self {
            center,
            half,
            reach,
            gap,
            mobility: 1,
            not_unique: Vec::new(),
            sides: sides.map(Clone::clone),
            fit,
        };
        bridge.look_at_center(mechanism);
        Ok(bridge)
    }

    fn fit(sides: [&Model; 2], center: f64, half: f64, reach: f64) -> Result<Fit, BridgeError> {
        let mut below: Vec<f64> = nodes(half, reach, NODES).map(|d| -d).collect();
        below.reverse();
        let above: Vec<f64> = nodes(half, reach, NODES).collect();
        let mut samples: Vec<Vec<f64>> = Vec::with_capacity(2 * NODES);
        for (model, nodes) in sides.iter().zip([&below, &above]) {
            let mut pose = model.plan().pose();
            for &node in nodes {
                let found = sample(model.plan(), center + node, &mut pose, samples.last())?;
                samples.push(found);
            }
        }
        let nodes = [below, above].concat();
        Ok(Fit::new(&nodes, &samples, reach, HIGHEST))
    }

    /// What moves at the change point, and which reactions are determined there.
    fn look_at_center(&mut self, mechanism: &Mechanism) {
        let plan = self.sides[0].plan();
        let mut own = CrossWork::new(&self.sides[0]);
        let mut pose = plan.pose();
        self.fit.at(0.0, &mut own.powers, &mut own.values);
        own.impose(plan, &[self.center], &mut pose);
        own.moves.fill(plan, &pose, &own.trial);
        if let Some(here) = mobility_here(mechanism, &own.moves) {
            self.mobility = here.freedom();
            let all = mechanism.reactions().into_iter().zip(&here.unique);
            self.not_unique = all
                .filter(|(_, unique)| !**unique)
                .map(|(r, _)| r)
                .collect();
        }
    }

    /// As [`Machine::show`] within the window. A reaction that is not determined at the change point is
    /// not a number.
    pub(crate) fn show(
        &self,
        x: f64,
        shown: &Model,
        t: f64,
        work: &MachineWork<f64>,
        all: &mut Workspace<f64>,
        actions: &mut Actions<f64>,
    ) -> Result<(), DynamicsError> {
        // The bodies and loads are as the machine has them.
        all.pose.clone_from(&work.inner.pose);
        all.motion.clone_from(&work.inner.motion);
        shown.enter_placed(t, &work.q_dot, all)?;
        for (load, &magnitude) in work.inner.loads().magnitude.iter().enumerate() {
            all.give(load, magnitude);
        }
        shown.push(all)?;
        actions.tau.fill(0.0);
        let q = work.q.first().copied().unwrap_or(self.center);
        let near = q - x;
        // Reactions are known worse than poses, and needed in the window alone.
        let reach = self.reach.min(3.0 * self.half);
        let (mut at, mut samples) = (Vec::new(), Vec::new());
        for (model, way) in self.sides.iter().zip([-1.0, 1.0]) {
            let mut there = model.workspace();
            let mut found = model.actions();
            for d in nodes(self.half, reach, REACTION_NODES) {
                for (load, one) in model.loads().iter().enumerate() {
                    if matches!(one.magnitude, dwell_kinetostatics::Magnitude::Given(_)) {
                        there.give(load, work.inner.loads().magnitude[load]);
                    }
                }
                let q = [near + way * d];
                let rates = (&work.q_dot, &work.q_ddot);
                model.kinetostatics(t, &q, rates.0, rates.1, &mut there, &mut found)?;
                at.push(way * d);
                samples.push(found.reactions.clone());
            }
        }
        let fit = Fit::new(&at, &samples, reach, REACTION_DEGREE);
        let mut values = fit.room();
        fit.at(x, &mut Vec::new(), &mut values);
        for (own, reaction) in actions.reactions.iter_mut().zip(shown.reactions()) {
            let of_sides = self.sides[0].reactions().iter().position(|r| r == reaction);
            let determined = !self.not_unique.contains(reaction);
            *own = match of_sides.filter(|_| determined) {
                Some(k) => values[k][0],
                None => f64::NAN,
            };
        }
        Ok(())
    }
}

/// The largest gap between a fit and the plans at the window's ends, in first and second derivatives.
fn gap(
    fit: &Fit,
    sides: [&Model; 2],
    center: f64,
    [half, unit]: [f64; 2],
) -> Result<f64, BridgeError> {
    let mut values = fit.room();
    let mut largest = 0.0_f64;
    for (model, way) in sides.iter().zip([-1.0, 1.0]) {
        let plan = model.plan();
        let (mut pose, mut motion) = (plan.pose(), plan.motion());
        plan.place(&[center + way * half], &mut pose)?;
        plan.speeds(&pose, &[1.0], &mut motion);
        plan.accelerations(&pose, &[0.0], &mut motion);
        fit.at(way * half, &mut Vec::new(), &mut values);
        let (frames, slides) = values.split_at(motion.turn.len());
        let turning = frames.iter().zip(motion.turn.iter().zip(&motion.turn_rate));
        for ([_, first, second], (speed, rate)) in turning {
            let off = [(first - speed) * unit, (second - rate) * unit * unit];
            largest = off.iter().fold(largest, |most, off| most.max(off.abs()));
        }
        let sliding = slides
            .iter()
            .zip(motion.slide.iter().zip(&motion.slide_rate));
        for ([_, first, second], (speed, rate)) in sliding {
            let off = [first - speed, (second - rate) * unit];
            largest = off.iter().fold(largest, |most, off| most.max(off.abs()));
        }
    }
    Ok(largest)
}

/// Working memory for the way across a bridge.
#[derive(Debug, Clone)]
pub(crate) struct CrossWork<T> {
    powers: Vec<[T; 3]>,
    /// By frame and then by slide: value and derivatives by the coordinate.
    values: Vec<[T; 3]>,
    angles: Vec<T>,
    slides: Vec<T>,
    /// The motion at unit speed, and the bodies in it.
    trial: Motion<T>,
    moves: BodyStates<T>,
}

impl<T: Scalar> CrossWork<T> {
    fn new(model: &Model) -> Self {
        let plan = model.plan();
        let trial = plan.motion();
        let (frames, slides) = (trial.turn.len(), trial.slide.len());
        Self {
            powers: Vec::with_capacity(HIGHEST + 1),
            values: vec![[T::lift(0.0); 3]; frames + slides],
            angles: vec![T::lift(0.0); frames],
            slides: vec![T::lift(0.0); slides],
            trial,
            moves: BodyStates::new(plan),
        }
    }

    /// Sets a pose to the values.
    fn impose(&mut self, plan: &Plan, q: &[T], pose: &mut Pose<T>) {
        let places = self.angles.iter_mut().chain(&mut self.slides);
        for (place, value) in places.zip(&self.values) {
            *place = value[0];
        }
        plan.impose(q, &self.angles, &self.slides, pose);
    }
}

/// Sets a motion to some derivatives by the coordinate at its speed and acceleration.
fn moving<T: Scalar>(values: &[[T; 3]], [q_dot, q_ddot]: [T; 2], motion: &mut Motion<T>) {
    let speeds = motion.turn.iter_mut().chain(&mut motion.slide);
    let rates = motion.turn_rate.iter_mut().chain(&mut motion.slide_rate);
    for ((speed, rate), [_, first, second]) in speeds.zip(rates).zip(values) {
        *speed = *first * q_dot;
        *rate = *first * q_ddot + *second * q_dot * q_dot;
    }
}

impl Machine {
    /// The bridge that holds a coordinate, if one does, and how far that is from the change point.
    #[inline]
    pub(crate) fn bridge_at<T: Scalar>(&self, q: Option<&T>) -> Option<(&Bridge, f64)> {
        if self.bridges.is_empty() {
            return None;
        }
        let q = q?.value();
        let mut spans = self.bridges.iter();
        spans.find_map(|span| Some((span.bridge.as_ref(), span.on(q)?)))
    }

    /// Whether a state is on the bridge across a change point. There are the states of bodies and loads
    /// there, and the reactions that [`Machine::show`] finds, but no others.
    pub fn on_bridge(&self, y: &[f64]) -> bool {
        self.bridge_at(y.first()).is_some()
    }

    /// As [`Machine::evaluate`] on a bridge, by (1). `memory` are the drives' states.
    pub(crate) fn cross<T: Scalar>(
        &self,
        (bridge, x): (&Bridge, f64),
        t: f64,
        memory: &[T],
        work: &mut MachineWork<T>,
    ) -> Result<(), DynamicsError> {
        let new = || Box::new(CrossWork::new(&self.model));
        let mut own = work.crossing.take().unwrap_or_else(new);
        let done = self.cross_with((bridge, x), t, memory, work, &mut own);
        work.crossing = Some(own);
        done
    }

    fn cross_with<T: Scalar>(
        &self,
        (bridge, x): (&Bridge, f64),
        t: f64,
        memory: &[T],
        work: &mut MachineWork<T>,
        own: &mut CrossWork<T>,
    ) -> Result<(), DynamicsError> {
        let plan = self.model.plan();
        let (q, q_dot) = (work.q[0], work.q_dot[0]);
        let x = q - T::lift(q.value() - x);
        let (zero, one) = (T::lift(0.0), T::lift(1.0));
        bridge.fit.at(x, &mut own.powers, &mut own.values);
        own.impose(plan, &work.q, &mut work.inner.pose);
        moving(&own.values, [one, zero], &mut own.trial);
        own.moves.fill(plan, &work.inner.pose, &own.trial);
        moving(&own.values, [q_dot, zero], &mut work.inner.motion);
        self.model.enter_placed(t, &work.q_dot, &mut work.inner)?;
        self.drive(t, memory, work)?;
        self.model.push(&mut work.inner)?;
        let [mut m, mut half_dm] = self.model.sums(&own.moves);
        for drive in &self.drives {
            let [_, first, second] = own.moves.measure(drive.measured);
            m += T::lift(drive.inertia) * first * first;
            half_dm += T::lift(drive.inertia) * first * second;
        }
        let inertia = m.value();
        if !(inertia > 0.0 && inertia.is_finite()) {
            return Err(DynamicsError::NoInertia {
                q: q.value(),
                m: inertia,
            });
        }
        let mut force = zero;
        for act in &work.inner.loads().acts {
            force += act.power(&own.moves);
        }
        let q_ddot = (force - half_dm * q_dot * q_dot) / m;
        work.q_ddot[0] = q_ddot;
        moving(&own.values, [q_dot, q_ddot], &mut work.inner.motion);
        work.inner.refill(&self.model);
        self.net(work)
    }
}
