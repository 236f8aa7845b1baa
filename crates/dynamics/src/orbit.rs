//! The conservative motion of a mechanism of one degree of freedom, by quadrature: no integrator.
//!
//! Its kinetic energy E_c(q) follows from its coordinate. With a phase s that grows by 2π in a period,
//!
//! ```text
//! rotation   q = q₀ + P s/2π             dt/ds = (P/2π) √(m / 2E_c)        (1)
//! libration  q = (a + b)/2 − h cos s     dt/ds = √(m / 2g)                 (2)
//!            g = E_c / ((q − a)(b − q)),   h = (b − a)/2
//! t(s) = c₀ s + Σ (c_k sin ks + s_k (1 − cos ks)) / k                     (3)
//! T = ∮ dt/ds ds = 2π c₀                                                  (4)
//! ```
//!
//! with P the angle after which the motion repeats, a and b the turning points, and c_k, s_k the Fourier coefficients of dt/ds. Both
//! kinds of dt/ds are smooth and periodic, so that (4) by the trapezoidal rule has all digits, and so has the time history (3). Where
//! dt/ds is too sharp for equally spaced points, next to a maximum of V or where the inertia is small, it is integrated on panels.
//! The same is done if a body turns between two points by more than its rates predict, because a peak of m may lie between them.

use crate::close_branches::is_too_close;
use crate::conservative::{ConservativeSystem, LoadedSystem, UnloadedSystem};
use crate::error::{DynamicsError, Result};
use crate::libration::{SampledLibration, nearest_phase, phase_of, turning_points};
use crate::machine::{Machine, MovingModel};
use crate::motion_class::{EnergyScan, MotionClass};
use crate::ode::{OdeState, ReducedState};
use crate::rotation::SampledRotation;
use crate::time_density::{ResolvedMotion, TimeDensity};
use dwell_geometry::NearBranch;
use dwell_kinetostatics::{Model, ReducedModel};
use dwell_numerics::fourier::MIN_POINTS;
use std::f64::consts::TAU;

/// Points of the coarsest rule of a sequence.
const MIN_SEQUENCE_POINTS: usize = 16;
/// Steps of Newton's method, halvings among them, to a phase.
const MAX_NEWTON_STEPS: usize = 100;

/// A conservative motion that repeats itself, known at every time.
#[derive(Debug, Clone, PartialEq)]
pub struct Orbit {
    initial_state: ReducedState,
    /// Duration of one period, s.
    pub period: f64,
    /// Kinetic and potential energy, J.
    pub energy: f64,
    /// The largest kinetic energy at the points of the rule, J.
    pub max_kinetic: f64,
    /// Points of the rule that resolved it.
    pub points: usize,
    /// The last Fourier coefficients relative to the mean. If the orbit is resolved, they are at the level of rounding
    /// of a point.
    pub tail: f64,
    /// Whether more points would change roundings only.
    pub is_resolved: bool,
    /// Whether it is a rotation or a libration, and where.
    pub motion_class: MotionClass,
    kind: OrbitKind,
    /// Phase of the start, and the time (s) from phase zero to it.
    initial_phase: f64,
    time_offset: f64,
    /// dt/ds, s/rad.
    time_density: TimeDensity,
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum OrbitKind {
    /// Growth of the coordinate in a period, rad.
    Rotation(f64),
    /// The turning points.
    Libration([f64; 2]),
}

impl Orbit {
    /// The motion of a model without loads.
    ///
    /// # Errors
    /// [`DynamicsError::NoFullRevolution`], [`DynamicsError::AtRest`], [`DynamicsError::EnergyOutOfRange`],
    /// [`DynamicsError::NoInertia`], or [`DynamicsError::NotResolved`] when the inertia varies too
    /// sharply.
    pub fn new<R: ReducedModel>(model: &R, start: ReducedState) -> Result<Self> {
        Self::to_accuracy(model, start, 0.0)
    }

    /// The orbit to an accuracy: with the fewest points whose truncation error is below this fraction of the mean, so
    /// that the error of times is about this fraction of a period.
    ///
    /// # Errors
    /// As [`Orbit::new`].
    pub fn to_accuracy<R: ReducedModel>(
        model: &R,
        start: ReducedState,
        accuracy: f64,
    ) -> Result<Self> {
        let workspace = model.workspace();
        Self::of_system(&mut UnloadedSystem { model, workspace }, start, accuracy)
    }

    /// The motion of a machine of one degree of freedom whose loads all have a potential.
    ///
    /// # Errors
    /// As [`Orbit::new`]; [`DynamicsError::NotConservative`], [`DynamicsError::AsymptoticMotion`],
    /// [`DynamicsError::Undecided`].
    pub fn loaded<M: MovingModel>(machine: &Machine<M>, start: ReducedState) -> Result<Self> {
        Self::of_system(&mut LoadedSystem::new(machine)?, start, 0.0)
    }

