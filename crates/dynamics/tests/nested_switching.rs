//! Loads whose decisions depend on each other: a function that rests on its threshold, and what happens in windows between the
//! points of a step. A wheel passes 0.5 rad after a known work.
#![allow(clippy::expect_used, clippy::panic, reason = "tests")]

mod parts;

use dwell_dynamics::{Machine, Method, OdeState, Options, solve};
use dwell_kinetostatics::{Magnitude, Signal};
use dwell_laws::Expression;
use parts::{INERTIA, angle, end_state, error_ratio, wheel};
use proptest::prelude::*;

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

/// The state at `end`, beyond 0.5 rad, up to which a couple acts.
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
        "if(clamp(sin(9*q), 0, 2) >= 0, if(q < 0.5, 10, 0), 70)",
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
        check(text, 1.0, 2.0, [2.0, 1.0], 1.0);
    }
    // Where it ends, what rests on its threshold leaves it.
    check(
        "-floor(-if(t >= 1, floor(t - 1), 0*q))",
        1.0,
        2.0,
        [2.0, 1.0],
        1.0,
    );
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

/// A window of a speed that the motion runs through within a millionth of the time of a step.
#[test]
fn a_window_of_the_speed_is_met() {
    let half = 1e-6 * std::f64::consts::LN_2.sqrt();
    let text = format!("{INERTIA}*if(exp(-((v-0.5)/1e-6)^2) > 0.5, -1000, -1)");
    let [until, inside] = [0.5 - half, 2.0 * half / 1000.0];
    let behind = [1.0 - until - inside, 0.5 - half];
    let at = |t: f64, [q, v]: [f64; 2], a: f64| [q + v * t + 0.5 * a * t * t, v + a * t];
    let entered = at(until, [0.0, 1.0], -1.0);
    let left = at(inside, entered, -1000.0);
    assert!((left[1] - behind[1]).abs() < 1e-12);
    check(&text, 1.0, 1.0, at(behind[0], left, -1.0), 10.0);
}

/// Which decisions hold at rest shows in the motion that follows from all of them together.
#[test]
fn decisions_at_rest_agree_with_the_motion_that_follows() {
    for (text, couple) in [
        ("step(abs(max(0, 2*v)))", 1.0),
        ("1 - 3*sign(abs(2*v))", -2.0),
        ("if(max(0, v) + v > 0, 2, 1)", 2.0),
        ("1 - 5*sign(max(0, v))", 0.0),
        ("2 - step(-min(0, v))*sign(max(v, 0))", 1.0),
    ] {
        let a = couple / INERTIA;
        check(text, 0.0, 2.0, [2.0 * a, 2.0 * a], 10.0);
    }
}

/// A speed that rests where its couple ends, whichever side of that its rounding is on.
#[test]
fn a_speed_rests_on_the_switch_that_ends_its_couple() {
    let machine = wheel_under("2*abs(sign(floor(v - 1.5)))");
    for method in Method::ALL {
        for k in 0..20 {
            let options = Options::new(method, 1e-9 * 0.7_f64.powi(k));
            let y = machine.initial_state(&[0.0], &[0.0]);
            let start = OdeState { t: 0.0, y };
            let solution = solve(&machine, machine.model(), &start, 2.0, &options, &[]);
            let solution = solution.expect("a start").completed().expect("a motion");
            let [q, v] = end_state(&solution);
            assert!(
                (v - 1.5).abs() < 1e-14 && (q - 1.875).abs() < 1e-7,
                "{method:?} {k}: {q} {v}"
            );
        }
    }
}

#[test]
fn a_speed_is_released_when_the_couple_beyond_its_switch_turns() {
    // Held at 1.75 rad/s between a couple beyond that speed and one below it, until the one beyond drives on.
    let text = format!("{INERTIA}*sign(if(v >= 1.75, t - 1, 1.5))");
    check(&text, 2.0, 2.0, [4.03125, 2.75], 100.0);
    let text = format!("{INERTIA}*sign(if(v >= 1.75, q - 1, 1.5))");
    let rest = 1.75 - (1.0 - 0.46875) / 1.75;
    let end = [1.0 + (1.75 + 0.5 * rest) * rest, 1.75 + rest];
    check(&text, 2.0, 2.0, end, 100.0);
}

/// If the couple beyond a switch reverses when that on this side vanishes, both drive the speed on, by t − 0.5 s after the reversal.
#[test]
fn a_speed_is_released_where_the_couple_that_held_it_turns() {
    for beyond in ["sign(q - 0.5)", "if(q < 0.5, -1, 1)"] {
        let text = format!("{INERTIA}*if(v >= 1, {beyond}, (q - 0.5)^2)");
        check(&text, 1.0, 1.0, [1.125, 1.5], 10.0);
    }
    // Against it, on the other side.
    let text = format!("{INERTIA}*if(v <= 1, sign(0.5 - q), -(q - 0.5)^2)");
    check(&text, 1.0, 1.0, [0.875, 0.5], 10.0);
}

