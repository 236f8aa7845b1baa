//! Events of a motion: where they are on the dense output, and how far that is from the motion itself;
//! and what is left of ten turns.

use dwell_dynamics::{
    CoordinateMode, Event, EventKind, Machine, Method, OdeState, Options, Orbit, ReducedState,
    solve, solve_reduced,
};
use dwell_geometry::body_states::CoordinateFunction;
use dwell_kinetostatics::{Model, ReducedModel};
use dwell_tests::fixtures::{model_for, scene};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::num::NonZeroUsize;

/// The pendulum A01 falls from level: it passes the bottom after a quarter of its period, where the
/// horizontal force of its pin changes its sign, and turns back after half of it.
#[test]
// Long: one motion, event by event.
fn val_events_of_a_pendulum() {
    let scene = scene("pendulum-a01");
    let all = scene.mechanism.reactions();
    let start = scene.assembly.to_configuration();
    let bare = Model::new(&scene.mechanism, &scene.masses, &start, &all).expect("a model");
    let output_model = bare.clone().with_loads(scene.loads.clone()).expect("loads");
    let free = vec![CoordinateMode::Free];
    let machine = Machine::new(bare, &scene.loads, free, &[]).expect("a machine");
    let at = ReducedState {
        t: 0.0,
        q: PI,
        q_dot: 0.0,
    };
    let period = Orbit::loaded(&machine, at).expect("a period").period;
    let phi = CoordinateFunction::find(&scene.mechanism, scene.mechanism.actuators[0].coordinate());
    let phi = phi.expect("a coordinate");
    let events = [
        EventKind::Reaches(phi, PI + FRAC_PI_2),
        EventKind::Reaction(0, 0.0),
        EventKind::Reversal(phi),
        EventKind::Revolution(phi),
    ]
    .map(|trigger| Event {
        kind: trigger,
        terminal: None,
    });
    let from = OdeState {
        t: 0.0,
        y: machine.initial_state(&[PI], &[0.0]),
    };
    let options = Options::new(Method::Tsit45, 1e-13);
    let solution = solve(
        &machine,
        &output_model,
        &from,
        2.1 * period,
        &options,
        &events,
    )
    .expect("a run");
    let times = |event: usize| -> Vec<f64> {
        let mine = solution
            .event_occurrences
            .iter()
            .filter(|o| o.event == event);
        mine.map(|o| o.state.t / period).collect()
    };
    let near = |found: Vec<f64>, expected: &[f64]| {
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (found, expected) in found.iter().zip(expected) {
            // Tsit45 errs by tens of its tolerance in two periods, its dense output by hundreds.
            assert!((found - expected).abs() < 1e-10, "{found} {expected}");
        }
    };
    near(times(0), &[0.25, 0.75, 1.25, 1.75]);
    near(times(2), &[0.5, 1.0, 1.5, 2.0]);
    near(times(3), &[]);
    // The horizontal force is zero where the bar is upright, and where it is level and at rest.
    let upright = times(1)
        .into_iter()
        .filter(|t| (t / 0.5).fract() > 0.1 && (t / 0.5).fract() < 0.9);
    near(upright.collect(), &[0.25, 0.75, 1.25, 1.75]);
    for occurrence in solution.event_occurrences.iter().filter(|o| o.event == 0) {
        // As a root of the dense output it is exact: 1e-12 of the span of 3 rad is asked for.
        let error = (occurrence.state.y[0] - PI - FRAC_PI_2).abs();
        assert!(error < 1e-13 * PI, "{error:e}");
    }
    // An event that stops ends the motion where it is.
    let stop = [Event {
        kind: EventKind::Reaches(phi, PI + FRAC_PI_2),
        terminal: Some(NonZeroUsize::MIN),
    }];
    let solution = solve(&machine, &output_model, &from, 9.0, &options, &stop).expect("a run");
    assert!(solution.terminated_by_event);
    let end = solution.steps.last().expect("a step");
    assert!((end.t / period - 0.25).abs() < 1e-10, "{}", end.t);
}

/// Ten turns of the free crank-rocker take ten times its period of 0.7314883837332251 s.
#[test]
fn val_ten_turns_of_the_crank_rocker() {
    let model = model_for(&scene("crank-rocker"), &[]);
    let start = ReducedState {
        t: 0.0,
        q: PI / 3.0,
        q_dot: 10.0,
    };
    let end = 10.0 * 0.731_488_383_733_225_1;
    assert_eq!(model.reactions(), 0);
    for (method, tolerance) in [(Method::Tsit45, 1e-9), (Method::Bdf, 5e-9)] {
        let run = solve_reduced(&model, start, Some(end), &Options::new(method, 1e-13), &[]);
        let run = run.expect("a run").completed().expect("all of it");
        let last = run.steps.last().expect("a step");
        let error = (last.y[0] - start.q - 10.0 * TAU).abs();
        assert!(error < tolerance, "{} {error:e}", method.name());
    }
}