    fn of_system(
        system: &mut dyn ConservativeSystem,
        start: ReducedState,
        accuracy: f64,
    ) -> Result<Self> {
        let mut samples = SampledOrbit::new(system, start, MIN_POINTS)?;
        loop {
            let orbit = samples.next(system, accuracy)?;
            if orbit.is_resolved || orbit.tail < accuracy {
                return Ok(orbit);
            }
        }
    }

    /// The motion that a rule has resolved; `initial_phase` is that of the start.
    fn from_rule(of: &SampledOrbit, resolved: ResolvedMotion) -> Self {
        let time_density = resolved.time_density;
        let (kind, time_offset) = match &of.kind {
            SampledKind::Rotation(rotation) => {
                (OrbitKind::Rotation(rotation.angle_per_period), 0.0)
            }
            SampledKind::Libration(libration) => (
                OrbitKind::Libration(libration.turning_points),
                time_density.eval(of.initial_phase)[1],
            ),
        };
        Self {
            initial_state: of.start,
            period: TAU * time_density.mean(),
            energy: of.energy,
            max_kinetic: resolved.max_kinetic,
            points: resolved.points,
            is_resolved: resolved.is_resolved,
            tail: time_density.tail(),
            motion_class: of.motion_class,
            kind,
            initial_phase: of.initial_phase,
            time_offset,
            time_density,
        }
    }

    /// The state at the start.
    pub fn initial_state(&self) -> ReducedState {
        self.initial_state
    }

    /// Whether it passes a place where another assembly branch is so close that rounding does not show which of the two
    /// the motion follows.
    pub fn passes_close_branches(&self, machine: &Machine) -> bool {
        let plan = machine.model().plan();
        let visits = |near: &NearBranch| match self.kind {
            OrbitKind::Rotation(_) => true,
            OrbitKind::Libration([a, b]) => {
                let period = plan.range().period().unwrap_or(TAU);
                let angle = near.q + period * ((a - near.q) / period).ceil();
                let q = if plan.is_angle(0) { angle } else { near.q };
                (a..=b).contains(&q)
            }
        };
        let mut near = plan.near_branches().iter();
        near.any(|near| is_too_close(near, plan) && visits(near))
    }

    /// The first time (s), not before the start, at which the coordinate is `q` (rad or m), by (3); of a rotation
    /// also a time before the start. `None` if a libration never reaches `q`.
    pub fn time_at(&self, q: f64) -> Option<f64> {
        match self.kind {
            OrbitKind::Rotation(angle_per_period) => {
                let periods = (q - self.initial_state.q) / angle_per_period;
                let whole_periods = periods.floor();
                let [_, elapsed] = self.time_density.eval(TAU * (periods - whole_periods));
                Some(self.initial_state.t + self.period * whole_periods + elapsed)
            }
            OrbitKind::Libration(turning_points) => {
                let up = phase_of(q, turning_points)?;
                let mut phases = [up, TAU - up, TAU + up].into_iter();
                let first = phases.find(|&phase| phase >= self.initial_phase);
                let [_, time] = self.time_density.eval(first.unwrap_or(2.0 * TAU - up));
                Some(self.initial_state.t + time - self.time_offset)
            }
        }
    }

    /// The times (s) after the start at which the phase has grown by equal parts of a period; the last is the period.
    pub fn times_of_parts(&self, parts: usize) -> Vec<f64> {
        let time = |k: usize| {
            let phase = self.initial_phase + TAU * k as f64 / parts as f64;
            self.time_density.eval(phase)[1] - self.time_offset
        };
        (1..parts).map(time).chain([self.period]).collect()
    }

    /// The state a number of periods after another.
    pub(crate) fn after_periods(&self, state: &OdeState, periods: f64) -> OdeState {
        let mut later = state.clone();
        later.t += periods * self.period;
        if let (OrbitKind::Rotation(angle_per_period), Some(q)) = (self.kind, later.y.first_mut()) {
            *q += periods * angle_per_period;
        }
        later
    }

