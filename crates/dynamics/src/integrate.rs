//! Integration in time, by diffsol behind one guarded loop, or by DOP853.
//!
//! diffsol's own `solve` has no limit of steps and does not check for finite states, and its explicit methods accept a
//! step whose error is NaN (`f64::max` discards it). Therefore every step is taken here, and after each one the state,
//! the number of steps and the errors of evaluations are checked. A failed evaluation stores its error in a cell and
//! NaN in the derivative: the integrator then shortens its step or fails, and the caller gets the error of that
//! evaluation.

mod impasse;
mod step_loop;

use crate::contact_events::ContactMonitor;
use crate::dop853;
use crate::error::{DynamicsError, Result};
use crate::integration_parts::{Part, Parts, check_interval};
use crate::ode::{DenseOutput, OdeState, OdeSystem, Step, StepControl, StepObserver, Termination};
use crate::options::{Method, Options};
use crate::pace::Pace;
use crate::sliding_system::{SharedSystem, SlidingSystem};
use crate::switch_monitor::{Crossing, SwitchMonitor};
use crate::time_pieces::TimePieces;
use diffsol::{DiffsolError, NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverState, Tableau};
use impasse::Impasse;
use std::cell::{Cell, RefCell};
use step_loop::{StepLoop, solver_error};

/// For few states nalgebra is 2.3 times as fast as faer, with the same steps.
type Matrix = NalgebraMat<f64>;
type Solver = NalgebraLU<f64>;

/// Smallest step, s, at a rate of 1 per s or less; at a higher one, in proportion shorter.
const MIN_STEP: f64 = 1e-17;
/// After a failed step, a method restarts with this fraction of its length.
const FAILURE_REDUCTION: f64 = 0.1;
/// An event this near to the end, relative to the time of the end, counts as at the end.
const END_ROUNDING: f64 = 256.0 * f64::EPSILON;

/// Integrates a system from `start` until `end` (s), or without an end until the observer stops it. The
/// observer is called after every step. Where a function of time or of the state switches, one integration ends and
/// another begins.
///
/// # Errors
/// [`DynamicsError`] where not even the start can be evaluated, or an option cannot be used. An error that
/// ends the integration later is in [`Termination::error`].
pub fn integrate(
    system: &mut dyn OdeSystem,
    start: &OdeState,
    end: Option<f64>,
    options: &Options,
    observer: StepObserver<'_>,
) -> Result<Termination> {
    options.check()?;
    let whole = Part {
        start: start.clone(),
        end,
        options: *options,
        first_step: None,
    };
    check_interval(&whole)?;
    match system.time_features().filter(|f| !f.is_empty()) {
        None => integrate_held(system, whole, None, observer),
        Some(features) => {
            let mut pieces = TimePieces::new(&features, start.t, end, options)?;
            integrate_segments(system, whole, &mut pieces, observer)
        }
    }
}

/// Integrates from switch to switch.
fn integrate_segments(
    system: &mut dyn OdeSystem,
    whole: Part,
    pieces: &mut TimePieces<'_>,
    observer: StepObserver<'_>,
) -> Result<Termination> {
    let (stopped, end) = (Cell::new(false), whole.end);
    let mut watched = |before: &OdeState, now: &OdeState, dense: DenseOutput<'_>| {
        let control = observer(before, now, dense)?;
        stopped.set(stopped.get() || control == StepControl::Stop);
        Ok(control)
    };
    let mut parts = Parts::new(whole);
    while let Some(segment) = pieces.next_segment()? {
        let next = &mut parts.next;
        next.start.t = next.start.t.max(segment.from);
        // The end itself, however a switch there is rounded.
        next.end = segment.restart.then_some(segment.to).or(end);
        if next.end.is_some_and(|to| to <= next.start.t) {
            continue;
        }
        let part = integrate_held(system, next.clone(), Some(pieces), &mut watched);
        if parts.add(part)? || stopped.get() {
            break;
        }
    }
    parts.whole.ok_or(DynamicsError::DurationTooShort)
}

