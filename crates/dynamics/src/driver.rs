//! Integration in time, by diffsol behind one guarded loop, or by [`eighth`] order.
//!
//! diffsol's own `solve` has no step budget and no finiteness check, and its explicit methods accept
//! a step whose error is no number (`f64::max` discards a NaN). So every step is taken here, and
//! after each one the state, the budget and the equation's own errors are looked at. An evaluation
//! that fails leaves its error in a cell and a NaN in the derivative: the integrator then shrinks
//! its step or gives up, and the error that made it do so is what the caller gets.

use crate::eighth;
use crate::error::DynamicsError;
use crate::options::{Method, Options, Statistics};
use crate::system::{Point, System};
use diffsol::{
    DiffsolError, NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations, OdeSolverMethod,
    OdeSolverStopReason, VectorCommon,
};
use std::cell::{Cell, RefCell};

/// For few states nalgebra is 2.3 times as fast as faer, with the same steps.
type Matrix = NalgebraMat<f64>;
type Solver = NalgebraLU<f64>;

/// Smallest step, s, at a rate of 1 per s or less; at a higher one, in proportion shorter.
const SMALLEST_STEP: f64 = 1e-17;

/// What the one who watches an integration says after a step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Next {
    /// Another step.
    GoOn,
    /// Enough: the last step is the end.
    Stop,
}

/// The state at any time within the last step, by dense output.
pub type Dense<'d> = &'d mut dyn FnMut(f64, &mut [f64]) -> Result<(), DynamicsError>;

/// One step, with its dense output: from one point to the next.
pub type Watch<'w> = &'w mut dyn FnMut(&Point, &Point, Dense<'_>) -> Result<Next, DynamicsError>;

/// How an integration ended, and what it took.
#[derive(Debug, Clone, PartialEq)]
pub struct Ended {
    /// Where the last good step ended.
    pub at: Point,
    /// Why it could not go on, if it could not.
    pub failed: Option<DynamicsError>,
    /// The work done.
    pub statistics: Statistics,
}

/// Integrates a system from a point until a time (or for ever), and lets `watch` see every step.
///
/// # Errors
/// [`DynamicsError`] where not even the start can be evaluated, or an option cannot be used. What
/// fails on the way is in [`Ended::failed`].
pub fn integrate(
    system: &mut dyn System,
    start: &Point,
    end: Option<f64>,
    options: &Options,
    watch: Watch<'_>,
) -> Result<Ended, DynamicsError> {
    options.check()?;
    let n = system.size();
    for &value in std::iter::once(&start.t).chain(&start.y) {
        if !value.is_finite() {
            return Err(DynamicsError::BadOption {
                what: "the initial state",
                must: "finite number",
                value,
            });
        }
    }
    if let Some(end) = end.filter(|end| !(end.is_finite() && *end > start.t)) {
        return Err(DynamicsError::BadOption {
            what: "the end of the motion",
            must: "time after its start",
            value: end,
        });
    }
    // What cannot even start is said at once, not after a futile search for a step size.
    let mut rates = vec![0.0; n];
    system.rates(start.t, &start.y, &mut rates)?;
    // At rest the rates say how soon something happens: a motor's current climbs within microseconds.
    let started = start.y.iter().chain(&rates);
    let fastest = started.fold(1.0_f64, |most, y| most.max(y.abs()));
    let absolute: Vec<f64> = (0..n)
        .map(|i| options.absolute * system.weight(i))
        .collect();
    let shortest = SMALLEST_STEP / fastest;
    if options.method == Method::Dop853 {
        let from = (start, &rates[..]);
        let limits = (&absolute[..], shortest);
        return Ok(eighth::integrate(system, from, end, options, limits, watch));
    }
    let system = RefCell::new(system);
    let failure: RefCell<Option<DynamicsError>> = RefCell::new(None);
    let (evaluations, jacobians) = (Cell::new(0), Cell::new(0));
    // The Jacobian is asked for column by column at one state.
    let last = RefCell::new((vec![f64::NAN; n + 1], vec![0.0; n * n]));
    let solver = |e: DiffsolError| gave_up(&e, start.t);
    let mut problem = OdeBuilder::<Matrix>::new()
        .t0(start.t)
        .rtol(options.relative)
        .atol(absolute)
        .p(Vec::<f64>::new())
        .rhs_implicit(
            |x, _p, t, out| {
                evaluations.set(evaluations.get() + 1);
                if let Err(e) = system.borrow_mut().rates(t, x, out) {
                    // The first error since the last good step is the cause; what a NaN then
                    // leads to is not.
                    failure.borrow_mut().get_or_insert(e);
                    out.fill(f64::NAN);
                }
            },
            |x, _p, t, v, jv| {
                let (at, matrix) = &mut *last.borrow_mut();
                if at[n] != t || at[..n] != *x {
                    jacobians.set(jacobians.get() + 1);
                    at[..n].copy_from_slice(x);
                    at[n] = t;
                    if let Err(e) = system.borrow_mut().jacobian(t, x, matrix) {
                        failure.borrow_mut().get_or_insert(e);
                        matrix.fill(f64::NAN);
                    }
                }
                for (out, row) in jv.iter_mut().zip(matrix.chunks_exact(n)) {
                    // A column that is not asked for must not spoil this one (0 × ∞).
                    let terms = row.iter().zip(v).filter(|(_, v)| **v != 0.0);
                    *out = terms.map(|(a, v)| a * v).sum();
                }
            },
        )
        .init(|_p, _t, x| x.copy_from_slice(&start.y), n)
        .build()
        .map_err(solver)?;
    // The counter runs over the whole integration, and its default of 50 ends long healthy runs.
    problem.ode_options.max_nonlinear_solver_failures = usize::MAX;
    problem.ode_options.min_timestep = shortest;
    let guard = Guard {
        start,
        end,
        options,
        failure: &failure,
    };
    let mut ended = match options.method {
        Method::Bdf => guard.drive(&mut problem.bdf::<Solver>().map_err(solver)?, watch),
        Method::Esdirk34 => guard.drive(&mut problem.esdirk34::<Solver>().map_err(solver)?, watch),
        Method::TrBdf2 => guard.drive(&mut problem.tr_bdf2::<Solver>().map_err(solver)?, watch),
        Method::Tsit45 | Method::Dop853 => {
            guard.drive(&mut problem.tsit45().map_err(solver)?, watch)
        }
    };
    ended.statistics.evaluations = evaluations.get();
    ended.statistics.jacobians = jacobians.get();
    Ok(ended)
}

/// An error of the integrator itself, at the time it had reached.
fn gave_up(error: &DiffsolError, t: f64) -> DynamicsError {
    use diffsol::error::OdeSolverError::{
        StepSizeTooSmall, StopTimeAtCurrentTime, TooManyErrorTestFailures,
    };
    match error {
        DiffsolError::OdeSolverError(StepSizeTooSmall { .. } | TooManyErrorTestFailures { .. }) => {
            DynamicsError::SmallStep { t }
        }
        DiffsolError::OdeSolverError(StopTimeAtCurrentTime) => DynamicsError::TooShort,
        other => DynamicsError::Solver {
            t,
            reason: other.to_string(),
        },
    }
}

struct Guard<'g> {
    start: &'g Point,
    end: Option<f64>,
    options: &'g Options,
    failure: &'g RefCell<Option<DynamicsError>>,
}

