//! Free motion: energy, period, time history and the integrators' guard.

use dwell_dynamics::{
    DynamicsError, Event, EventKind, Method, Options, Orbit, ReducedCoordinate, ReducedOde,
    ReducedState, Solution, solve_reduced,
};
use dwell_geometry::PositionError;
use dwell_kinetostatics::{ExactModel, ReducedModel};
use dwell_tests::fixtures::{model_for, scene};
use std::num::NonZeroUsize;

const START: ReducedState = ReducedState {
    t: 0.0,
    q: 0.0,
    q_dot: 1.0,
};

fn single_dwell() -> ExactModel {
    model_for(&scene("single-dwell"), &[])
}

/// The free motion over some whole revolutions, each of which is an event.
fn revolve(
    model: &ExactModel,
    start: ReducedState,
    revolutions: usize,
    options: &Options,
) -> Result<Solution, DynamicsError> {
    let last = Event {
        kind: EventKind::Revolution(ReducedCoordinate),
        terminal: NonZeroUsize::new(revolutions),
    };
    solve_reduced(model, start, None, options, &[last])?.completed()
}

#[test]
fn val_period_of_the_single_dwell() {
    let model = single_dwell();
    let orbit = Orbit::new(&model, START).expect("a period");
    // 50-digit arithmetic: 5.4196626770642718779 s.
    assert!((orbit.period - 5.419_662_677_064_272).abs() < 1e-13 * orbit.period);
    for (method, tolerance) in [
        (Method::Bdf, 1e-9),
        (Method::Tsit45, 1e-11),
        (Method::Dop853, 1e-11),
    ] {
        let run = revolve(&model, START, 1, &Options::new(method, 1e-13)).expect("a run");
        assert!(run.terminated_by_event);
        let t = run.event_occurrences[0].state.t;
        assert_eq!(run.steps.last().expect("a step").t, t);
        assert!(
            (t - orbit.period).abs() < tolerance,
            "{} {t}",
            method.name()
        );
    }
}

/// Nothing in the free motion knows a direction of time: backwards, a turn takes as long, and the
/// state at −t is the mirror of that at t.
#[test]
fn the_way_back_takes_as_long() {
    let model = single_dwell();
    let forward = Orbit::new(&model, ReducedState { q: 1.0, ..START }).expect("a period");
    let back = ReducedState {
        q: 1.0,
        q_dot: -1.0,
        ..START
    };
    let backward = Orbit::new(&model, back).expect("a period");
    assert!((forward.period - backward.period).abs() < 1e-14 * forward.period);
    let run = revolve(&model, back, 2, &Options::new(Method::Tsit45, 1e-12)).expect("a run");
    let second = &run.event_occurrences[1];
    assert!((second.state.t - 2.0 * backward.period).abs() < 1e-10);
    let there = forward.state_at(1.5);
    let whole = backward.state_at(backward.period - 1.5);
    // A turn forwards and the rest of a turn backwards meet a turn apart.
    assert!((there.q - whole.q - std::f64::consts::TAU).abs() < 1e-12);
    assert!((there.q_dot + whole.q_dot).abs() < 1e-12);
}

/// The time history by quadrature and by an integrator, at every step of the latter.
#[test]
fn history_by_quadrature_is_the_integrated_one() {
    let model = single_dwell();
    let orbit = Orbit::new(&model, START).expect("a period");
    let mut options = Options::new(Method::Tsit45, 1e-13);
    options.sample_interval = Some(0.01);
    let run = solve_reduced(&model, START, Some(12.0), &options, &[]).expect("a run");
    assert_eq!((run.samples.len(), &run.error), (1201, &None));
    for step in run.steps.iter().map(ReducedState::from) {
        let exact = orbit.state_at(step.t);
        assert!((exact.q - step.q).abs() < 1e-11 && (exact.q_dot - step.q_dot).abs() < 1e-11);
        assert!((orbit.time_at(step.q).expect("a time") - step.t).abs() < 1e-11);
    }
    // The dense output is poorer than the steps, but not by much.
    for sample in run.samples.iter().map(ReducedState::from) {
        let exact = orbit.state_at(sample.t);
        assert!((exact.q - sample.q).abs() < 1e-10, "{sample:?}");
    }
}