/// Integrates while nothing switches in time, from one switch of the state to the next: between switches, the pieces
/// are held.
// Long because it is one loop: what ends an integration decides how the next one begins.
fn integrate_held(
    system: &mut dyn OdeSystem,
    mut whole: Part,
    mut pieces: Option<&mut TimePieces<'_>>,
    observer: StepObserver<'_>,
) -> Result<Termination> {
    let (end, span) = (whole.end, whole.span());
    let mut contacts = ContactMonitor::new(system, span);
    if system.switch_kinds().is_empty() && contacts.is_none() && !system.may_hide() {
        return integrate_smooth(system, whole, pieces, observer);
    }
    if let Some(contacts) = &mut contacts {
        contacts.settle(system, &mut whole.start)?;
    }
    let mut monitor = SwitchMonitor::new(system, &whole.start, span)?;
    let (longest, mut pace) = (whole.options.max_step, Pace::of_switches(&whole));
    system.record_mode(&whole.start, &monitor.pieces(), monitor.sliding());
    let shared = SharedSystem::new(system);
    let mut parts = Parts::new(whole);
    // The last step that an event has not cut short.
    let step = Cell::new(None);
    loop {
        let mut event: Option<HeldEvent> = None;
        let sliding = monitor.sliding();
        let [mut integrated, mut watched_system] =
            [(); 2].map(|()| SlidingSystem::new(&shared, sliding.cloned()));
        parts.next.first_step = step.get();
        let fine = monitor.max_step().into_iter().chain(longest);
        parts.next.options.max_step = fine.reduce(f64::min);
        let mut watched = |before: &OdeState, now: &OdeState, dense: DenseOutput<'_>| {
            let mut taken = Step { before, now, dense };
            step.set(Some(taken.duration()));
            let crossing = monitor.after_step(&mut watched_system, &mut taken)?;
            let mut smooth = taken.until(crossing.as_ref().map_or(now, |c| &c.state));
            let change = match &mut contacts {
                Some(contacts) => contacts.first_event(&mut watched_system, &mut smooth)?,
                None => None,
            };
            let mut found = match (change, crossing) {
                (Some((state, touched)), _) => HeldEvent::Contacts(state, touched),
                (None, Some(crossing)) => HeldEvent::Switch(crossing),
                (None, None) => return observer(before, now, taken.dense),
            };
            // No method begins anew so near to the end: the event is there.
            let is_last = |end: &f64| found.state().t >= *end - END_ROUNDING * end.abs();
            if let Some(end) = end.filter(is_last) {
                found.state_mut().t = end;
            }
            let is_longer = found.state().t > before.t;
            let control = if is_longer {
                observer(before, found.state(), taken.dense)?
            } else {
                StepControl::Continue
            };
            event = (control == StepControl::Continue).then_some(found);
            Ok(StepControl::Stop)
        };
        let (from, next) = (parts.next.start.t, parts.next.clone());
        let pieces = pieces.as_deref_mut();
        let part = integrate_smooth(&mut integrated, next, pieces, &mut watched);
        let is_ended = parts.add(part)?;
        let Some(event) = event.filter(|_| !is_ended) else {
            break;
        };
        let switched = match &event {
            HeldEvent::Switch(crossing) => {
                Some(crossing.source(&SlidingSystem::new(&shared, None)))
            }
            HeldEvent::Contacts(..) => None,
        };
        let is_switch = switched.is_some();
        if is_switch || event.state().t <= from {
            // Behind a switch of a load the rates may be those of another time scale; and with the step that has led beyond
            // an event at its very start it would be met again.
            step.set(None);
        }
        let counted = switched.map_or(Ok(()), |load| pace.switched(load, event.state().t));
        let passed = pass_event(&shared, &mut monitor, contacts.as_mut(), event);
        match (counted.and(passed), &mut parts.whole) {
            (Ok(state), _) => {
                let mut passed = SlidingSystem::new(&shared, None);
                passed.record_mode(&state, &monitor.pieces(), monitor.sliding());
                parts.next.start = state;
            }
            (Err(error), Some(whole)) => {
                whole.error = Some(error);
                break;
            }
            (Err(error), None) => return Err(error),
        }
        if end.is_some_and(|end| parts.next.start.t >= end) {
            break;
        }
    }
    if let Some(whole) = &mut parts.whole {
        // With the modes and speeds behind the last event.
        whole.state.clone_from(&parts.next.start);
        whole.statistics.event_evaluations += shared.event_evaluations();
    }
    parts.whole.ok_or(DynamicsError::DurationTooShort)
}

