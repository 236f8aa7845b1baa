//! Loads that switch, pulse and jump in time, on a wheel: its speed is the impulse over its inertia, its angle the
//! impulse's moment, both by hand. The wheel starts from rest or in motion.
#![allow(clippy::expect_used, reason = "tests")]

mod parts;

use dwell_dynamics::{DynamicsError, Machine, Method, OdeState, Options, Solution, solve};
use dwell_kinetostatics::{Magnitude, Signal};
use dwell_laws::{Expression, Interpolation, Law, Spline};
use parts::{INERTIA, end_state, error_ratio};
use proptest::prelude::*;

fn wheel(magnitude: Magnitude) -> Machine {
    parts::wheel(magnitude, &[])
}

fn expression(text: &str) -> Magnitude {
    let expression = Expression::parse(text, &["t"]).expect(text);
    Magnitude::Expression(expression, vec![Signal::Time])
}

fn run(machine: &Machine, speed: f64, end: f64, options: &Options) -> Solution {
    let start = OdeState {
        t: 0.0,
        y: machine.initial_state(&[0.0], &[speed]),
    };
    solve(machine, machine.model(), &start, end, options, &[]).expect("a start")
}

/// A pulse of unit impulse about a time: its magnitude, from its width.
fn pulse(shape: usize, at: f64, width: f64) -> String {
    match shape {
        0 => format!("if(abs(t - {at}) < {}, {}, 0)", 0.5 * width, 1.0 / width),
        1 => format!("max(0, 1 - abs(t - {at})/{width})/{width}"),
        // A tenth as wide, so that nothing of it lies beyond the motion.
        2 => format!(
            "{}*exp(-((t - {at})/{})^2)",
            10.0 / (width * std::f64::consts::PI.sqrt()),
            0.1 * width
        ),
        _ => format!(
            "(step(t - {}) - step(t - {}))/{width}",
            at - 0.5 * width,
            at + 0.5 * width
        ),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases.max(400), failure_persistence: None, ..ProptestConfig::default() })]

    /// No pulse is missed by any method at any tolerance, however narrow, and its effect is that of its impulse.
    #[test]
    fn every_pulse_is_seen(
        shape in 0..4_usize,
        exponent in -6.0..-1.0_f64,
        place in 0.2..0.8_f64,
        span in prop::sample::select(vec![1.0, 30.0, 1000.0]),
        speed in prop::sample::select(vec![0.0, 0.7]),
        method in 0..5_usize,
        tolerance in -10.0..-4.0_f64,
    ) {
        let (width, at) = (span * 10_f64.powf(exponent), span * place);
        let machine = wheel(expression(&pulse(shape, at, width)));
        let options = Options::new(Method::ALL[method], 10_f64.powf(tolerance));
        let [q, q_dot] = end_state(&run(&machine, speed, span, &options));
        let expected = speed + 1.0 / INERTIA;
        let angle = speed * span + (span - at) / INERTIA;
        // Time has a rounding of its own, which moves the ends of a pulse.
        let rounding = 160.0 * f64::EPSILON * span / width;
        let allowed = error_ratio(options.method) * options.rtol + rounding;
        prop_assert!((q_dot - expected).abs() < allowed, "{} {q_dot} {expected}", (q_dot - expected) / options.rtol);
        prop_assert!((q - angle).abs() < allowed * span.max(1.0), "{q} {angle}");
    }

    /// A table of time is followed through all its points: the impulse is the area below it.
    #[test]
    fn tables_are_followed_through_all_their_points(
        at in 1.0..9.0_f64,
        width in 1e-4..0.5_f64,
        kind in 0..4_usize,
        method in 0..5_usize,
    ) {
        let (_, interpolation) = Interpolation::ALL[kind];
        let points = [[0.0, 0.0], [at - width, 0.0], [at, 1.0], [at + width, 0.0], [10.0, 0.0]];
        let curve = Spline::interpolating(&points, interpolation).expect("a curve");
        // Simpson's rule is exact for cubic pieces; of steps the left value counts.
        let area: f64 = points.windows(2).map(|p| {
            let [a, b] = [p[0][0], p[1][0]];
            let [f, g] = [curve.eval(a)[0], curve.eval(b - 1e-12 * b)[0]];
            (b - a) * (f + 4.0 * curve.eval(0.5 * (a + b))[0] + g) / 6.0
        }).sum();
        let machine = wheel(Magnitude::Law(Signal::Time, Law::Spline(curve)));
        let options = Options::new(Method::ALL[method], 1e-8);
        let [_, q_dot] = end_state(&run(&machine, 0.0, 10.0, &options));
        prop_assert!(
            (q_dot - area / INERTIA).abs() < error_ratio(options.method) * options.rtol * area.abs().max(1.0), "{q_dot} {}", area / INERTIA);
    }
}

/// At a switch the order of the method is kept: the error is that of the same method restarted by hand there.
#[test]
fn the_error_is_that_of_restarts_by_hand() {
    let text = "if(t < 0.7, 3, -5 + 2*t)";
    let machine = wheel(expression(text));
    for method in Method::ALL {
        for exponent in [-4, -7, -10] {
            let options = Options::new(method, 10_f64.powi(exponent));
            let whole = end_state(&run(&machine, 0.0, 2.0, &options));
            let mut at = OdeState {
                t: 0.0,
                y: machine.initial_state(&[0.0], &[0.0]),
            };
            for (part, end) in [("3", 0.7), ("-5 + 2*t", 2.0)] {
                let machine = wheel(expression(part));
                let part = solve(&machine, machine.model(), &at, end, &options, &[]);
                at = part.expect("a start").steps.last().expect("steps").clone();
            }
            let speed = (3.0 * 0.7 - 5.0 * 1.3 + (4.0 - 0.49)) / INERTIA;
            let [one, two] = [whole[1], at.y[1]].map(|v: f64| (v - speed).abs());
            assert!(
                one <= 10.0 * two + 1e-14,
                "{method:?} {exponent}: {one:e} {two:e}"
            );
        }
    }
}

/// A load that varies too fast for the limit on steps is rejected with its place, and followed if the longest step is
/// given.
#[test]
fn what_varies_too_fast_is_refused() {
    let machine = wheel(expression("sin(1e6*t)"));
    let options = Options::new(Method::Dop853, 1e-6);
    let start = OdeState {
        t: 0.0,
        y: machine.initial_state(&[0.0], &[0.0]),
    };
    let refused = solve(&machine, machine.model(), &start, 1000.0, &options, &[]);
    assert!(
        matches!(
            refused,
            Err(DynamicsError::VariesTooFast {
                source_index: 0,
                ..
            })
        ),
        "{refused:?}"
    );
    // With the longest step given it is integrated as far as the steps reach.
    let options = Options {
        max_step: Some(1.0),
        max_steps: 1000,
        ..options
    };
    let solution = solve(&machine, machine.model(), &start, 1000.0, &options, &[]);
    assert!(solution.expect("a start").steps.len() > 1);
}
