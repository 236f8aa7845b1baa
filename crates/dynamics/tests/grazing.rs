//! Values that a motion passes barely, touches, or just misses: all methods find the same events.
#![allow(clippy::expect_used, reason = "tests")]

mod parts;

use dwell_dynamics::{EventKind, Method, ReducedState, Solution};
use parts::watched::{Watched, counts, watch};
use std::f64::consts::FRAC_PI_2;

const AMPLITUDE: f64 = 1.2;
const TOLERANCE: f64 = 1e-10;

/// The motion of a machine by all integrators and by quadrature.
fn by_all(of: &Watched, end: f64, kinds: &[EventKind]) -> Vec<(&'static str, Solution)> {
    let events = watch(kinds);
    let integrated = Method::ALL.map(|method| {
        let solution = of.by_integration(method, TOLERANCE, end, &events);
        (method.name(), solution.completed().expect("all of it"))
    });
    let orbit = ("quadrature", of.by_quadrature(TOLERANCE, end, &events));
    integrated.into_iter().chain([orbit]).collect()
}

/// A pendulum released at rest passes angles below its amplitude twice at each end, once just after the release, and
/// others never: that of the release and its mirror image are touched.
#[test]
fn angles_next_to_a_turning_point() {
    let pendulum = Watched::pendulum([AMPLITUDE, 0.0]);
    let end = 3.3 * pendulum.orbit().period;
    let phi = pendulum.angle(1);
    let parts = [1.0 - 1e-3, 1.0 - 1e-6, 1.0, 1.0 + 1e-6, 1.0 + 1e-3];
    let at =
        |side: f64| parts.map(|part| EventKind::Reaches(phi, side * part * AMPLITUDE - FRAC_PI_2));
    let kinds: Vec<EventKind> = at(1.0).into_iter().chain(at(-1.0)).collect();
    for (name, solution) in by_all(&pendulum, end, &kinds) {
        let found = counts(&solution, kinds.len());
        assert_eq!(found, [7, 7, 0, 0, 0, 6, 6, 0, 0, 0], "{name}");
        for occurrence in &solution.event_occurrences {
            // By the closed form of the energy: ω² = (3 g / l) (cos φ − cos A), near the turning point A − φ = ½ |α| t².
            let part = parts[occurrence.event % 5];
            let period = end / 3.3;
            let nearest = (occurrence.state.t / (0.5 * period)).round() * 0.5 * period;
            let speedup = (2.0 * (1.0 - part) * AMPLITUDE / (1.5 * 9.81 * AMPLITUDE.sin())).sqrt();
            let distance = (occurrence.state.t - nearest).abs();
            // Implicit methods lose some 1e-7 of the amplitude: tenths of an excursion of 1e-6.
            let is_exact = ["quadrature", "DOP853", "Tsit45"].contains(&name);
            let tolerance = if part > 0.9999 && !is_exact {
                0.2
            } else {
                2e-3
            };
            let ratio = distance / speedup;
            assert!((ratio - 1.0).abs() < tolerance, "{name} {part} {ratio}");
        }
    }
}

/// At the bottom the pin's vertical force is largest: a value just below it is passed twice in each swing.
#[test]
fn forces_next_to_their_peak() {
    let pendulum = Watched::pendulum([AMPLITUDE, 0.0]);
    let orbit = pendulum.orbit();
    let end = 3.3 * orbit.period;
    let bottom = ReducedState {
        q: -FRAC_PI_2,
        ..orbit.state_at(0.25 * orbit.period)
    };
    let [_, peak] = pendulum.values(pendulum.angle(1), 1, bottom);
    // By hand: m (g + ω² l/2), ω² = (3 g / l) (1 − cos A).
    let by_hand = 2.0 * 9.81 * (1.0 + 1.5 * (1.0 - AMPLITUDE.cos()));
    assert!(
        (peak.abs() / by_hand - 1.0).abs() < 1e-12,
        "{peak} {by_hand}"
    );
    let parts = [1.0 - 1e-3, 1.0 - 1e-6, 1.0, 1.0 + 1e-6, 1.0 + 1e-3];
    let kinds = parts.map(|part| EventKind::Reaction(1, part * peak));
    for (name, solution) in by_all(&pendulum, end, &kinds) {
        // At 1/4, 3/4 … 13/4 of a period.
        assert_eq!(counts(&solution, 5), [14, 14, 0, 0, 0], "{name}");
    }
}