/// ∂q̈/∂q and ∂q̈/∂q̇ against differences of q̈: BDF would hide a wrong Jacobian.
#[test]
fn jacobian_is_the_derivative_of_the_acceleration() {
    for case in [
        "single-dwell",
        "crank-rocker",
        "slotted-rocker",
        "class-three-six-bar",
    ] {
        let model = model_for(&scene(case), &[]);
        let mut equation = ReducedOde::new(&model);
        let (from, to) = match model.range().limits() {
            None => (0.0, std::f64::consts::TAU),
            Some((from, to)) => (from + 0.3, to - 0.3),
        };
        for i in 0..20 {
            let q = from + (to - from) * f64::from(i) / 19.0;
            let q_dot = 0.7 + 0.1 * f64::from(i);
            let exact = equation.jacobian(q, q_dot).expect("a Jacobian");
            let mut slope = |dq: f64, dv: f64| {
                let mut at = |k: f64| {
                    equation
                        .acceleration(q + k * dq, q_dot + k * dv)
                        .expect("q̈")
                };
                (8.0 * (at(1.0) - at(-1.0)) - (at(2.0) - at(-2.0))) / 12.0
            };
            let h = 2e-4;
            let by_difference = [slope(h, 0.0) / h, slope(0.0, h) / h];
            for (e, d) in exact.iter().zip(by_difference) {
                assert!(
                    (e - d).abs() < 1e-8 * (1.0 + e.abs()),
                    "{case} {q}: {e} {d}"
                );
            }
        }
    }
}

#[test]
fn the_guard_says_what_stopped_the_motion() {
    let model = single_dwell();
    let with = |change: fn(&mut Options)| {
        let mut options = Options::new(Method::Tsit45, 1e-8);
        change(&mut options);
        revolve(&model, START, 10, &options)
    };
    assert!(matches!(
        with(|o| o.max_steps = 20),
        Err(DynamicsError::MaxStepsReached { max_steps: 20, .. })
    ));
    for change in [
        (|o: &mut Options| o.atol = 0.0) as fn(&mut Options),
        |o| o.atol = f64::NAN,
        |o| o.rtol = -1e-8,
        |o| o.rtol = f64::INFINITY,
        |o| o.sample_interval = Some(0.0),
    ] {
        assert!(matches!(with(change), Err(DynamicsError::BadOption { .. })));
    }
    let still = ReducedState {
        q_dot: 0.0,
        ..START
    };
    assert_eq!(
        revolve(&model, still, 1, &Options::new(Method::Bdf, 1e-8)),
        Err(DynamicsError::AtRest)
    );
    let nowhere = ReducedState {
        q: f64::NAN,
        ..START
    };
    let options = Options::new(Method::Bdf, 1e-8);
    assert!(solve_reduced(&model, nowhere, Some(1.0), &options, &[]).is_err());
}

/// At a limit position of its actuator the mechanism passes to another branch. In the actuator's
/// coordinate that looks like a smooth return, which an integrator may step through: never silently.
#[test]
fn a_limit_position_ends_the_motion_with_its_place() {
    let model = model_for(&scene("class-three-six-bar"), &[]);
    let Some((_, to)) = model.range().limits() else {
        panic!("a limited range");
    };
    for method in [Method::Bdf, Method::Tsit45] {
        let start = ReducedState { q: 3.0, ..START };
        let options = Options::new(method, 1e-8);
        let run = solve_reduced(&model, start, Some(1e4), &options, &[]);
        match run.and_then(Solution::completed) {
            Err(DynamicsError::LimitPosition { q, .. }) => {
                assert!((q - to).abs() < 0.2, "{} {q} {to}", method.name());
            }
            Err(DynamicsError::Position(
                PositionError::OutOfRange { q, .. }
                | PositionError::Singular { q, .. }
                | PositionError::NotConverged { q, .. },
            )) => assert!((q - to).abs() < 0.2, "{} {q} {to}", method.name()),
            other => panic!("{}: {:?}", method.name(), other.map(|r| r.steps.len())),
        }
    }
}
