//! Every switch is located to rounding, and every piece between switches is as smooth as stated.

use super::*;
use proptest::prelude::*;

fn features(text: &str) -> Features {
    let mut features = Features::default();
    let expression = Expression::parse(text, &["x", "t"]).expect(text);
    features.add_expression(7, &expression, 1);
    features
}

fn switches(text: &str, from: f64, to: f64) -> Vec<f64> {
    let features = features(text);
    let pieces = features.scan(from, to).map(|piece| piece.expect(text));
    let restarts = pieces.filter(|piece| piece.restart);
    restarts.map(|piece| piece.to).collect()
}

#[test]
fn switches_are_where_they_are_by_hand() {
    for (text, from, to, expected) in [
        ("if(t > 0.7, 5, 0)", 0.0, 10.0, vec![0.7]),
        ("if(t > 0.7, 5, 0)*x", 0.0, 10.0, vec![0.7]),
        ("if(x > 0.7, 5, 0)*t", 0.0, 10.0, vec![]),
        ("abs(t - 2) + min(t, 3)", 0.0, 10.0, vec![2.0, 3.0]),
        ("sign(sin(pi*t))", 0.5, 4.5, vec![1.0, 2.0, 3.0, 4.0]),
        ("floor(2*t)", 0.1, 2.0, vec![0.5, 1.0, 1.5]),
        ("step(t - 1e-3)", 0.0, 1e5, vec![1e-3]),
        ("clamp(t, 1, 2)", 0.0, 3.0, vec![1.0, 2.0]),
        ("clamp(-t, -2, -1)*x", 0.0, 3.0, vec![1.0, 2.0]),
        // A pulse of a microsecond in a day.
        (
            "if(abs(t - 50000) < 5e-7, 1, 0)",
            0.0,
            86400.0,
            vec![50000.0 - 5e-7, 50000.0, 50000.0 + 5e-7],
        ),
        // Nested: the inner switch decides where the outer one is.
        (
            "if(if(t < 2, t, 5 - t) > 1, 1, 0)",
            0.0,
            10.0,
            vec![1.0, 2.0, 4.0],
        ),
        (
            "if(t - floor(t) < 0.25, 1, 0)",
            0.1,
            2.1,
            vec![0.25, 1.0, 1.25, 2.0],
        ),
        (
            "atan2(sin(t), cos(t))",
            0.0,
            6.0,
            vec![std::f64::consts::PI],
        ),
        ("min(t, t)", 0.0, 3.0, vec![]),
        ("abs(t^2)", 1.0, 3.0, vec![]),
    ] {
        let found = switches(text, from, to);
        assert_eq!(found.len(), expected.len(), "{text}: {found:?}");
        for (a, b) in found.iter().zip(&expected) {
            // A few roundings of the time, and of what is compared.
            assert!((a - b).abs() <= 16.0 * f64::EPSILON * to, "{text}: {a} {b}");
        }
    }
}

/// No function switches within a piece: the values at both ends, and close to them, are on the same side.
#[test]
fn a_piece_ends_before_the_switch_and_the_next_begins_behind_it() {
    let text = "if(sin(20*t) > 0.3, 1, 0) + step(cos(7*t)) + sign(t - 1)";
    let expression = Expression::parse(text, &["x", "t"]).expect(text);
    let features = features(text);
    let pieces: Vec<Piece> = features.scan(0.0, 5.0).map(|p| p.expect(text)).collect();
    let mut changes = 0;
    for pair in pieces.windows(2) {
        let value = |t: f64| expression.eval(&[0.0, t]);
        let [before, behind] = [pair[0].to, pair[1].from];
        assert!(behind - before < 1e-14, "{before} {behind}");
        assert_eq!(value(pair[0].from), value(before));
        assert_eq!(value(0.5 * (pair[0].from + before)), value(before));
        assert_eq!(pair[0].restart, value(before) != value(behind));
        changes += usize::from(pair[0].restart);
    }
    // sin(20 t) = 0.3 twice in each of 16 periods (100 rad), cos(7 t) = 0 at 11 places, and t = 1.
    assert_eq!(changes, 32 + 11 + 1);
}

/// A narrow bell: the pieces on it are as narrow as it is, those far from it are not; and it costs little.
#[test]
fn narrow_smooth_features_are_resolved() {
    for width in [0.1, 1e-4, 1e-9] {
        let text = format!("100*sin(t) + 1e-3*exp(-((t - 200)/{width})^2)");
        let features = features(&text);
        let pieces: Vec<Piece> = features
            .scan(0.0, 300.0)
            .map(|p| p.expect("pieces"))
            .collect();
        let on = pieces.iter().filter(|p| (p.from - 200.0).abs() < width);
        let narrow: Vec<f64> = on.map(|p| p.width / width).collect();
        assert!(
            narrow.len() > 5 && narrow.iter().all(|w| *w < 0.5),
            "{narrow:?}"
        );
        let far = pieces.iter().filter(|p| (p.from - 200.0).abs() > 1.0);
        assert!(far.map(|p| p.width).fold(f64::INFINITY, f64::min) > 0.01);
        assert!(pieces.len() < 6000, "{}", pieces.len());
    }
}

/// A step of a logistic function, whose exponential overflows on one side.
#[test]
fn steep_steps_are_resolved() {
    let features = features("4/(1 + exp(-(t - 0.7)/1e-4))");
    let pieces = features.scan(0.0, 3.0);
    let pieces: Vec<Piece> = pieces.map(|p| p.expect("pieces")).collect();
    let on = pieces.iter().filter(|p| (p.from - 0.7).abs() < 1e-4);
    let narrow: Vec<f64> = on.map(|p| p.width).collect();
    assert!(
        narrow.len() > 3 && narrow.iter().all(|w| *w < 1e-4),
        "{narrow:?}"
    );
    assert!(pieces.len() < 300, "{}", pieces.len());
}

