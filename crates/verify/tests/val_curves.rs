//! The V-curves have the slopes and the tips that the theory of differences gives them.

#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test")]

mod subjects;

use dwell_verify::{CheckContext, ErrorCurve, half_dm_curve, reaction_curve};
use subjects::mechanisms::{inverted_slider_crank, single_dwell};

fn lowest(curve: &[(f64, f64)]) -> (f64, f64) {
    let lower = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
    *curve.iter().min_by(lower).unwrap()
}

/// The error at the step nearest to `h`.
fn at(curve: &[(f64, f64)], h: f64) -> f64 {
    let distance = |p: &&(f64, f64)| (p.0 / h).ln().abs();
    curve
        .iter()
        .min_by(|a, b| distance(a).total_cmp(&distance(b)))
        .unwrap()
        .1
}

fn assert_v(curve: &ErrorCurve) {
    let orders = [&curve.second_order, &curve.fourth_order, &curve.sixth_order];
    let tips = orders.map(|o| lowest(o));
    println!("{} at q = {}: tips {tips:?}", curve.quantity, curve.q);
    // Down to 1e-13 rad, where nothing but rounding is left.
    for order in orders {
        assert_eq!(order.len(), 49);
        assert!((order[48].0 - 1e-13).abs() < 1e-25);
        assert!(at(order, 1e-13) > 1e-5);
    }
    // Downwards a decade of h is a hundred, ten thousand of error.
    let second = at(orders[0], 1e-2) / at(orders[0], 1e-3);
    assert!((50.0..200.0).contains(&second), "{second}");
    let fourth = at(orders[1], 3.16e-2) / at(orders[1], 3.16e-3);
    assert!((2e3..5e4).contains(&fourth), "{fourth}");
    // A plain difference gives about two thirds of the digits, a higher order more.
    assert!((1e-13..1e-8).contains(&tips[0].1), "{tips:?}");
    assert!(tips[0].0 < 1e-3 && tips[2].0 > 1e-3, "{tips:?}");
    assert!(tips[2].1 < 1e-11, "{tips:?}");
}

#[test]
fn val_error_against_step() {
    let setup = single_dwell();
    let (mut case, subject) = (setup.case(0), setup.subject());
    case.positions = vec![1.0, 5.8];
    let context = CheckContext::new(&case, &subject).unwrap();
    assert_v(&half_dm_curve(&context, &context.positions[1]).unwrap());
    // slide.normal
    assert_v(&reaction_curve(&context, &context.positions[1], 10).unwrap());
    assert!(reaction_curve(&context, &context.positions[0], 14).is_none());

    let setup = inverted_slider_crank();
    let (mut case, subject) = (setup.case(0), setup.subject());
    case.positions = vec![4.2];
    let context = CheckContext::new(&case, &subject).unwrap();
    // slot.moment: the released row is an angle.
    assert_v(&reaction_curve(&context, &context.positions[0], 3).unwrap());
}