/// The event that ends an integration on held pieces.
enum HeldEvent {
    /// Switches of loads are passed.
    Switch(Crossing),
    /// Contacts change their modes; by contact, whether it changes.
    Contacts(OdeState, Vec<bool>),
}

impl HeldEvent {
    fn state(&self) -> &OdeState {
        match self {
            Self::Switch(crossing) => &crossing.state,
            Self::Contacts(state, _) => state,
        }
    }

    fn state_mut(&mut self) -> &mut OdeState {
        match self {
            Self::Switch(crossing) => &mut crossing.state,
            Self::Contacts(state, _) => state,
        }
    }
}

/// Changes to the pieces and modes after an event; returns the state there.
fn pass_event(
    shared: &SharedSystem<'_>,
    monitor: &mut SwitchMonitor,
    contacts: Option<&mut ContactMonitor>,
    event: HeldEvent,
) -> Result<OdeState> {
    let system = &mut SlidingSystem::new(shared, None);
    match (event, contacts) {
        (HeldEvent::Contacts(mut state, touched), Some(contacts)) => {
            monitor.refuse_to_slide(system, state.t)?;
            let before = state.clone();
            contacts.change_modes(system, &mut state, &touched)?;
            monitor.continue_after(system, &before, &state)?;
            Ok(state)
        }
        (HeldEvent::Switch(mut crossing), contacts) => {
            monitor.pass(&mut crossing, system)?;
            let mut state = crossing.state;
            if let Some(contacts) = contacts {
                let sliding = monitor.sliding().cloned();
                contacts.settle(&mut SlidingSystem::new(shared, sliding), &mut state)?;
            }
            Ok(state)
        }
        (HeldEvent::Contacts(state, _), None) => Ok(state),
    }
}

/// Integrates while nothing switches in time; `pieces` limits the steps.
fn integrate_smooth(
    system: &mut dyn OdeSystem,
    whole: Part,
    mut pieces: Option<&mut TimePieces<'_>>,
    observer: StepObserver<'_>,
) -> Result<Termination> {
    let options = &whole.options;
    let weights = (0..system.size()).map(|i| options.atol * system.error_weight(i));
    let mut impasse = Impasse::new(&whole, weights.collect(), system.own_function());
    let mut parts = Parts::new(whole);
    loop {
        let pieces = pieces.as_deref_mut();
        let part = integrate_part(system, &parts.next, pieces, &mut impasse, observer);
        let is_ended = parts.add(part)?;
        // A step whose end cannot be evaluated was taken, or one of an explicit method, which does not shorten it: a shorter one is tried.
        let shorter = impasse.failed_step.take();
        let shorter = shorter.filter(|_| is_ended && !impasse.is_reached());
        let (Some(step), Some(whole)) = (shorter, &mut parts.whole) else {
            break;
        };
        whole.error = None;
        parts.next.first_step = Some(FAILURE_REDUCTION * step);
    }
    parts.whole.ok_or(DynamicsError::DurationTooShort)
}

