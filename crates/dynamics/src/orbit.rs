//! The conservative motion of a mechanism of one degree of freedom, by quadrature: no integrator.
//!
//! Its kinetic energy E_c(q) follows from its coordinate. Of a phase s that grows by 2π in a period,
//!
//! ```text
//! rotation   q = q₀ + P s/2π             dt/ds = (P/2π) √(m / 2E_c)        (1)
//! libration  q = (a + b)/2 − h cos s     dt/ds = √(m / 2g)                 (2)
//!            g = E_c / ((q − a)(b − q)),   h = (b − a)/2
//! t(s) = c₀ s + Σ (c_k sin ks + s_k (1 − cos ks)) / k                     (3)
//! T = ∮ dt/ds ds = 2π c₀                                                  (4)
//! ```
//!
//! with P the angle after which everything repeats itself, a and b the turning points, and c_k, s_k the Fourier
//! coefficients of dt/ds. Both kinds of dt/ds are smooth and periodic, so that the trapezoid rule has all
//! digits of (4) and (3) all of the time history. Where dt/ds is too sharp for equally spaced points, next to a
//! maximum of V or where the inertia is small, it is integrated on panels.

use crate::close_branches::is_too_close;
use crate::conservative::{ConservativeSystem, EnergyTerms, LoadedSystem, UnloadedSystem};
use crate::error::{DynamicsError, Result};
use crate::libration::{libration, nearest_phase, phase_of};
use crate::machine::Machine;
use crate::motion_class::{EnergyScan, MotionClass};
use crate::ode::ReducedState;
use crate::time_density::{ResolvedMotion, TimeDensity};
use dwell_geometry::NearBranch;
use dwell_kinetostatics::ReducedModel;
use dwell_numerics::fourier::{FourierSeries, SHARP_POINTS, refine_samples};
use dwell_numerics::panels::Panels;
use std::f64::consts::TAU;

/// Steps of Newton's method, halvings among them, to a phase.
const MAX_NEWTON_STEPS: usize = 100;

/// A conservative motion that repeats itself, known at every time.
#[derive(Debug, Clone, PartialEq)]
pub struct Orbit {
    initial_state: ReducedState,
    /// Time of one period, s.
    pub period: f64,
    /// Kinetic and potential energy, J.
    pub energy: f64,
    /// The largest kinetic energy at the points of the rule, J.
    pub max_kinetic: f64,
    /// Points of the rule that resolved it.
    pub points: usize,
    /// The last Fourier coefficients as a part of the mean: what rounding leaves in a point.
    pub tail: f64,
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

    /// The same to an accuracy: with the fewest points whose truncation error is below this part of the mean, so that
    /// times err by about this part of a period.
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
    pub fn loaded(machine: &Machine, start: ReducedState) -> Result<Self> {
        Self::of_system(&mut LoadedSystem::new(machine)?, start, 0.0)
    }

    fn of_system(
        system: &mut dyn ConservativeSystem,
        start: ReducedState,
        accuracy: f64,
    ) -> Result<Self> {
        let range = system.range();
        let (scan, class) = EnergyScan::new(&mut *system, start)?;
        let (terms, kinetic) = (scan.initial_terms, scan.kinetic);
        let (resolved, kind, motion_class) = match class {
            MotionClass::Rotation { period, .. } => {
                let angle_per_period = period * start.q_dot.signum();
                let resolved = rotation(
                    system,
                    (start.q, terms, kinetic),
                    angle_per_period,
                    accuracy,
                )?;
                (resolved, OrbitKind::Rotation(angle_per_period), class)
            }
            MotionClass::Libration { turning_points } => {
                let (resolved, turning_points) =
                    libration(system, start.q, kinetic, turning_points)?;
                let class = MotionClass::Libration { turning_points };
                (resolved, OrbitKind::Libration(turning_points), class)
            }
            MotionClass::Asymptotic { to: q } => return Err(DynamicsError::AsymptoticMotion { q }),
            MotionClass::Equilibrium => return Err(DynamicsError::AtRest),
            MotionClass::Undecided { to: q } => return Err(DynamicsError::Undecided { q }),
            MotionClass::ReachesLimit { at } => {
                let (from, to) = range.limits().unwrap_or((at, at));
                return Err(DynamicsError::NoFullRevolution { from, to });
            }
        };
        let time_density = resolved.time_density;
        let (initial_phase, time_offset) = match kind {
            OrbitKind::Rotation(_) => (0.0, 0.0),
            OrbitKind::Libration(turning_points) => {
                let up = nearest_phase(start.q, turning_points);
                let phase = if start.q_dot < 0.0 { TAU - up } else { up };
                (phase, time_density.eval(phase)[1])
            }
        };
        Ok(Self {
            initial_state: start,
            period: TAU * time_density.mean(),
            energy: kinetic + terms.potential,
            max_kinetic: resolved.max_kinetic,
            points: resolved.points,
            tail: time_density.tail(),
            motion_class,
            kind,
            initial_phase,
            time_offset,
            time_density,
        })
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
    /// also a time before the start. None where a libration never reaches `q`.
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

/// A rotation from a coordinate with energy terms and a kinetic energy (J).
fn rotation(
    system: &mut dyn ConservativeSystem,
    (q, terms, kinetic): (f64, EnergyTerms, f64),
    angle_per_period: f64,
    accuracy: f64,
) -> Result<ResolvedMotion> {
    // The same position without its whole revolutions, which would cost digits.
    let first = q % angle_per_period;
    let mut samples: Vec<EnergyTerms> = Vec::new();
    loop {
        samples = refine_samples(samples, |part| {
            system.energy_terms(first + angle_per_period * part)
        })?;
        let kinetic_left = |at: &EnergyTerms| kinetic + (terms.potential - at.potential);
        let density = |at: &EnergyTerms| {
            angle_per_period.abs() / TAU * (at.m / (2.0 * kinetic_left(at))).sqrt()
        };
        let values: Vec<f64> = samples.iter().map(density).collect();
        let max_kinetic = samples.iter().map(kinetic_left).fold(0.0, f64::max);
        let points = samples.len();
        let size = values.iter().sum::<f64>() / points as f64;
        let series = FourierSeries::new(&values, size);
        let (time_density, points) = if series.is_resolved || series.tail < accuracy {
            (TimeDensity::Fourier(series), points)
        } else if points >= SHARP_POINTS {
            let panels = Panels::new::<DynamicsError>(|phase| {
                let at = system.energy_terms(first + angle_per_period * (phase / TAU))?;
                Ok(density(&at))
            })?;
            let taken = points + panels.points;
            (TimeDensity::Piecewise(panels), taken)
        } else {
            continue;
        };
        return Ok(ResolvedMotion {
            time_density,
            max_kinetic,
            points,
        });
    }
}
