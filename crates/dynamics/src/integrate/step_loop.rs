//! The steps of diffsol's methods, each checked.

use super::impasse::Impasse;
use crate::error::{DynamicsError, Result};
use crate::integration_parts::Part;
use crate::ode::{OdeState, StepControl, StepObserver, Termination};
use crate::options::Statistics;
use crate::time_pieces::TimePieces;
use diffsol::error::OdeSolverError;
use diffsol::{
    DiffsolError, NalgebraVec, OdeEquations, OdeSolverMethod, OdeSolverStopReason, VectorCommon,
};
use std::cell::RefCell;

/// diffsol takes two times for one that differ by less than this part of time and step.
const INTEGRATOR_ROUNDING: f64 = 100.0 * f64::EPSILON;

/// An error of the integrator itself, at the time it had reached.
pub(super) fn solver_error(error: &DiffsolError, t: f64) -> DynamicsError {
    use OdeSolverError::{StepSizeTooSmall, StopTimeAtCurrentTime, TooManyErrorTestFailures};
    match error {
        DiffsolError::OdeSolverError(StepSizeTooSmall { .. } | TooManyErrorTestFailures { .. }) => {
            DynamicsError::StepTooSmall { t }
        }
        DiffsolError::OdeSolverError(StopTimeAtCurrentTime) => DynamicsError::DurationTooShort,
        other => DynamicsError::Solver {
            t,
            reason: other.to_string(),
        },
    }
}

/// The data that all steps of an integration share.
pub(super) struct StepLoop<'g, 'f> {
    pub(super) part: &'g Part,
    /// The error of the last evaluation that failed.
    pub(super) failure: &'g RefCell<Option<DynamicsError>>,
    pub(super) pieces: Option<&'g mut TimePieces<'f>>,
    pub(super) impasse: &'g mut Impasse,
    /// As [`OdeSystem::balance`](crate::OdeSystem::balance).
    pub(super) balance: &'g dyn Fn(&OdeState) -> Option<[f64; 2]>,
    /// Why a state cannot be evaluated, if it cannot.
    pub(super) fault: &'g dyn Fn(&OdeState) -> Option<DynamicsError>,
}

