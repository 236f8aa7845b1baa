//! Properties of every expression, and of every text.

use proptest::prelude::*;

use super::Expression;
use super::function::Function;
use super::tests::NAMES;

/// Any expression of the language, as text.
fn any_text() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        (0..NAMES.len()).prop_map(|i| format!("`{}`", NAMES[i])),
        Just("pi".to_owned()),
        (1e-9..1e9).prop_map(|n: f64| n.to_string()),
        (0.0..1.0).prop_map(|n: f64| format!("{:e}", n * 1e-200)),
    ];
    leaf.prop_recursive(6, 60, 4, |inner| {
        let binary = (inner.clone(), 0..5_usize, inner.clone());
        let compare = prop::sample::select(vec!["<", "<=", ">", ">="]);
        prop_oneof![
            4 => binary.prop_map(|(a, i, b)| format!("({a}){}({b})", ["+", "-", "*", "/", "^"][i])),
            1 => inner.clone().prop_map(|a| format!("-({a})")),
            1 => (0..17_usize, inner.clone())
                .prop_map(|(i, a)| format!("{}({a})", Function::ALL[i].0)),
            1 => (17..21_usize, inner.clone(), inner.clone())
                .prop_map(|(i, a, b)| format!("{}({a}, {b})", Function::ALL[i].0)),
            1 => (inner.clone(), inner.clone(), inner.clone())
                .prop_map(|(a, b, c)| format!("clamp({a}, {b}, {c})")),
            1 => (inner.clone(), compare, inner.clone(), inner.clone(), inner)
                .prop_map(|(a, c, b, d, e)| format!("if({a} {c} {b}, {d}, {e})")),
        ]
    })
}

