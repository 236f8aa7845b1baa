//! Integration in time, by diffsol behind one guarded loop.
//!
//! diffsol's own `solve` has no step budget and no finiteness check, and its explicit methods accept
//! a step whose error is no number (`f64::max` discards a NaN). So every step is taken here, and
//! after each one the state, the budget and the equation's own errors are looked at. An evaluation
//! that fails leaves its error in a cell and a NaN in the derivative: the integrator then shrinks
//! its step or gives up, and the error that made it do so is what the caller gets.

use crate::equation::Equation;
use crate::error::DynamicsError;
use crate::root;
use diffsol::{
    DiffsolError, NalgebraLU, NalgebraMat, NalgebraVec, OdeBuilder, OdeEquations, OdeSolverMethod,
    OdeSolverStopReason, Vector,
};
use dwell_geometry::{PlaceError, Range};
use dwell_kinetostatics::Reduced;
use std::cell::{Cell, RefCell};
use std::f64::consts::TAU;

/// For two states nalgebra is 2.3 times as fast as faer, with the same steps.
type Matrix = NalgebraMat<f64>;
type Solver = NalgebraLU<f64>;

/// Smallest step, s, at a speed of 1 rad/s or less; at a higher one, in proportion shorter.
const SMALLEST_STEP: f64 = 1e-14;

/// A motion this near a limit position, rad, has reached it: the inertia grows as the inverse of
/// the distance, and the steps would go on shrinking.
const AT_LIMIT: f64 = 1e-9;

/// How to integrate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Implicit, variable order 1 to 5 (backward differentiation).
    Bdf,
    /// Explicit Runge–Kutta of order 5 (Tsitouras 2011).
    Tsit45,
}

impl Method {
    /// The name used in commands and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bdf => "BDF",
            Self::Tsit45 => "Tsit45",
        }
    }
}

/// When to stop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Until {
    /// At a time, s.
    Time(f64),
    /// After so many whole turns of the coordinate.
    Turns(usize),
}

/// Accuracy and effort of an integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The method.
    pub method: Method,
    /// Relative tolerance on coordinate and speed.
    pub relative: f64,
    /// Absolute tolerance, rad and rad/s.
    pub absolute: f64,
    /// Most steps to be taken.
    pub budget: usize,
    /// Distance of equally spaced samples by dense output, s; none for no samples.
    pub every: Option<f64>,
}

impl Options {
    /// A method with the same relative and absolute tolerance.
    pub fn new(method: Method, tolerance: f64) -> Self {
        Self {
            method,
            relative: tolerance,
            absolute: tolerance,
            budget: 2_000_000,
            every: None,
        }
    }
}

/// Time, coordinate and speed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct State {
    /// Time, s.
    pub t: f64,
    /// Coordinate, rad.
    pub q: f64,
    /// Speed, rad/s.
    pub q_dot: f64,
}

/// The work an integration took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Statistics {
    /// Steps taken.
    pub steps: usize,
    /// Steps rejected for their error.
    pub rejected: usize,
    /// Evaluations of the equation of motion.
    pub evaluations: usize,
    /// Evaluations of its Jacobian.
    pub jacobians: usize,
    /// Factorisations.
    pub factorisations: usize,
}

/// A motion.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Run {
    /// The start and the end of each step.
    pub steps: Vec<State>,
    /// Equally spaced samples, if asked for.
    pub samples: Vec<State>,
    /// The state at each whole turn, located on the dense output.
    pub turns: Vec<State>,
    /// The work done.
    pub statistics: Statistics,
}