/// A release from rest is no reversal; nor is the start at a value a passage of it.
#[test]
fn the_start_is_no_event() {
    let pendulum = Watched::pendulum([AMPLITUDE, 0.0]);
    let end = 3.3 * pendulum.orbit().period;
    let phi = pendulum.angle(1);
    let kinds = [EventKind::Reversal(phi), EventKind::Revolution(phi)];
    for (name, solution) in by_all(&pendulum, end, &kinds) {
        assert_eq!(counts(&solution, 2), [6, 0], "{name}");
        let first = &solution.event_occurrences[0].state;
        // TR-BDF2 errs by 1e-6.
        assert!(
            (first.t / end - 0.5 / 3.3).abs() < 1e-5,
            "{name} {}",
            first.t
        );
    }
    let mut stop = watch(&kinds[..1]);
    stop[0].terminal = std::num::NonZeroUsize::new(3);
    for method in Method::ALL {
        let solution = pendulum.by_integration(method, TOLERANCE, end, &stop);
        let last = solution.steps.last().expect("a step").t;
        assert!(
            (last / end - 1.5 / 3.3).abs() < 1e-5,
            "{} {last}",
            method.name()
        );
    }
    let solution = pendulum.by_quadrature(TOLERANCE, end, &stop);
    let last = solution.steps.last().expect("a step").t;
    assert!(
        (last / end - 1.5 / 3.3).abs() < 1e-12 && solution.terminated_by_event,
        "{last}"
    );
}

/// A motion that ends at an event: rounding decides whether the event is just before or just after the end.
#[test]
fn an_event_at_the_end_happens() {
    let wheel = Watched::pendulum([0.0, 9.0]);
    let phi = wheel.angle(1);
    for periods in [1.0, 2.0, 3.0] {
        let end = periods * wheel.orbit().period;
        let all = by_all(&wheel, end, &[EventKind::Revolution(phi)]);
        // The others err by hundreds and thousands of times their tolerance.
        let exact = ["quadrature", "DOP853", "Tsit45"];
        for (name, solution) in all.into_iter().filter(|(name, _)| exact.contains(name)) {
            assert_eq!(counts(&solution, 1), [periods as usize], "{name}");
        }
    }
}

/// However far an angle has grown, its revolutions are counted, coarse as the tolerance may be.
#[test]
fn revolutions_of_a_coarse_motion() {
    let wheel = Watched::pendulum([0.0, 30.0]);
    let revolution = watch(&[EventKind::Revolution(wheel.angle(1))]);
    let end = 300.5 * wheel.orbit().period;
    let coarse = wheel.by_integration(Method::Dop853, 1e-5, end, &revolution);
    assert_eq!(counts(&coarse, 1), [300]);
    assert_eq!(
        counts(&wheel.by_quadrature(1e-2, end, &revolution), 1),
        [300]
    );
}

/// A rotor turns many times in one step, and all of its events are found.
#[test]
fn long_steps_hold_many_events() {
    let rocker = Watched::crank_rocker(&[], [1.0, 10.0]);
    let period = rocker.orbit().period;
    let psi = rocker.angle(3);
    for (name, solution) in by_all(&rocker, 6.3 * period, &[EventKind::Reversal(psi)]) {
        let found = counts(&solution, 1)[0];
        assert!((12..=13).contains(&found), "{name}: {found}");
    }
}

/// What counts as a touch, fifty times the tolerance, is more than an integration makes of one: the amplitude grows by
/// less by every method, and shrinks by less by the explicit ones. (BDF and TR-BDF2 lose up to 300 times their tolerance
/// in ten periods, ESDIRK34 up to 9000 times.)
#[test]
fn val_no_method_makes_a_passage_of_a_touch() {
    let pendulum = Watched::pendulum([AMPLITUDE, 0.0]);
    let orbit = pendulum.orbit();
    let end = 10.3 * orbit.period;
    for method in Method::ALL {
        let solution = pendulum.by_integration(method, TOLERANCE, end, &[]);
        let last = ReducedState::from(solution.steps.last().expect("a step"));
        // Of the uniform bar of 2 kg and 1 m, J; at a turning point it is the height alone.
        let energy = |at: ReducedState| at.q_dot * at.q_dot / 3.0 + 9.81 * at.q.sin();
        let gained = energy(last) - energy(orbit.state_at(end));
        let grown = gained / (9.81 * AMPLITUDE.sin()) / TOLERANCE;
        println!("{}: {grown:.1}", method.name());
        assert!(grown < 50.0, "{} {grown}", method.name());
        assert!(
            method.is_implicit() || grown > -50.0,
            "{} {grown}",
            method.name()
        );
    }
}