/// Integrates as far as one run of the method leads.
// Long because diffsol's problem is a type of closures, which has no name and borrows what is counted and kept here.
fn integrate_part(
    system: &mut dyn OdeSystem,
    part: &Part,
    pieces: Option<&mut TimePieces<'_>>,
    impasse: &mut Impasse,
    observer: StepObserver<'_>,
) -> Result<Termination> {
    let (n, start, options) = (system.size(), &part.start, &part.options);
    // A start that cannot be evaluated is an error at once, not after a search for a step size.
    let mut rates = vec![0.0; n];
    system.rhs(start.t, &start.y, &mut rates)?;
    // At rest the rates show how soon something happens: a motor's current rises within microseconds.
    let started = start.y.iter().chain(&rates);
    let max_rate = started.fold(1.0_f64, |max, y| max.max(y.abs()));
    let atol = impasse.absolute.clone();
    let min_step = MIN_STEP / max_rate;
    if options.method == Method::Dop853 {
        let stepper = dop853::Stepper::new(system, part, &rates, &atol, min_step);
        return Ok(stepper.integrate(pieces, &mut impasse.pace, observer));
    }
    let system = RefCell::new(system);
    let failure: RefCell<Option<DynamicsError>> = RefCell::new(None);
    let (evaluations, jacobians) = (Cell::new(0), Cell::new(0));
    // diffsol requests the Jacobian column by column at one state.
    let last = RefCell::new((vec![f64::NAN; n + 1], vec![0.0; n * n]));
    let solver = |e: DiffsolError| solver_error(&e, start.t);
    let mut problem = OdeBuilder::<Matrix>::new()
        .t0(start.t)
        .rtol(options.rtol)
        .atol(atol)
        .p(Vec::<f64>::new())
        .rhs_implicit(
            |x, _p, t, out| {
                evaluations.set(evaluations.get() + 1);
                if let Err(e) = system.borrow_mut().rhs(t, x, out) {
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
                    // Columns that are not requested must not enter (0 × ∞ is NaN).
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
    problem.ode_options.min_timestep = min_step;
    let mut step_loop = StepLoop {
        part,
        failure: &failure,
        pieces,
        impasse,
        balance: &|at: &OdeState| system.borrow_mut().balance(at),
        fault: &|at: &OdeState| {
            let mut rates = vec![0.0; n];
            evaluations.set(evaluations.get() + 1);
            system.borrow_mut().rhs(at.t, &at.y, &mut rates).err()
        },
    };
    // A method of one step goes on with the step before the event; that of many begins with the first order.
    let state_of = |tableau: Tableau<f64>| {
        let mut state = problem.rk_state(&tableau)?;
        if let Some(step) = part.first_step {
            *state.as_mut().h = step.min(part.end.map_or(f64::INFINITY, |end| end - start.t));
        }
        Ok::<_, DiffsolError>(state)
    };
    let mut termination = match options.method {
        Method::Bdf => step_loop.run(&mut problem.bdf::<Solver>().map_err(solver)?, observer),
        #[cfg(not(target_family = "wasm"))]
        Method::Esdirk34 => {
            let state = state_of(Tableau::esdirk34()).map_err(solver)?;
            let by = problem.esdirk34_solver::<Solver>(state);
            step_loop.run(&mut by.map_err(solver)?, observer)
        }
        #[cfg(not(target_family = "wasm"))]
        Method::TrBdf2 => {
            let state = state_of(Tableau::tr_bdf2()).map_err(solver)?;
            let by = problem.tr_bdf2_solver::<Solver>(state);
            step_loop.run(&mut by.map_err(solver)?, observer)
        }
        // The live page takes the default of the command line and the method it is compared with: others would make its
        // module larger.
        #[cfg(target_family = "wasm")]
        Method::Esdirk34 | Method::TrBdf2 => {
            return Err(DynamicsError::Solver {
                t: start.t,
                reason: format!("{} is not part of this program", options.method.name()),
            });
        }
        // The eighth order is done above.
        Method::Tsit45 | Method::Dop853 => {
            let state = state_of(Tableau::tsit45()).map_err(solver)?;
            let mut by = problem.tsit45_solver(state).map_err(solver)?;
            step_loop.run(&mut by, observer)
        }
    };
    termination.statistics.evaluations = evaluations.get();
    termination.statistics.jacobians = jacobians.get();
    Ok(termination)
}