impl Guard<'_> {
    fn drive<'a, E, S>(&self, solver: &mut S, watch: Watch<'_>) -> Ended
    where
        E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a,
        S: OdeSolverMethod<'a, E>,
    {
        let mut at = self.start.clone();
        let failed = self.steps(solver, &mut at, watch).err();
        let work = solver.get_statistics();
        let statistics = Statistics {
            steps: work.number_of_steps,
            rejected: work.number_of_error_test_failures,
            factorisations: work.number_of_linear_solver_setups,
            ..Statistics::default()
        };
        Ended {
            at,
            failed,
            statistics,
        }
    }

    fn steps<'a, E, S>(
        &self,
        solver: &mut S,
        at: &mut Point,
        watch: Watch<'_>,
    ) -> Result<(), DynamicsError>
    where
        E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a,
        S: OdeSolverMethod<'a, E>,
    {
        // What the last failed evaluation says, else the integrator's own words.
        let said = |t: f64, e: DiffsolError| {
            let kept = self.failure.borrow_mut().take();
            kept.unwrap_or_else(|| gave_up(&e, t))
        };
        let mut scratch = solver.state().y.clone();
        let mut now = at.clone();
        self.stop_at(solver, at.t).map_err(|e| said(at.t, e))?;
        for _ in 0..self.options.budget {
            let reason = solver.step().map_err(|e| said(at.t, e))?;
            let state = solver.state();
            now.t = state.t;
            now.y.copy_from_slice(state.y.inner().as_slice());
            if !(now.t.is_finite() && state.h.is_finite() && now.y.iter().all(|y| y.is_finite())) {
                let kept = self.failure.borrow_mut().take();
                return Err(kept.unwrap_or(DynamicsError::NotFinite { t: at.t }));
            }
            // A trial point that step control recovered from is no failure.
            self.failure.borrow_mut().take();
            let mut dense = |t: f64, out: &mut [f64]| -> Result<(), DynamicsError> {
                let inside = solver.interpolate_inplace(t, &mut scratch);
                inside.map_err(|e| gave_up(&e, t))?;
                out.copy_from_slice(scratch.inner().as_slice());
                Ok(())
            };
            let next = watch(at, &now, &mut dense)?;
            at.t = now.t;
            at.y.copy_from_slice(&now.y);
            let end = self.end.is_some_and(|end| at.t >= end);
            if next == Next::Stop || end {
                return Ok(());
            }
            if matches!(reason, OdeSolverStopReason::TstopReached) || self.options.longest.is_some()
            {
                self.stop_at(solver, at.t).map_err(|e| said(at.t, e))?;
            }
        }
        Err(DynamicsError::Budget {
            t: at.t,
            steps: self.options.budget,
        })
    }

    /// Sets the time at which the next step must end at the latest.
    fn stop_at<'a, E, S>(&self, solver: &mut S, t: f64) -> Result<(), DiffsolError>
    where
        E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a,
        S: OdeSolverMethod<'a, E>,
    {
        let step = self.options.longest.map(|longest| t + longest);
        match (self.end, step) {
            (Some(end), Some(step)) => solver.set_stop_time(end.min(step)),
            (Some(stop), None) | (None, Some(stop)) => solver.set_stop_time(stop),
            (None, None) => Ok(()),
        }
    }
}