/// An expression of x and y that is smooth, and of moderate derivatives, for |x|, |y| < 1.
fn smooth_text() -> impl Strategy<Value = String> {
    let leaf = prop_oneof![
        3 => Just("x".to_owned()),
        1 => Just("y".to_owned()),
        1 => (0.1..2.0).prop_map(|n: f64| format!("{n:.2}")),
    ];
    leaf.prop_recursive(3, 12, 2, |inner| {
        let templates = vec![
            "sin(A)",
            "cos(A)",
            "tan(0.5*sin(A))",
            "asin(0.6*sin(A))",
            "acos(0.6*cos(A))",
            "atan(A)",
            "sinh(sin(A))",
            "cosh(sin(A))",
            "tanh(A)",
            "exp(sin(A))",
            "ln(2 + sin(A))",
            "log10(2 + cos(A))",
            "sqrt(1.5 + sin(A))",
            "abs(sin(A) - 2)",
            "(A)^2",
            "sin(A)^3",
            "(1.5 + sin(A))^-2",
            "(1.5 + sin(A))^1.7",
            "-(A)",
        ];
        let pairs = vec![
            "A + (B)",
            "A - (B)",
            "(A)*(B)",
            "(A)/(2 + cos(B))",
            "(1.5 + sin(A))^sin(B)",
            "atan2(A, 2 + sin(B))",
            "atan2(sin(A), -2 - sin(B))",
            "hypot(A, 1 + sin(B)^2)",
            "min(sin(A), 3 + sin(B))",
            "max(A, -1e9)",
            "clamp(sin(A), -2, 2)",
            "if(sin(A) < 2, B, A)",
            "2^sin(A)",
        ];
        prop_oneof![
            (prop::sample::select(templates), inner.clone()).prop_map(|(t, a)| t.replace('A', &a)),
            (prop::sample::select(pairs), inner.clone(), inner)
                .prop_map(|(t, a, b)| t.replace('A', "\0").replace('B', &b).replace('\0', &a)),
        ]
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: ProptestConfig::default().cases.max(1000), failure_persistence: None, ..ProptestConfig::default() })]

    /// The only errors are parts without variables that overflow or are undefined.
    #[test]
    fn every_text_of_the_language_is_parsed(text in any_text()) {
        if let Err(error) = Expression::parse(&text, &NAMES) {
            prop_assert!(
                error.message.ends_with(" is infinite") || error.message.ends_with(" is not a number"),
                "{}: {}", text, error
            );
        }
    }

    /// Without the variables that do not occur, value and derivatives are the same.
    #[test]
    fn variables_that_do_not_occur_can_be_left_out(text in any_text(), x in -3.0..3.0, y in -3.0..3.0) {
        if let Ok(expression) = Expression::parse(&text, &NAMES) {
            let values = [x, y, 0.0, -1.5, 2.0];
            let reduced = expression.clone().retain_used();
            let position = |name: &String| NAMES.iter().position(|n| n == name).unwrap_or(NAMES.len());
            let used: Vec<_> = reduced.variables().iter().map(position).collect();
            let used_values: Vec<_> = used.iter().map(|&i| values[i]).collect();
            prop_assert_eq!(reduced.eval(&used_values).to_bits(), expression.eval(&values).to_bits());
            for (k, &i) in used.iter().enumerate() {
                let [reduced, all] = [reduced.derivatives_wrt(&used_values, k), expression.derivatives_wrt(&values, i)];
                prop_assert_eq!(reduced.map(f64::to_bits), all.map(f64::to_bits));
            }
        }
    }

    /// The value of a jet equals that of the `f64` evaluation bit for bit.
    #[test]
    fn jets_carry_the_plain_value(text in any_text(), x in -3.0..3.0, y in -3.0..3.0) {
        if let Ok(expression) = Expression::parse(&text, &NAMES) {
            let values = [x, y, 0.0, -1.5, 2.0];
            let value_alone = expression.eval(&values);
            for variable in 0..NAMES.len() {
                let derivatives = expression.derivatives_wrt(&values, variable);
                prop_assert!(
                    derivatives[0].to_bits() == value_alone.to_bits() || (derivatives[0].is_nan() && value_alone.is_nan()),
                    "{} {:?}", value_alone, derivatives
                );
            }
        }
    }

    /// Each derivative against differences of the one before it, of eighth order with two steps:
    /// what these differ by bounds the truncation (the larger step's is 256 times the smaller's),
    /// and 1e-15 of the largest value over the step, ten times, the rounding.
    #[test]
    fn derivatives_are_those_of_differences(text in smooth_text(), x in -1.0..1.0, y in -1.0..1.0) {
        let expression = Expression::parse(&text, &NAMES).expect("a smooth expression");
        let exact = expression.derivatives_wrt(&[x, y], 0);
        for k in 0..3 {
            let mut largest = 0.0_f64;
            let mut difference = |h: f64| {
                let mut at = |n: f64| {
                    let value = expression.derivatives_wrt(&[x + n * h, y], 0)[k];
                    largest = largest.max(value.abs());
                    value
                };
                let mut d = |n: f64| at(n) - at(-n);
                (672.0 * d(1.0) - 168.0 * d(2.0) + 32.0 * d(3.0) - 3.0 * d(4.0)) / (840.0 * h)
            };
            let [coarse, fine] = [difference(4e-3), difference(2e-3)];
            let rounding = 1e-14 * largest.max(1.0) / 2e-3;
            let error_bound = (coarse - fine).abs() + rounding;
            // Differences may be inconclusive in few cases only.
            prop_assume!(error_bound < 1e-6 * (1.0 + exact[k + 1].abs()));
            prop_assert!(
                (fine - exact[k + 1]).abs() <= error_bound,
                "{}: derivative {}: {} {} (±{:e})", text, k + 1, exact[k + 1], fine, error_bound
            );
        }
    }

    /// No text makes the parser panic, and every span can be cut out of its text.
    #[test]
    fn no_text_is_too_strange(text in any::<String>(), signs in "[-+*/^(),<>=`'.0-9eExypi \u{2212}\u{3c6}\n]{0,40}") {
        for text in [text, signs] {
            match Expression::parse(&text, &NAMES) {
                Ok(expression) => {
                    expression.derivatives_wrt(&[1.0; 5], 0);
                }
                Err(error) => {
                    let cut = text.get(error.span.clone());
                    prop_assert!(cut.is_some_and(|c| !c.is_empty() || text.is_empty()), "{:?}", error);
                }
            }
        }
    }
}