impl StepLoop<'_, '_> {
    /// Takes all steps.
    pub(super) fn run<'a, E, S>(
        &mut self,
        solver: &mut S,
        observer: StepObserver<'_>,
    ) -> Termination
    where
        E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a,
        S: OdeSolverMethod<'a, E>,
    {
        let mut state = self.part.start.clone();
        let error = self.take_steps(solver, &mut state, observer).err();
        let solver_statistics = solver.get_statistics();
        let statistics = Statistics {
            steps: solver_statistics.number_of_steps,
            rejected_steps: solver_statistics.number_of_error_test_failures,
            factorisations: solver_statistics.number_of_linear_solver_setups,
            ..Statistics::default()
        };
        Termination {
            state,
            error,
            statistics,
        }
    }

    // Long because every step is checked for all that can go wrong in it.
    fn take_steps<'a, E, S>(
        &mut self,
        solver: &mut S,
        at: &mut OdeState,
        observer: StepObserver<'_>,
    ) -> Result<()>
    where
        E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a,
        S: OdeSolverMethod<'a, E>,
    {
        // The error of the last failed evaluation, else the integrator's own.
        let failure = self.failure;
        let cause = |t: f64, e: DiffsolError| {
            let kept = failure.borrow_mut().take();
            kept.unwrap_or_else(|| solver_error(&e, t))
        };
        let mut scratch = solver.state().y.clone();
        let mut now = at.clone();
        if self.set_stop_time(solver, at.t, &cause)? {
            return Err(DynamicsError::DurationTooShort);
        }
        for _ in 0..self.part.options.max_steps {
            let reason = solver.step().map_err(|e| cause(at.t, e))?;
            let state = solver.state();
            now.t = state.t;
            now.y.copy_from_slice(state.y.inner().as_slice());
            if !(now.t.is_finite() && state.h.is_finite() && now.y.iter().all(|y| y.is_finite())) {
                let kept = self.failure.borrow_mut().take();
                self.impasse.step_failed(kept.is_some(), now.t - at.t);
                return Err(kept.unwrap_or(DynamicsError::NotFinite { t: at.t }));
            }
            // A trial point that step control recovered from is no failure, unless no step leads on any more. An explicit method does not
            // notice a state that cannot be evaluated, and Newton's method may end beside one that can.
            let failed = self.failure.borrow_mut().take();
            if let Some(error) = failed {
                if let Some(fault) = (self.fault)(&now) {
                    self.impasse.step_failed(true, now.t - at.t);
                    return Err(fault);
                }
                self.impasse.step_shortened([at, &now]);
                let ends = [&*at, &now];
                let is_false = self.impasse.breaks_balance(ends, self.balance);
                if is_false || self.impasse.is_reached() {
                    return Err(error);
                }
            } else {
                self.impasse.step_taken([at, &now]);
            }
            self.impasse.pace.step_taken(now.t)?;
            let balance = self.balance;
            self.impasse.pace.look_at_balance(now.t, || balance(&now))?;
            // It cannot step to an end that is within its rounding of time: it is there.
            let rounding = INTEGRATOR_ROUNDING * (now.t.abs() + state.h.abs());
            let reached = state.t;
            if let Some(end) = self.part.end.filter(|end| (end - now.t).abs() < rounding) {
                now.t = end;
            }
            let mut dense = |t: f64, out: &mut [f64]| -> Result<()> {
                let inside = solver.interpolate_inplace(t.min(reached), &mut scratch);
                inside.map_err(|e| solver_error(&e, t))?;
                out.copy_from_slice(scratch.inner().as_slice());
                Ok(())
            };
            let control = observer(at, &now, &mut dense)?;
            at.t = now.t;
            at.y.copy_from_slice(&now.y);
            let is_at_stop = matches!(reason, OdeSolverStopReason::TstopReached);
            // It stops within a rounding of where it is to stop.
            let rounding = f64::from(u8::from(is_at_stop)) * 8.0 * f64::EPSILON * at.t.abs();
            let is_end = self.part.end.is_some_and(|end| at.t >= end - rounding);
            if control == StepControl::Stop || is_end {
                return Ok(());
            }
            let is_limited = self.part.options.max_step.is_some() || self.pieces.is_some();
            if (is_at_stop || is_limited) && self.set_stop_time(solver, at.t, &cause)? {
                return Ok(());
            }
        }
        Err(DynamicsError::MaxStepsReached {
            t: at.t,
            max_steps: self.part.options.max_steps,
        })
    }

    /// The time at which a step that begins at `t` must end at the latest, if there is one.
    fn stop_time(&mut self, t: f64) -> Result<Option<f64>> {
        let step = self
            .part
            .options
            .max_step
            .map_or(f64::INFINITY, |step| t + step);
        let feature = match &mut self.pieces {
            Some(pieces) => pieces.latest_end(t)?,
            None => f64::INFINITY,
        };
        let stop = self
            .part
            .end
            .unwrap_or(f64::INFINITY)
            .min(step)
            .min(feature);
        Ok(stop.is_finite().then_some(stop))
    }

    /// Sets the time at which a step that begins at `t` must end at the latest; whether the end itself is there already
    /// in the integrator's rounding.
    fn set_stop_time<'a, E, S>(
        &mut self,
        solver: &mut S,
        t: f64,
        cause: &dyn Fn(f64, DiffsolError) -> DynamicsError,
    ) -> Result<bool>
    where
        E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a,
        S: OdeSolverMethod<'a, E>,
    {
        let Some(mut stop) = self.stop_time(t)? else {
            return Ok(false);
        };
        let end = self.part.end.unwrap_or(f64::INFINITY);
        loop {
            match solver.set_stop_time(stop) {
                Ok(()) => return Ok(false),
                Err(DiffsolError::OdeSolverError(OdeSolverError::StopTimeAtCurrentTime)) => {
                    if stop >= end {
                        return Ok(true);
                    }
                    // What is narrower than its rounding of time ends a step behind it.
                    let rounding = INTEGRATOR_ROUNDING * (t.abs() + solver.state().h.abs());
                    stop = (stop + rounding).min(end);
                }
                Err(error) => return Err(cause(t, error)),
            }
        }
    }
}