/// Integrates a free motion from `start`, until a time or a number of whole turns.
///
/// # Errors
/// [`DynamicsError`] with the place and the reason: no pose, no inertia, a limit position, a budget
/// used up, a state that is not finite, an option that cannot be used.
pub fn simulate<R: Reduced>(
    model: &R,
    start: State,
    until: Until,
    options: &Options,
) -> Result<Run, DynamicsError> {
    check(start, until, options)?;
    let limits = limits(model.range(), start.q)?;
    let equation = RefCell::new(Equation::new(model));
    // What cannot even start is said at once, not after a futile search for a step size.
    equation.borrow_mut().jacobian(start.q, start.q_dot)?;
    if matches!(until, Until::Turns(n) if n > 0) && start.q_dot == 0.0 {
        return Err(DynamicsError::AtRest);
    }
    let failure: RefCell<Option<DynamicsError>> = RefCell::new(None);
    let (evaluations, jacobians) = (Cell::new(0), Cell::new(0));
    // The Jacobian is asked for column by column at one state.
    let last = Cell::new(([f64::NAN; 2], [0.0; 2]));
    let solver = |e: DiffsolError| gave_up(&e, start.t);
    let mut problem = OdeBuilder::<Matrix>::new()
        .t0(start.t)
        .rtol(options.relative)
        .atol([options.absolute; 2])
        .p(Vec::<f64>::new())
        .rhs_implicit(
            |x, _p, _t, dx| {
                evaluations.set(evaluations.get() + 1);
                dx[0] = x[1];
                dx[1] = keep(
                    equation.borrow_mut().acceleration(x[0], x[1]),
                    &failure,
                    f64::NAN,
                );
            },
            |x, _p, _t, v, jv| {
                let (at, mut row) = last.get();
                if at != [x[0], x[1]] {
                    jacobians.set(jacobians.get() + 1);
                    let jacobian = equation.borrow_mut().jacobian(x[0], x[1]);
                    row = keep(jacobian, &failure, [f64::NAN; 2]);
                    last.set(([x[0], x[1]], row));
                }
                jv[0] = v[1];
                jv[1] = row[0] * v[0] + row[1] * v[1];
            },
        )
        .init(
            |_p, _t, x| {
                x[0] = start.q;
                x[1] = start.q_dot;
            },
            2,
        )
        .build()
        .map_err(solver)?;
    // The counter runs over the whole integration, and its default of 50 ends long healthy runs.
    problem.ode_options.max_nonlinear_solver_failures = usize::MAX;
    problem.ode_options.min_timestep = SMALLEST_STEP / start.q_dot.abs().max(1.0);
    let mut run = match options.method {
        Method::Bdf => {
            let mut bdf = problem.bdf::<Solver>().map_err(solver)?;
            drive(&mut bdf, start, until, options, limits, &failure)
        }
        Method::Tsit45 => {
            let mut tsit45 = problem.tsit45().map_err(solver)?;
            drive(&mut tsit45, start, until, options, limits, &failure)
        }
    }?;
    run.statistics.evaluations = evaluations.get();
    run.statistics.jacobians = jacobians.get();
    Ok(run)
}

/// Options that the integrator would answer with an endless loop are refused here.
fn check(start: State, until: Until, options: &Options) -> Result<(), DynamicsError> {
    let usable = |value: f64| value.is_finite() && value > 0.0;
    let refuse = |what, must, value| Err(DynamicsError::BadOption { what, must, value });
    for value in [start.t, start.q, start.q_dot] {
        if !value.is_finite() {
            return refuse("the initial state", "finite number", value);
        }
    }
    if !(options.relative.is_finite() && options.relative >= 0.0) {
        return refuse("the relative tolerance", "number from 0", options.relative);
    }
    if !usable(options.absolute) {
        return refuse(
            "the absolute tolerance",
            "positive number",
            options.absolute,
        );
    }
    match (until, options.every) {
        (Until::Time(t), _) if !(t.is_finite() && t > start.t) => {
            refuse("the end of the motion", "time after its start", t)
        }
        (_, Some(every)) if !usable(every) => {
            refuse("the distance of samples", "positive time", every)
        }
        _ => Ok(()),
    }
}

