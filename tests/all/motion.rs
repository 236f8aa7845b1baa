//! Free motion: energy, period, time history and the integrators' guard.

use crate::world::{model_for, scene};
use dwell_dynamics::{DynamicsError, Equation, Method, Options, Orbit, State, Until, simulate};
use dwell_geometry::PlaceError;
use dwell_kinetostatics::{Exact, Reduced};

const START: State = State {
    t: 0.0,
    q: 0.0,
    q_dot: 1.0,
};

fn single_dwell() -> Exact {
    model_for(&scene("single-dwell"), &[])
}

#[test]
fn val_period_of_the_single_dwell() {
    let model = single_dwell();
    let turn = Orbit::new(&model, START).expect("a period");
    // 50-digit arithmetic: 5.4196626770642718779 s.
    assert!((turn.period - 5.419_662_677_064_272).abs() < 1e-13 * turn.period);
    for (method, within) in [
        (Method::Bdf, 1e-9),
        (Method::Tsit45, 1e-11),
        (Method::Dop853, 1e-11),
    ] {
        let run = simulate(&model, START, Until::Turns(1), &Options::new(method, 1e-13));
        let t = run.expect("a run").turns[0].t;
        assert!((t - turn.period).abs() < within, "{} {t}", method.name());
    }
}

/// Nothing in the free motion knows a direction of time: backwards, a turn takes as long, and the
/// state at −t is the mirror of that at t.
#[test]
fn the_way_back_takes_as_long() {
    let model = single_dwell();
    let forward = Orbit::new(&model, State { q: 1.0, ..START }).expect("a period");
    let back = State {
        q: 1.0,
        q_dot: -1.0,
        ..START
    };
    let backward = Orbit::new(&model, back).expect("a period");
    assert!((forward.period - backward.period).abs() < 1e-14 * forward.period);
    let run = simulate(
        &model,
        back,
        Until::Turns(2),
        &Options::new(Method::Tsit45, 1e-12),
    );
    let run = run.expect("a run");
    assert!((run.turns[1].t - 2.0 * backward.period).abs() < 1e-10);
    let there = forward.at(1.5);
    let whole = backward.at(backward.period - 1.5);
    // A turn forwards and the rest of a turn backwards meet a turn apart.
    assert!((there.q - whole.q - std::f64::consts::TAU).abs() < 1e-12);
    assert!((there.q_dot + whole.q_dot).abs() < 1e-12);
}

/// The time history by quadrature and by an integrator, at every step of the latter.
#[test]
fn history_by_quadrature_is_the_integrated_one() {
    let model = single_dwell();
    let turn = Orbit::new(&model, START).expect("a period");
    let mut options = Options::new(Method::Tsit45, 1e-13);
    options.every = Some(0.01);
    let run = simulate(&model, START, Until::Time(12.0), &options).expect("a run");
    assert_eq!(run.samples.len(), 1201);
    for step in &run.steps {
        let exact = turn.at(step.t);
        assert!((exact.q - step.q).abs() < 1e-11 && (exact.q_dot - step.q_dot).abs() < 1e-11);
        assert!((turn.time_at(step.q).expect("a time") - step.t).abs() < 1e-11);
    }
    // The dense output is poorer than the steps, but not by much.
    for sample in &run.samples {
        let exact = turn.at(sample.t);
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
        let mut equation = Equation::new(&model);
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
        simulate(&model, START, Until::Turns(10), &options)
    };
    assert!(matches!(
        with(|o| o.budget = 20),
        Err(DynamicsError::Budget { steps: 20, .. })
    ));
    for change in [
        (|o: &mut Options| o.absolute = 0.0) as fn(&mut Options),
        |o| o.absolute = f64::NAN,
        |o| o.relative = -1e-8,
        |o| o.relative = f64::INFINITY,
        |o| o.every = Some(0.0),
    ] {
        assert!(matches!(with(change), Err(DynamicsError::BadOption { .. })));
    }
    let still = State {
        q_dot: 0.0,
        ..START
    };
    assert_eq!(
        simulate(
            &model,
            still,
            Until::Turns(1),
            &Options::new(Method::Bdf, 1e-8)
        ),
        Err(DynamicsError::AtRest)
    );
    let nowhere = State {
        q: f64::NAN,
        ..START
    };
    assert!(
        simulate(
            &model,
            nowhere,
            Until::Time(1.0),
            &Options::new(Method::Bdf, 1e-8)
        )
        .is_err()
    );
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
        let start = State { q: 3.0, ..START };
        let run = simulate(&model, start, Until::Time(1e4), &Options::new(method, 1e-8));
        match run {
            Err(DynamicsError::Limit { q, .. }) => {
                assert!((q - to).abs() < 0.2, "{} {q} {to}", method.name());
            }
            Err(DynamicsError::Place(
                PlaceError::OutOfRange { q, .. }
                | PlaceError::Singular { q, .. }
                | PlaceError::NotClosed { q, .. },
            )) => assert!((q - to).abs() < 0.2, "{} {q} {to}", method.name()),
            other => panic!("{}: {:?}", method.name(), other.map(|r| r.steps.len())),
        }
    }
}
