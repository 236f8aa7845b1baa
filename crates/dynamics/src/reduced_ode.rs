//! The equation of motion of a free mechanism of one degree of freedom without loads,
//!
//! ```text
//! q̈ = f(q, q̇) = −½m′ q̇² / m                                     (1)
//! ∂f/∂q  = −(½m″ − ½m′ m′/m) q̇² / m,   m′ = 2 (½m′)              (2)
//! ∂f/∂q̇ = −m′ q̇ / m                                             (3)
//! R_k    = a_k q̈ + b_k q̇²                                        (4)
//! ```
//!
//! from a reduced model alone, exact or tabulated: one evaluation of m and ½m′ per evaluation of (1).

use crate::conservative::limits;
use crate::error::{DynamicsError, Result, positive_inertia};
use crate::ode::{OdeState, OdeSystem, ReducedState};
use crate::options::Options;
use crate::solve::{Event, EventKind, Observed, ObservedValue, Solution, solve_with_limits};
use dwell_geometry::Range;
use dwell_kinetostatics::{Coefficients, ReducedModel};
use std::num::NonZeroUsize;

/// A motion this near a limit position, rad, has reached it: the inertia grows as the inverse of
/// the distance, and the steps would go on shrinking.
const LIMIT_TOLERANCE: f64 = 1e-9;

/// The equation of motion with the working memory to evaluate it, for one thread.
#[derive(Debug)]
pub struct ReducedOde<'a, R: ReducedModel> {
    model: &'a R,
    workspace: R::Workspace,
    /// Error weight of the speed, rad/s.
    speed_scale: f64,
}

impl<'a, R: ReducedModel> ReducedOde<'a, R> {
    /// The equation of motion of a reduced model.
    pub fn new(model: &'a R) -> Self {
        Self {
            model,
            workspace: model.workspace(),
            speed_scale: 1.0,
        }
    }

    /// This equation with an initial speed (rad/s) as the error weight of speeds: without loads a speed only scales
    /// time.
    #[must_use]
    pub fn with_speed_scale(mut self, q_dot: f64) -> Self {
        if q_dot.abs().is_normal() {
            self.speed_scale = q_dot.abs();
        }
        self
    }

    /// The acceleration q̈ (rad/s²) at `q` (rad) and `q_dot` (rad/s), by (1).
    ///
    /// # Errors
    /// [`DynamicsError::Position`] where there is no pose, [`DynamicsError::NoInertia`] where m is not positive.
    pub fn acceleration(&mut self, q: f64, q_dot: f64) -> Result<f64> {
        let (m, half_dm) = self.model.inertia(q, &mut self.workspace)?;
        Ok(-half_dm * q_dot * q_dot / positive_inertia(m, q)?)
    }

    /// ∂q̈/∂q and ∂q̈/∂q̇, by (2) and (3).
    ///
    /// # Errors
    /// As [`ReducedOde::acceleration`].
    pub fn jacobian(&mut self, q: f64, q_dot: f64) -> Result<[f64; 2]> {
        let at = self.model.inertia_derivatives(q, &mut self.workspace)?;
        let m = positive_inertia(at.m, q)?;
        let by_q = -(at.half_ddm - 2.0 * at.half_dm * at.half_dm / m) * q_dot * q_dot / m;
        Ok([by_q, -2.0 * at.half_dm * q_dot / m])
    }

    /// Kinetic energy ½ m q̇², J.
    ///
    /// # Errors
    /// As [`ReducedOde::acceleration`].
    pub fn kinetic_energy(&mut self, q: f64, q_dot: f64) -> Result<f64> {
        let (m, _) = self.model.inertia(q, &mut self.workspace)?;
        Ok(0.5 * m * q_dot * q_dot)
    }
}

impl<R: ReducedModel> OdeSystem for ReducedOde<'_, R> {
    fn size(&self) -> usize {
        2
    }

    fn rhs(&mut self, _: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        out[1] = self.acceleration(y[0], y[1])?;
        out[0] = y[1];
        Ok(())
    }

    fn jacobian(&mut self, _: f64, y: &[f64], out: &mut [f64]) -> Result<()> {
        let row = ReducedOde::jacobian(self, y[0], y[1])?;
        out.copy_from_slice(&[0.0, 1.0, row[0], row[1]]);
        Ok(())
    }

    fn error_weight(&self, state: usize) -> f64 {
        if state == 0 { 1.0 } else { self.speed_scale }
    }
}

/// The accelerations and reactions of a free motion, for one thread.
#[derive(Debug)]
pub struct ReducedOutputs<'a, R: ReducedModel> {
    model: &'a R,
    workspace: R::Workspace,
    /// The coefficients at the state evaluated last.
    pub coefficients: Coefficients,
    /// The acceleration q̈ there, rad/s².
    pub q_ddot: f64,
    /// The reactions there, N or N·m.
    pub reactions: Vec<f64>,
}