/// A function of an angle that leaves its threshold from rest, with the square or a higher power of the angle, has left it at once.
#[test]
fn what_an_angle_at_rest_decides_it_decides_as_it_moves() {
    let a = 1.0 / INERTIA;
    for text in [
        "floor(2*cos(q))",
        "1 + step(cos(q) - 1)",
        "2 + floor(-(q*q))",
        "1 + sign(max(0, cos(q) - 1))",
        "if(cos(q) >= 1, 2, 1)",
        "2 + sign(cos(q) - 1)",
        "0.5 - 0.5*floor(-q*q*q)",
    ] {
        check(text, 0.0, 0.2, [0.02 * a, 0.2 * a], 10.0);
    }
}

/// A function that switches exactly at the start of the motion has switched.
#[test]
fn a_switch_at_the_start_has_switched() {
    let a = 1.0 / INERTIA;
    for text in [
        "floor(min(sign(sin(6*t)), 3 + q))",
        "if(t <= 0, 5, 1)",
        "step(max(0, sign(t)) - 0.5)",
    ] {
        check(text, 1.0, 0.5, [0.5 + 0.125 * a, 1.0 + 0.5 * a], 1.0);
    }
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

/// Couples of the angle that are constant between eighths of a radian, of decisions within decisions.
fn nested() -> impl Strategy<Value = String> {
    let eighth = || (-4..=12_i32).prop_map(|k| format!("{}", f64::from(k) / 8.0));
    let leaf = prop_oneof![
        eighth().prop_map(|k| format!("step(q - {k})")),
        eighth().prop_map(|k| format!("floor(2*(q - {k}))")),
        eighth().prop_map(|k| format!("if(q < {k}, 1, 0)")),
        eighth().prop_map(|k| format!("sign(max(0, {k} - q))")),
        eighth().prop_map(|k| format!("sign(clamp(q, {k}, 2) - {k})")),
        (-1..=2_i32).prop_map(|k| k.to_string()),
    ];
    leaf.prop_recursive(4, 24, 4, |inner| {
        let compare = prop::sample::select(vec!["<", "<=", ">", ">="]);
        let function = prop::sample::select(vec!["step", "sign", "floor", "abs", "-floor"]);
        let pair = prop::sample::select(vec!["min", "max"]);
        let threshold = prop_oneof![(-1..=2_i32).prop_map(|k| k.to_string()), inner.clone()];
        prop_oneof![
            3 => (inner.clone(), compare, threshold, inner.clone(), inner.clone())
                .prop_map(|(a, c, b, d, e)| format!("if({a} {c} {b}, {d}, {e})")),
            3 => (function, inner.clone()).prop_map(|(f, a)| format!("{f}({a})")),
            2 => (pair, inner.clone(), inner.clone()).prop_map(|(f, a, b)| format!("{f}({a}, {b})")),
            1 => (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("(({a}) - ({b}))")),
            1 => (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("({a})*({b})")),
            1 => inner.prop_map(|a| format!("clamp({a}, -1, 1)")),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases.min(200), failure_persistence: None, ..ProptestConfig::default() })]

    /// The work over each eighth, whose couple is that of the law itself in its middle, gives speed and time.
    #[test]
    fn nested_decisions_do_the_work_of_the_law(law in nested(), method in 0..Method::ALL.len()) {
        let text = format!("0.1*({law})");
        let expression = Expression::parse(&text, &["q", "v", "t"]).expect("a law");
        let (mut t, mut v) = (0.0, 2.0_f64);
        for k in 0..16 {
            let couple = expression.eval(&[(f64::from(k) + 0.5) / 8.0, 0.0, 0.0]);
            let square = v * v + 2.0 * couple / INERTIA / 8.0;
            prop_assume!(square > 0.04 && square < 1e4);
            t += 0.25 / (v + square.sqrt());
            v = square.sqrt();
        }
        let machine = wheel_under(&text);
        let method = Method::ALL[method];
        let options = Options::new(method, 1e-9);
        let start = OdeState { t: 0.0, y: machine.initial_state(&[0.0], &[2.0]) };
        let solution = solve(&machine, machine.model(), &start, t, &options, &[]).expect("a start");
        let [q, speed] = end_state(&solution);
        let allowed = 10.0 * error_ratio(method) * options.rtol;
        prop_assert!((q - 2.0).abs() < allowed && (speed - v).abs() < allowed * v, "{text} {method:?}: {q} {speed} {v}");
    }
}
