//! Loads whose decisions depend on each other: a function that rests on its threshold, and what happens in windows between the
//! points of a step. A wheel passes 0.5 rad with a known work behind it.
#![allow(clippy::expect_used, clippy::panic, reason = "tests")]

mod parts;

use dwell_dynamics::{Machine, Method, OdeState, Options, solve};
use dwell_kinetostatics::{Magnitude, Signal};
use dwell_laws::Expression;
use parts::{INERTIA, angle, end_state, error_ratio, wheel};

/// A wheel under a couple of angle, speed and time.
fn wheel_under(text: &str) -> Machine {
    let expression = Expression::parse(text, &["q", "v", "t"]).expect(text);
    let coordinate = angle([0, 1]).coordinate();
    let signals = [
        Signal::Value(coordinate),
        Signal::Velocity(coordinate),
        Signal::Time,
    ];
    wheel(Magnitude::Expression(expression, signals.into()), &[])
}

/// The end state from 0 rad and a speed, by every method.
fn check(text: &str, speed: f64, end: f64, expected: [f64; 2], growth: f64) {
    let machine = wheel_under(text);
    for method in Method::ALL {
        let options = Options::new(method, 1e-9);
        let start = OdeState {
            t: 0.0,
            y: machine.initial_state(&[0.0], &[speed]),
        };
        let solution = solve(&machine, machine.model(), &start, end, &options, &[]);
        let solution = solution.expect("a start").completed().expect(text);
        let allowed = growth * error_ratio(method) * options.rtol + 1e-13;
        for (found, expected) in end_state(&solution).into_iter().zip(expected) {
            let error = (found - expected).abs() / expected.abs().max(1.0);
            assert!(
                error <= allowed,
                "{text}, {method:?}: {found} {expected}, {error:e}"
            );
        }
    }
}

/// The state at `end` behind 0.5 rad, up to which a couple acts.
fn behind(couple: f64, speed: f64, end: f64) -> [f64; 2] {
    let last = (speed * speed + 2.0 * couple / INERTIA * 0.5).sqrt();
    let duration = 2.0 * 0.5 / (speed + last);
    [0.5 + last * (end - duration), last]
}

#[test]
fn a_decision_that_rests_on_its_threshold_is_taken_anew() {
    for text in [
        "if(step(q - 0.5) < 1, 10, 0)",
        "if(if(q < 0.5, 1, 0) > 0, 10, 0)",
        "10*sign(if(q < 0.5, 1, 0))",
        "if(floor(2*q) < 1, 10, 0)",
        "if(floor(2*q) >= 1, 0, 10)",
        "10*sign(max(0, 0.5 - q))",
        "10*sign(0.5 - clamp(q, -2, 0.5))",
        "10*(1 - step(-abs(step(q - 0.5) - 1)))",
        "10*sign(max(0, 1 - floor(2*q)))",
        "10*sign(abs(0.5 - q) + (0.5 - q))",
        "if(max(step(q - 0.5), 0) <= 0, 10, 0)",
        "10*min(1, -floor(-max(0, 0.5 - q)))",
        "if(step(t - 0.25)*(q - q) < 1, if(step(q - 0.5) < 1, 10, 0), 7)",
    ] {
        check(text, 1.0, 2.0, behind(10.0, 1.0, 2.0), 30.0);
    }
    // With a window of its own behind 0.5 rad, and one that goes on with another sign.
    let narrow = (1.0_f64 + 2.0 * 5000.0 / INERTIA * 1e-4).sqrt();
    let inside = 2.0 * 1e-4 / (1.0 + narrow);
    let expected = [0.5001 + narrow * (1.5 - inside), narrow];
    check(
        "5000*sign(max(0, min(q - 0.5, 0.5001 - q)))",
        1.0,
        2.0,
        expected,
        100.0,
    );
}

#[test]
fn the_same_holds_in_time() {
    let until_one = |couple: f64| {
        let a = couple / INERTIA;
        [1.0 + 0.5 * a + (1.0 + a), 1.0 + a]
    };
    for text in [
        "if(step(t - 1) < 1, 10, 0)",
        "if(floor(t) < 1, 10, 0)",
        "10*sign(max(0, 1 - t))",
        "10*sign(abs(1 - t) + (1 - t))",
        "if(abs(sign(max(0, 1 - t))) > 0, 10, 0)",
        "if(step(t - 1) < 1 + 0*q, 10, 0)",
    ] {
        check(text, 1.0, 2.0, until_one(10.0), 1.0);
    }
    for text in [
        "max(0, 0*t)",
        "max(0, -floor(2*t))",
        "abs(abs(0*t))",
        "max(0, abs(t) - t)",
    ] {
        check(text, 1.0, 2.0, [3.0, 1.0], 1.0);
    }
}

/// Where a condition holds in a window that no point of a step falls into.
#[test]
fn a_window_of_a_smooth_function_is_met() {
    let half = 1e-4 * std::f64::consts::LN_2.sqrt();
    let last = (1.0_f64 + 2.0 * 5000.0 / INERTIA * 2.0 * half).sqrt();
    let inside = 4.0 * half / (1.0 + last);
    let expected = [0.5 + half + last * (2.0 - (0.5 - half) - inside), last];
    check(
        "if(exp(-((q-0.5)/1e-4)^2) > 0.5, 5000, 0)",
        1.0,
        2.0,
        expected,
        100.0,
    );
    check(
        "if(1/(1 + ((q-0.5)/1e-4)^2) > 1/(1 + ln(2)), 5000, 0)"
            .replace("ln(2)", "0.6931471805599453")
            .as_str(),
        1.0,
        2.0,
        expected,
        100.0,
    );
}

/// A pulse of work W between the points of a step: ½ J v² grows by W.
#[test]
fn a_narrow_pulse_of_the_angle_is_met() {
    let work = 500.0 * 1e-3 * std::f64::consts::PI.sqrt();
    let last = (1.0_f64 + 2.0 * work / INERTIA).sqrt();
    let machine = wheel_under("500*exp(-((q-0.5)/1e-3)^2)");
    for method in Method::ALL {
        let options = Options::new(method, 1e-9);
        let start = OdeState {
            t: 0.0,
            y: machine.initial_state(&[0.0], &[1.0]),
        };
        let solution = solve(&machine, machine.model(), &start, 2.0, &options, &[]);
        let [_, found] = end_state(&solution.expect("a start").completed().expect("a motion"));
        assert!((found - last).abs() < 1e-6, "{method:?}: {found} {last}");
    }
}