    /// The state at time `t` (s), by Newton's method on (3).
    pub fn state_at(&self, t: f64) -> ReducedState {
        let periods = ((t - self.initial_state.t) / self.period).floor();
        let wanted = t - self.initial_state.t - periods * self.period + self.time_offset;
        let (mut low, mut high) = (self.initial_phase, self.initial_phase + TAU);
        let mut phase = low + (wanted - self.time_offset) / self.period * TAU;
        for _ in 0..MAX_NEWTON_STEPS {
            let [time_density, time] = self.time_density.eval(phase);
            let residual = wanted - time;
            if residual > 0.0 {
                low = phase;
            } else {
                high = phase;
            }
            let mut next = phase + residual / time_density;
            if !(low..=high).contains(&next) {
                next = 0.5 * (low + high);
            }
            let step = (next - phase).abs();
            phase = next;
            if step <= 4.0 * f64::EPSILON * (1.0 + phase) {
                break;
            }
        }
        let [time_density, _] = self.time_density.eval(phase);
        let (q, by_phase) = match self.kind {
            OrbitKind::Rotation(angle_per_period) => (
                self.initial_state.q + angle_per_period * (periods + phase / TAU),
                angle_per_period / TAU,
            ),
            OrbitKind::Libration([a, b]) => {
                let (sin, cos) = phase.sin_cos();
                let half = 0.5 * (b - a);
                (a + half * (1.0 - cos), half * sin)
            }
        };
        ReducedState {
            t,
            q,
            q_dot: by_phase / time_density,
        }
    }
}

/// The orbits of one motion with increasing numbers of points. The error of one is its difference from the next.
pub struct OrbitSequence<M: MovingModel = Model> {
    system: LoadedSystem<M>,
    samples: SampledOrbit,
}

impl<M: MovingModel> OrbitSequence<M> {
    /// The sequence for a machine, as [`Orbit::loaded`].
    ///
    /// # Errors
    /// As [`Orbit::loaded`].
    pub fn loaded(machine: &Machine<M>, start: ReducedState) -> Result<Self> {
        let mut system = LoadedSystem::new(machine)?;
        let samples = SampledOrbit::new(&mut system, start, MIN_SEQUENCE_POINTS)?;
        Ok(Self { system, samples })
    }

    /// The orbit with twice as many points as the previous one. A motion too sharp for equally spaced points is
    /// resolved on panels, unless the truncation error of its rule is below the accuracy (relative to the period).
    ///
    /// # Errors
    /// As [`Orbit::loaded`].
    pub fn next_orbit(&mut self, accuracy: f64) -> Result<Orbit> {
        self.samples.next(&mut self.system, accuracy)
    }
}

/// A motion that is sampled at more and more points.
struct SampledOrbit {
    start: ReducedState,
    energy: f64,
    motion_class: MotionClass,
    kind: SampledKind,
    initial_phase: f64,
    first_points: usize,
}

enum SampledKind {
    Rotation(SampledRotation),
    Libration(SampledLibration),
}

impl SampledOrbit {
    fn new(
        system: &mut dyn ConservativeSystem,
        start: ReducedState,
        first_points: usize,
    ) -> Result<Self> {
        let range = system.range();
        let (scan, class) = EnergyScan::new(&mut *system, start)?;
        let (potential, kinetic) = (scan.initial_terms.potential, scan.kinetic);
        let (kind, motion_class, initial_phase) = match class {
            MotionClass::Rotation { period, .. } => {
                let angle_per_period = period * start.q_dot.signum();
                let energies = [kinetic, potential];
                let rotation = SampledRotation::new(start.q, energies, angle_per_period);
                (SampledKind::Rotation(rotation), class, 0.0)
            }
            MotionClass::Libration {
                turning_points: approximate,
            } => {
                let turning_points = turning_points(system, start.q, kinetic, approximate)?;
                let class = MotionClass::Libration { turning_points };
                let up = nearest_phase(start.q, turning_points);
                let phase = if start.q_dot < 0.0 { TAU - up } else { up };
                let libration = SampledLibration::new(turning_points);
                (SampledKind::Libration(libration), class, phase)
            }
            MotionClass::Asymptotic { to: q } => return Err(DynamicsError::AsymptoticMotion { q }),
            MotionClass::Equilibrium => return Err(DynamicsError::AtRest),
            MotionClass::Undecided { to: q } => return Err(DynamicsError::Undecided { q }),
            MotionClass::ReachesLimit { at } => {
                let (from, to) = range.limits().unwrap_or((at, at));
                return Err(DynamicsError::NoFullRevolution { from, to });
            }
        };
        Ok(Self {
            start,
            energy: kinetic + potential,
            motion_class,
            kind,
            initial_phase,
            first_points,
        })
    }

    /// The orbit by twice as many points as the one before.
    fn next(&mut self, system: &mut dyn ConservativeSystem, accuracy: f64) -> Result<Orbit> {
        let first = self.first_points;
        let resolved = match &mut self.kind {
            SampledKind::Rotation(rotation) => rotation.next(system, first, accuracy)?,
            SampledKind::Libration(libration) => libration.next(system, first, accuracy)?,
        };
        Ok(Orbit::from_rule(self, resolved))
    }
}
