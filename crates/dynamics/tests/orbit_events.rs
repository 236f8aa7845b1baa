//! The events of orbits, found in a few periods and repeated: against an integration of the whole motion.
#![allow(clippy::expect_used, reason = "tests")]

mod parts;

use dwell_dynamics::{DynamicsError, EventKind, Method};
use parts::gravity;
use parts::watched::{Watched, counts, stop_at, watch};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Librations and rotations, each with a coordinate that follows from the actuator's and a value of a reaction that it
/// passes.
fn machines() -> Vec<(Watched, Vec<EventKind>)> {
    let load = [gravity()];
    let all = [
        Watched::pendulum([1.0, 0.0]),
        Watched::pendulum([0.3, -2.0]),
        Watched::pendulum([0.3, -8.0]),
        Watched::crank_rocker(&load, [1.0, 10.0]),
        Watched::crank_rocker(&load, [-1.2, 0.0]),
        Watched::crank_rocker(&[], [1.0, -3.0]),
        Watched::slider_crank([-1.0, 0.5]),
        Watched::slider_crank([-1.0, 11.0]),
    ];
    let with_events = |machine: Watched| {
        let orbit = machine.orbit();
        let follower = match machine.name {
            "pendulum" => machine.angle(1),
            "crank-rocker" => machine.angle(3),
            _ => machine.travel(3),
        };
        let at = |part: f64| machine.values(follower, 0, orbit.state_at(part * orbit.period));
        let ([value, reaction], phi) = (at(0.37), machine.angle(1));
        let forward = machine.start.q_dot.signum();
        let kinds = vec![
            EventKind::Reaches(phi, machine.start.q - 0.2),
            EventKind::Reaches(phi, machine.start.q + forward * 5.5 * TAU),
            EventKind::Reaches(follower, value),
            EventKind::Reversal(phi),
            EventKind::Reversal(follower),
            EventKind::Reaction(0, reaction),
            EventKind::Revolution(phi),
        ];
        (machine, kinds)
    };
    all.into_iter().map(with_events).collect()
}

#[test]
fn events_are_those_of_an_integration() {
    for (machine, kinds) in machines() {
        let period = machine.orbit().period;
        let end = 9.3 * period;
        let events = watch(&kinds);
        let integrated = machine.by_integration(Method::Dop853, 1e-13, end, &events);
        let found = machine.by_quadrature(1e-10, end, &events);
        let name = machine.name;
        println!(
            "{name} {:?}: {:?}",
            machine.start,
            counts(&found, kinds.len())
        );
        assert_eq!(
            counts(&found, kinds.len()),
            counts(&integrated, kinds.len()),
            "{name}"
        );
        for e in 0..kinds.len() {
            let of = |s: &dwell_dynamics::Solution| -> Vec<(f64, bool, f64)> {
                let all = s.event_occurrences.iter().filter(|o| o.event == e);
                all.map(|o| (o.state.t, o.rising, o.state.y[0])).collect()
            };
            for (a, b) in of(&found).iter().zip(of(&integrated)) {
                assert!(
                    (a.0 - b.0).abs() < 1e-9 * period,
                    "{name} {e}: {} {}",
                    a.0,
                    b.0
                );
                assert!(
                    a.1 == b.1 && (a.2 - b.2).abs() < 1e-7,
                    "{name} {e}: {a:?} {b:?}"
                );
            }
        }
        assert!(
            found
                .event_occurrences
                .is_sorted_by(|a, b| a.state.t <= b.state.t)
        );
    }
}

#[test]
fn each_occurrence_stops_the_motion() {
    for (machine, kinds) in machines() {
        let period = machine.orbit().period;
        let end = 9.3 * period;
        let all = machine.by_integration(Method::Dop853, 1e-13, end, &watch(&kinds));
        for (e, &kind) in kinds.iter().enumerate() {
            let times = all.event_occurrences.iter().filter(|o| o.event == e);
            for (k, occurrence) in times.enumerate() {
                let mut events = watch(&kinds);
                events[e] = stop_at(kind, k + 1);
                let found = machine.by_quadrature(1e-10, end, &events);
                let last = found.steps.last().expect("a step").t;
                let wanted = occurrence.state.t;
                assert!(found.terminated_by_event, "{} {e} {k}", machine.name);
                assert!(
                    (last - wanted).abs() < 1e-9 * period,
                    "{} {e} {k}: {last} {wanted}",
                    machine.name
                );
                let before = all.event_occurrences.iter().filter(|o| o.state.t <= wanted);
                // Two events at one time may be in either order.
                let difference = before.count().abs_diff(found.event_occurrences.len());
                assert!(difference <= 1, "{} {e} {k}: {difference}", machine.name);
            }
        }
    }
}

/// After a million periods, at no more cost than after ten.
#[test]
fn what_happens_after_a_million_periods() {
    let wheel = Watched::pendulum([0.0, 9.0]);
    let (phi, period) = (wheel.angle(1), wheel.orbit().period);
    let far = stop_at(EventKind::Reaches(phi, 1e6 * TAU - FRAC_PI_2 + PI), 1);
    let solution = wheel.by_quadrature(1e-12, 2e6 * period, &[far]);
    let last = solution.steps.last().expect("a step");
    // At the top, half a period after the millionth revolution: by symmetry.
    assert!(solution.terminated_by_event && solution.event_occurrences.len() == 1);
    assert!(
        (last.t / period - 1e6 - 0.5).abs() < 1e-6,
        "{}",
        last.t / period
    );
    assert!(
        (last.y[0] - 1e6 * TAU - FRAC_PI_2).abs() < 1e-8,
        "{}",
        last.y[0]
    );
    // The 90 000th reversal of a swing.
    let swing = Watched::pendulum([1.0, 0.0]);
    let (phi, period) = (swing.angle(1), swing.orbit().period);
    let back = stop_at(EventKind::Reversal(phi), 90_000);
    let solution = swing.by_quadrature(1e-12, 1e6 * period, &[back]);
    let last = solution.steps.last().expect("a step");
    assert_eq!(solution.event_occurrences.len(), 90_000);
    assert!(
        (last.t / period - 45_000.0).abs() < 1e-7,
        "{}",
        last.t / period
    );
}

/// More events than can be stored are an error, not a shorter list.
#[test]
fn too_many_events_are_an_error() {
    let swing = Watched::pendulum([1.0, 0.0]);
    let (phi, period) = (swing.angle(1), swing.orbit().period);
    let kinds = watch(&[EventKind::Reversal(phi)]);
    let few = swing.by_quadrature(1e-12, 49_999.0 * period, &kinds);
    assert!(few.error.is_none() && few.event_occurrences.len() == 99_998);
    let many = swing.by_quadrature(1e-12, 1e6 * period, &kinds);
    let Some(DynamicsError::TooManyEvents { t, max_occurrences }) = many.error else {
        panic!("{:?}", many.error)
    };
    assert!(
        max_occurrences == 100_000 && (t / period - 50_000.0).abs() < 1e-6,
        "{t}"
    );
    let last = many.steps.last().expect("a step").t;
    assert!(
        !many.terminated_by_event && (last - t).abs() < 1e-9 * t,
        "{last} {t}"
    );
}