#[test]
fn laws_end_their_pieces_at_their_corners() {
    let rise = crate::Rise {
        start: 0.0,
        rise: 1.0,
        duration: 2.0,
        delay: 3.0,
    };
    let shape = crate::Shape::Trapezoidal { ramp: 0.5 };
    let mut features = Features::default();
    features.add_law(
        0,
        &Law::Profile(crate::Profile::new(shape, rise).expect("a profile")),
    );
    let pieces: Vec<Piece> = features
        .scan(0.0, 10.0)
        .map(|p| p.expect("pieces"))
        .collect();
    let ends: Vec<f64> = pieces.iter().filter(|p| p.restart).map(|p| p.to).collect();
    assert_eq!(ends.len(), 4);
    for (end, corner) in ends.iter().zip([3.0, 3.5, 4.5, 5.0]) {
        assert!((end - corner).abs() < 1e-14);
    }
    assert_eq!(pieces[1].width, 0.25);
    assert_eq!(pieces[4].width, pieces[4].to - pieces[4].from);
}

/// Functions of time that are constant between eighths of a second, of decisions within decisions.
fn nested() -> impl Strategy<Value = String> {
    let eighth = || (0..=16_i32).prop_map(|k| format!("{}", f64::from(k) / 8.0));
    let leaf = prop_oneof![
        eighth().prop_map(|k| format!("step(t - {k})")),
        eighth().prop_map(|k| format!("floor(2*(t - {k}))")),
        eighth().prop_map(|k| format!("sign(max(0, {k} - t))")),
        eighth().prop_map(|k| format!("sign(abs(t - {k}) - (t - {k}))")),
        (-1..=2_i32).prop_map(|k| format!("({k} + 0*t)")),
    ];
    leaf.prop_recursive(4, 24, 4, |inner| {
        let compare = prop::sample::select(vec!["<", "<=", ">", ">="]);
        let function = prop::sample::select(vec!["step", "sign", "floor", "abs", "-floor"]);
        let pair = prop::sample::select(vec!["min", "max"]);
        let three = (inner.clone(), inner.clone(), inner.clone());
        prop_oneof![
            3 => (three, compare, -1..=2_i32)
                .prop_map(|((a, d, e), c, b)| format!("if({a} {c} {b}, {d}, {e})")),
            3 => (function, inner.clone()).prop_map(|(f, a)| format!("{f}({a})")),
            2 => (pair, inner.clone(), inner.clone()).prop_map(|(f, a, b)| format!("{f}({a}, {b})")),
            1 => (inner.clone(), inner.clone()).prop_map(|(a, b)| format!("({a} - ({b}))")),
            1 => inner.prop_map(|a| format!("clamp({a}, -1, 1)")),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

    /// A function that rests on its threshold is decided, not searched: few pieces, and a restart wherever the value jumps.
    #[test]
    fn decisions_within_decisions_are_located(text in nested()) {
        let expression = Expression::parse(&text, &["t"]).expect("a law");
        let mut features = Features::default();
        features.add_expression(0, &expression, 0);
        let pieces: Vec<Piece> = features.scan_switches(0.0, 2.0).take(500).map_while(Result::ok).collect();
        prop_assert!(features.is_empty() || pieces.len() < 400, "{text}: {} pieces", pieces.len());
        let value = |k: i32| expression.eval(&[(f64::from(k) + 0.5) / 8.0]);
        for k in 1..16 {
            let at = f64::from(k) / 8.0;
            let restarts = pieces.iter().any(|piece| piece.restart && (piece.to - at).abs() < 1e-12);
            prop_assert!(value(k) == value(k - 1) || restarts, "{text} at {at}");
        }
    }
}

/// Pieces that agree within rounding, tails that underflow, and branches that are not taken need no search.
#[test]
fn what_a_rounding_decides_is_not_searched() {
    let touching = "floor(2 - cos(2*t)) + floor(max(t - 0.25, t*t))";
    for (text, most) in [
        ("floor(-floor(-min(sin(4*t), 4*t)))", 100),
        (
            "if(x > 0, x, clamp(1e3*exp(-((t - 0.6)/1e-5)^2)*floor(2 - t), 0, 2))",
            600,
        ),
        (
            "if(t > -1, abs(t - 1), if(1e3*exp(-(t/1e-6)^2) >= 0, t, 1))",
            100,
        ),
        ("if(t <= 0, 1, floor(1 + cos(2*t)))", 200),
        (touching, 200),
        ("floor(-59.1*exp(-((t - 0.25)/0.01)^2))", 600),
    ] {
        for to in [1e-9, 2.0] {
            let features = features(text);
            let count = features
                .scan(0.0, to)
                .take(1000)
                .filter(Result::is_ok)
                .count();
            assert!(count <= most, "{text}: {count} pieces up to {to}");
        }
    }
}

/// What switches exactly at the start has switched in the first piece.
#[test]
fn the_first_piece_begins_behind_a_switch() {
    for (text, from) in [
        ("sign(sin(6*t))", 0.0),
        ("if(t <= 0.25, 1, 0)", 0.25),
        ("sign(exp(t) - 1)", 0.0),
    ] {
        let expression = Expression::parse(text, &["x", "t"]).expect(text);
        let first = features(text)
            .scan(from, 2.0)
            .next()
            .expect(text)
            .expect(text);
        assert!(
            first.from > from && first.from - from < 1e-14,
            "{text}: {first:?}"
        );
        let value = |t: f64| expression.eval(&[0.0, t]);
        assert_eq!(value(first.from), value(from + 0.01), "{text}");
    }
}