/// The ends of the range, in the turn in which the motion starts; none if the coordinate turns
/// fully.
fn limits(range: Range, q: f64) -> Result<Option<(f64, f64)>, DynamicsError> {
    let Some((from, to)) = range.limits() else {
        return Ok(None);
    };
    let turns = TAU * ((q - from) / TAU).floor();
    if q > to + turns {
        return Err(PlaceError::OutOfRange { q, from, to }.into());
    }
    Ok(Some((from + turns, to + turns)))
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

/// Keeps the error of an evaluation for the driver; the integrator gets `instead`.
fn keep<T>(
    result: Result<T, DynamicsError>,
    failure: &RefCell<Option<DynamicsError>>,
    instead: T,
) -> T {
    result.unwrap_or_else(|e| {
        // The first error since the last good step is the cause; what a NaN then leads to is not.
        failure.borrow_mut().get_or_insert(e);
        instead
    })
}

fn drive<'a, E, S>(
    solver: &mut S,
    start: State,
    until: Until,
    options: &Options,
    limits: Option<(f64, f64)>,
    failure: &RefCell<Option<DynamicsError>>,
) -> Result<Run, DynamicsError>
where
    E: OdeEquations<T = f64, V = NalgebraVec<f64>> + 'a,
    S: OdeSolverMethod<'a, E>,
{
    let mut run = Run {
        steps: vec![start],
        samples: options.every.map(|_| start).into_iter().collect(),
        ..Run::default()
    };
    // What the last failed evaluation says of a motion that got as far as a state.
    let cause = |State { t, q, .. }: State| match failure.borrow_mut().take()? {
        // Within its range the mechanism has a pose everywhere: it is the end that was met.
        DynamicsError::Place(_) if limits.is_some() => Some(DynamicsError::Limit { t, q }),
        kept => Some(kept),
    };
    let said = |at: State, e: DiffsolError| cause(at).unwrap_or_else(|| gave_up(&e, at.t));
    if let Until::Time(end) = until {
        let stop = solver.set_stop_time(end);
        stop.map_err(|e| said(start, e))?;
    }
    let mut scratch = solver.state().y.clone();
    let mut before = start;
    for _ in 0..options.budget {
        let reason = solver.step().map_err(|e| said(before, e))?;
        let state = solver.state();
        let now = State {
            t: state.t,
            q: state.y.get_index(0),
            q_dot: state.y.get_index(1),
        };
        if !(now.t.is_finite() && now.q.is_finite() && now.q_dot.is_finite() && state.h.is_finite())
        {
            let t = before.t;
            return Err(cause(before).unwrap_or(DynamicsError::NotFinite { t }));
        }
        // Without loads the speed keeps its sign. In the coordinate of an actuator the way through a
        // limit position looks like a smooth return, but the mechanism goes on on another branch.
        let ends =
            limits.is_some_and(|(from, to)| now.q < from + AT_LIMIT || now.q > to - AT_LIMIT);
        if now.q_dot * start.q_dot < 0.0 || ends {
            let State { t, q, .. } = before;
            return Err(DynamicsError::Limit { t, q });
        }
        // A trial point that step control recovered from is no failure.
        failure.borrow_mut().take();
        run.steps.push(now);
        let mut at = |t: f64| -> Result<State, DynamicsError> {
            let inside = solver.interpolate_inplace(t, &mut scratch);
            inside.map_err(|e| said(State { t, ..now }, e))?;
            let [q, q_dot] = [0, 1].map(|i| scratch.get_index(i));
            Ok(State { t, q, q_dot })
        };
        turns(&mut run.turns, start, before, now, &mut at)?;
        let enough = matches!(until, Until::Turns(n) if run.turns.len() >= n);
        let end = match run.turns.last() {
            Some(last) if enough => last.t,
            _ => now.t,
        };
        if let Some(every) = options.every {
            samples(&mut run.samples, every, start.t, end, &mut at)?;
        }
        before = now;
        if enough || matches!(reason, OdeSolverStopReason::TstopReached) {
            let work = solver.get_statistics();
            run.statistics.steps = work.number_of_steps;
            run.statistics.rejected = work.number_of_error_test_failures;
            run.statistics.factorisations = work.number_of_linear_solver_setups;
            return Ok(run);
        }
    }
    Err(DynamicsError::Budget {
        t: before.t,
        steps: options.budget,
    })
}

/// Locates the whole turns passed in a step, in the direction of the start's speed. They are
/// found here rather than by the integrator's own events, which stop it and miss a second one in the step.
fn turns(
    found: &mut Vec<State>,
    start: State,
    before: State,
    now: State,
    at: &mut impl FnMut(f64) -> Result<State, DynamicsError>,
) -> Result<(), DynamicsError> {
    let forward = if start.q_dot < 0.0 { -1.0 } else { 1.0 };
    loop {
        let target = start.q + forward * TAU * (found.len() + 1) as f64;
        if (now.q - target) * forward < 0.0 || (before.q - target) * forward >= 0.0 {
            return Ok(());
        }
        let short = |t| Ok::<_, DynamicsError>(at(t)?.q - target);
        let passed = root::zero(short, before.t, now.t)?;
        found.push(passed.map_or(Ok(now), &mut *at)?);
    }
}

/// Takes the equally spaced samples of a step.
fn samples(
    taken: &mut Vec<State>,
    every: f64,
    from: f64,
    until: f64,
    at: &mut impl FnMut(f64) -> Result<State, DynamicsError>,
) -> Result<(), DynamicsError> {
    loop {
        let t = from + every * taken.len() as f64;
        if t > until {
            return Ok(());
        }
        taken.push(at(t)?);
    }
}