impl<'a, R: ReducedModel> ReducedOutputs<'a, R> {
    /// The outputs of a reduced model, not yet evaluated.
    pub fn new(model: &'a R) -> Self {
        let zeros = vec![0.0; model.reactions()];
        Self {
            model,
            workspace: model.workspace(),
            coefficients: Coefficients {
                a: zeros.clone(),
                b: zeros.clone(),
                ..Coefficients::default()
            },
            q_ddot: 0.0,
            reactions: zeros,
        }
    }

    /// Evaluates q̈ by (1) and the reactions by (4) at `q` (rad) and `q_dot` (rad/s).
    ///
    /// # Errors
    /// [`DynamicsError::Position`] where there is no pose.
    pub fn evaluate(&mut self, q: f64, q_dot: f64) -> Result<()> {
        let at = &mut self.coefficients;
        self.model.coefficients(q, &mut self.workspace, at)?;
        let square = q_dot * q_dot;
        self.q_ddot = -at.half_dm * square / at.m;
        for ((out, a), b) in self.reactions.iter_mut().zip(&at.a).zip(&at.b) {
            *out = a * self.q_ddot + b * square;
        }
        Ok(())
    }
}

/// The one coordinate q of a reduced model, in events.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReducedCoordinate;

impl<R: ReducedModel> Observed for ReducedOutputs<'_, R> {
    type Coordinate = ReducedCoordinate;

    fn coordinate(&mut self, _: ReducedCoordinate, at: &OdeState) -> Result<ObservedValue> {
        Ok(ObservedValue {
            value: at.y[0],
            rate: at.y[1],
            revolutions_counted: Some(true),
        })
    }

    fn reaction(&mut self, index: usize, at: &OdeState) -> Result<f64> {
        self.evaluate(at.y[0], at.y[1])?;
        Ok(self.reactions[index])
    }

    fn angle_between(&self, from: &OdeState, to: &OdeState) -> f64 {
        match self.model.range() {
            Range::Stroke(..) => 0.0,
            _ => (to.y[0] - from.y[0]).abs(),
        }
    }
}

/// Integrates the free motion of a reduced model from `start` until `end` (s), or without an end until a
/// terminal event. The states are [q, q̇].
///
/// Without loads the speed keeps its sign. In the coordinate of an actuator the passage through a limit
/// position looks like a smooth return, but the mechanism continues on another assembly branch: there the
/// solution ends with [`DynamicsError::LimitPosition`].
///
/// # Errors
/// [`DynamicsError::AtRest`] for a motion without speed and end; else as [`solve`](crate::solve()).
pub fn solve_reduced<R: ReducedModel>(
    model: &R,
    start: ReducedState,
    end: Option<f64>,
    options: &Options,
    events: &[Event<ReducedCoordinate>],
) -> Result<Solution> {
    let limits = limits(model.range(), start.q)?;
    if end.is_none() && start.q_dot == 0.0 {
        return Err(DynamicsError::AtRest);
    }
    let requested = events.len();
    let mut at_limits = Vec::new();
    if let Some((from, to)) = limits {
        let at_limit = [
            EventKind::Reaches(ReducedCoordinate, from + LIMIT_TOLERANCE),
            EventKind::Reaches(ReducedCoordinate, to - LIMIT_TOLERANCE),
            EventKind::Reversal(ReducedCoordinate),
        ];
        at_limits.extend(at_limit.map(|kind| Event {
            kind,
            terminal: Some(NonZeroUsize::MIN),
        }));
    }
    let mut ode = ReducedOde::new(model).with_speed_scale(start.q_dot);
    let outputs = ReducedOutputs::new(model);
    let (from, events) = (start.into(), [events, &at_limits[..]]);
    let mut solution = solve_with_limits(&mut ode, outputs, &from, end, options, events)?;
    let is_at_limit = |event: usize| event >= requested;
    let last = solution.event_occurrences.last();
    // Within its range the mechanism has a pose everywhere: a missing one means the limit.
    let no_pose = matches!(solution.error, Some(DynamicsError::Position(_)));
    if last.is_some_and(|o| is_at_limit(o.event)) || (no_pose && limits.is_some()) {
        solution.event_occurrences.retain(|o| !is_at_limit(o.event));
        solution.terminated_by_event = false;
        let at = solution.steps.last().map_or(start, ReducedState::from);
        let (t, q) = (at.t, at.q);
        solution.error = Some(DynamicsError::LimitPosition { t, q });
    }
    Ok(solution)
}
