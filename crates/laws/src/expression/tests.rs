use std::f64::consts::{E, PI, TAU};

use super::*;

pub(super) const NAMES: [&str; 5] = ["x", "y", "phi.speed", "my-body.angle", "omega"];

fn parse(text: &str) -> Expression {
    Expression::parse(text, &NAMES).unwrap_or_else(|error| panic!("{text}: {error}"))
}

/// With x = 2, y = 3, phi.speed = 5, my-body.angle = 7, omega = 11.
fn value(text: &str) -> f64 {
    parse(text).eval(&[2.0, 3.0, 5.0, 7.0, 11.0])
}

/// Small whole numbers: every result is exact.
#[test]
fn precedence() {
    for (text, expected) in [
        ("1 + 2*3", 7.0),
        ("(1 + 2)*3", 9.0),
        ("1 - 2 - 3", -4.0),
        ("1 - (2 - 3)", 2.0),
        ("12/3/2", 2.0),
        ("12/(3*2)", 2.0),
        ("12/3*2", 8.0),
        ("2^3^2", 512.0),
        ("(2^3)^2", 64.0),
        ("-x^2", -4.0),
        ("(-x)^2", 4.0),
        ("2^-x", 0.25),
        ("2^-x*3", 0.75),
        ("2^-1^2", 0.5),
        ("-x*y", -6.0),
        ("y*-x", -6.0),
        ("y - -x", 5.0),
        ("--x", 2.0),
        ("2*x^2", 8.0),
        ("x^2*2", 8.0),
        ("-x - y", -5.0),
        ("6/x^2", 1.5),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
}

#[test]
fn numbers_and_names() {
    for (text, expected) in [
        ("1e-3", 0.001),
        ("1.5E+2", 150.0),
        (".5", 0.5),
        ("5.", 5.0),
        ("2e3", 2000.0),
        ("\t 1\n+ 1 ", 2.0),
        ("pi", PI),
        ("tau", TAU),
        ("phi.speed", 5.0),
        ("`phi.speed`", 5.0),
        ("`my-body.angle`", 7.0),
        ("x-omega", -9.0),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
    let of = |text, name| Expression::parse(text, &[name]).map(|e| e.eval(&[4.0]));
    assert_eq!(of("2*φ₁", "φ₁"), Ok(8.0));
    assert_eq!(of("e^2", "e"), Ok(16.0));
    // A variable is not hidden by a constant or a function.
    assert_eq!(of("2*pi", "pi"), Ok(8.0));
    assert_eq!(of("sin + sin(0)", "sin"), Ok(4.0));
}

#[test]
fn functions_and_their_ties() {
    for (text, expected) in [
        ("sin(0.3)", 0.3_f64.sin()),
        ("cos(0.3)", 0.3_f64.cos()),
        ("tan(0.3)", 0.3_f64.tan()),
        ("asin(0.3)", 0.3_f64.asin()),
        ("acos(0.3)", 0.3_f64.acos()),
        ("atan(0.3)", 0.3_f64.atan()),
        ("sinh(0.3)", 0.3_f64.sinh()),
        ("cosh(0.3)", 0.3_f64.cosh()),
        ("tanh(0.3)", 0.3_f64.tanh()),
        ("exp(1)", E),
        ("ln(x)", 2_f64.ln()),
        ("log10(1000)", 3.0),
        ("sqrt(omega - x)", 3.0),
        ("abs(-x)", 2.0),
        ("sign(-x)", -1.0),
        ("sign(0)", 0.0),
        ("sign(x)", 1.0),
        ("floor(-0.5)", -1.0),
        ("step(-x)", 0.0),
        ("step(0)", 1.0),
        ("atan2(1, -1)", 0.75 * PI),
        ("hypot(3, 4)", 5.0),
        ("min(x, y)", 2.0),
        ("max(x, y)", 3.0),
        ("clamp(omega, x, y)", 3.0),
        ("clamp(-omega, x, y)", 2.0),
        ("clamp(2.5, x, y)", 2.5),
        ("if(x < y, 1, 0)", 1.0),
        ("if(x > y, 1, 0)", 0.0),
        ("if(x < 2, 1, 0)", 0.0),
        ("if(x <= 2, 1, 0)", 1.0),
        ("if(x > 2, 1, 0)", 0.0),
        ("if(x >= 2, 1, 0)", 1.0),
        // The branch that is not taken may be undefined.
        ("if(x > 0, ln(x), ln(-x))", 2_f64.ln()),
    ] {
        assert_eq!(value(text), expected, "{text}");
    }
}

#[test]
fn the_variables_that_occur() {
    let e = parse("omega*y + omega*`my-body.angle`");
    assert_eq!(e.variables(), ["omega", "y", "my-body.angle"]);
    assert!(parse("2*pi").variables().is_empty());
    assert!(e.eval(&[0.0, 1.0]).is_nan());
}

#[test]
fn what_is_not_a_number_is_not_hidden() {
    for text in [
        "min(x, 1)",
        "min(1, x)",
        "max(x, 1)",
        "max(1, x)",
        "clamp(x, 0, 1)",
        "step(x)",
        "sign(x)",
        "floor(x)",
        "abs(x)",
        "if(x < 1, 1, 2)",
        "if(1 < x, 1, 2)",
        "hypot(x, 1)",
    ] {
        let e = parse(text);
        assert!(e.eval(&[f64::NAN]).is_nan(), "{text}");
        for variable in 0..2 {
            let derivatives = e.derivatives_wrt(&[f64::NAN], variable);
            assert!(
                derivatives.iter().all(|d| d.is_nan()),
                "{text}: {derivatives:?}"
            );
        }
    }
    // Beyond its domain a function has no derivative either.
    assert!(
        parse("ln(x)")
            .derivatives_wrt(&[-1.0], 0)
            .iter()
            .all(|d| d.is_nan())
    );
}

/// Cases where derivatives are exact numbers, or defined by us.
#[test]
fn derivatives_at_special_places() {
    for (text, x, expected) in [
        ("x^2", 0.0, [0.0, 0.0, 2.0, 0.0]),
        ("x^1", 0.0, [0.0, 1.0, 0.0, 0.0]),
        ("x^3", -2.0, [-8.0, 12.0, -12.0, 6.0]),
        ("x^0", 0.0, [1.0, 0.0, 0.0, 0.0]),
        ("x^-1", -2.0, [-0.5, -0.25, -0.25, -0.375]),
        ("x^(1/2)", 4.0, [2.0, 0.25, -0.03125, 0.01171875]),
        ("sqrt(x)", 4.0, [2.0, 0.25, -0.03125, 0.01171875]),
        ("0^x", 2.0, [0.0; 4]),
        ("abs(x)", -3.0, [3.0, -1.0, 0.0, 0.0]),
        ("abs(x)", 0.0, [0.0; 4]),
        ("abs(x^2)", 0.0, [0.0, 0.0, 2.0, 0.0]),
        ("abs(-x^2 + x^3)", 0.0, [0.0, 0.0, 2.0, -6.0]),
        ("abs(x^3)", 0.0, [0.0; 4]),
        ("max(x, 0)", 0.0, [0.0, 1.0, 0.0, 0.0]),
        ("max(0, x)", 0.0, [0.0; 4]),
        ("min(x, x^2)", 3.0, [3.0, 1.0, 0.0, 0.0]),
        ("floor(x)*x", 2.5, [5.0, 2.0, 0.0, 0.0]),
        ("step(x)*x", 0.0, [0.0, 1.0, 0.0, 0.0]),
        ("sign(x)*x", -2.0, [2.0, -1.0, 0.0, 0.0]),
        ("clamp(x, -1, 1)", 2.0, [1.0, 0.0, 0.0, 0.0]),
        ("if(x < 0, -x, x^2)", 3.0, [9.0, 6.0, 2.0, 0.0]),
        // The root of a constant zero has derivatives, although the root has none there.
        ("sqrt(0) + x", 1.0, [1.0, 1.0, 0.0, 0.0]),
        ("sqrt(max(0, x))", -1.0, [0.0; 4]),
        ("hypot(x, 0)", -2.0, [2.0, -1.0, 0.0, 0.0]),
        ("hypot(1e200*x, 0)", 1.0, [1e200, 1e200, 0.0, 0.0]),
        ("atan2(x, 1)", 0.0, [0.0, 1.0, 0.0, -2.0]),
        ("atan2(1e200*x, 1e200)", 0.0, [0.0, 1.0, 0.0, -2.0]),
    ] {
        assert_eq!(
            parse(text).derivatives_wrt(&[x], 0),
            expected,
            "{text} at {x}"
        );
    }
    // And where derivatives do not exist, none are invented.
    for text in ["sqrt(x^4)", "hypot(x, x)", "atan2(x, x)", "sqrt(abs(x))"] {
        assert!(parse(text).derivatives_wrt(&[0.0], 0)[2].is_nan(), "{text}");
    }
    assert_eq!(
        parse("sqrt(x)").derivatives_wrt(&[0.0], 0)[1],
        f64::INFINITY
    );
    // Partial derivatives; and with respect to a variable that does not occur.
    let e = parse("x^2*y");
    assert_eq!(e.derivatives_wrt(&[3.0, 5.0], 0), [45.0, 30.0, 10.0, 0.0]);
    assert_eq!(e.derivatives_wrt(&[3.0, 5.0], 1), [45.0, 9.0, 0.0, 0.0]);
    assert_eq!(e.derivatives_wrt(&[3.0, 5.0], 9), [45.0, 0.0, 0.0, 0.0]);
}

/// Every error: its span, its message, its help.
#[test]
fn errors() {
    // Text, span of what is wrong, message, part of the help (empty: whatever).
    for (text, span, message, help) in [
        ("", 0..0, "the expression is empty", ""),
        ("  \n", 0..3, "the expression is empty", ""),
        (
            "12 - 0.5*omga",
            9..13,
            "unknown name `omga`",
            "did you mean `omega`?",
        ),
        (
            "q",
            0..1,
            "unknown name `q`",
            "the names are `x`, `y`, `phi.speed`",
        ),
        ("2*e", 2..3, "unknown name `e`", "`exp(1)`"),
        (
            "1 + `my-bdy.angle`",
            4..18,
            "unknown name `my-bdy.angle`",
            "did you mean `my-body.angle`?",
        ),
        (
            "2*my-body.angle",
            2..4,
            "unknown name `my`",
            "did you mean \"my-body.angle\"? It is written between two backticks",
        ),
        ("``", 0..2, "unknown name ``", "the names are"),
        ("sin x", 0..3, "unknown name `sin`", "`sin(…)`"),
        (
            "sine(x)",
            0..4,
            "unknown function `sine`",
            "did you mean `sin`?",
        ),
        ("log(x)", 0..3, "unknown function `log`", "`ln` or `log10`"),
        (
            "arcsin(x)",
            0..6,
            "unknown function `arcsin`",
            "did you mean `asin`?",
        ),
        (
            "integral(x)",
            0..8,
            "unknown function `integral`",
            "the functions are `sin`",
        ),
        ("3*x(1 + y)", 2..3, "`x` is not a function", "`x*(…)`"),
        ("1 + sin(x, y)", 4..13, "`sin` takes 1 argument, not 2", ""),
        ("atan2(x)", 0..8, "`atan2` takes 2 arguments, not 1", ""),
        ("clamp()", 0..7, "`clamp` takes 3 arguments, not 0", ""),
        ("if(x < y, 1)", 0..12, "`if` takes 3 arguments, not 2", ""),
        (
            "if(x, 1, 2)",
            3..4,
            "the first argument of `if` is a comparison",
            "if(x > 0",
        ),
        (
            "if(x < 1 < 2, 1, 2)",
            9..10,
            "`<` stands only in the first argument of `if`, once",
            "",
        ),
        (
            "x >= y",
            2..4,
            "`>=` stands only in the first argument of `if`, once",
            "",
        ),
        ("x*", 1..2, "there is no operand after `*`", ""),
        ("x*)", 1..2, "there is no operand after `*`", ""),
        ("x**2", 1..2, "there is no operand after `*`", "`x^2`"),
        ("-", 0..1, "there is no operand after `-`", ""),
        ("max(x, )", 5..6, "there is no operand after `,`", ""),
        ("*x", 0..1, "there is no operand before `*`", ""),
        ("1 + (*x)", 5..6, "there is no operand before `*`", ""),
        ("if(x < , 1, 2)", 5..6, "there is no operand after `<`", ""),
        ("()", 0..2, "there is nothing between the parentheses", ""),
        ("2*(x + 1", 2..3, "this parenthesis is not closed", ""),
        ("sin(x", 3..4, "this parenthesis is not closed", ""),
        ("(", 0..1, "this parenthesis is not closed", ""),
        ("(x + 1))", 7..8, "this parenthesis closes nothing", ""),
        (")", 0..1, "this parenthesis closes nothing", ""),
        (
            "1,5*x",
            1..2,
            "a comma stands only between the arguments of a function",
            "the decimal sign is a point",
        ),
        ("2x", 1..2, "there is no operator before `x`", "`a*b`"),
        ("2e", 1..2, "there is no operator before `e`", ""),
        ("2e+", 1..2, "there is no operator before `e`", ""),
        ("x y", 2..3, "there is no operator before `y`", ""),
        ("2 (x)", 2..3, "there is no operator before `(`", ""),
        ("1.2.3", 3..5, "there is no operator before `.3`", ""),
        ("x`y`", 1..4, "there is no operator before ``y``", ""),
        ("x − 1", 2..5, "unexpected character '−'", "write `-`"),
        (
            "x == 1",
            2..3,
            "unexpected character '='",
            "the comparisons are",
        ),
        ("x $ 1", 2..3, "unexpected character '$'", ""),
        ("'x'", 0..1, "unexpected character '\\''", "backticks"),
        (".", 0..1, "unexpected character '.'", ""),
        (
            "x + `y",
            4..5,
            "this backtick begins a name that has no end",
            "two backticks",
        ),
        ("x + 1e999", 4..9, "this number is too large", ""),
        ("x + (1/0)", 5..8, "`1/0` is infinite", ""),
        ("x*ln(2 - 3)", 2..11, "`ln(2 - 3)` is not a number", ""),
        ("1e308*10 + x", 0..8, "`1e308*10` is infinite", ""),
    ] {
        let error = Expression::parse(text, &NAMES).expect_err(text);
        assert_eq!(error.message, message, "{text}");
        assert_eq!(error.span, span, "{text}");
        let advice = error.help.clone().unwrap_or_default();
        assert!(advice.contains(help), "{text}: {advice}");
    }
}

/// Nesting is bounded before it can exhaust a stack, whatever nests; length is not.
#[test]
fn deep_and_long() {
    let many = 100_000;
    for (deep, start) in [
        ("(".repeat(many), 64),
        ("-".repeat(many) + "x", 64),
        ("2^".repeat(many) + "x", 64),
        ("sin(".repeat(many), 4 * 64),
        ("if(x<1,1,".repeat(many), 0),
    ] {
        let error = Expression::parse(&deep, &NAMES).expect_err("too deep");
        assert!(error.message.starts_with("too deep"), "{}", error.message);
        assert!(start == 0 || error.span.start <= start, "{:?}", error.span);
    }
    // Few parentheses, but many intermediate results: 1 + (2 + (3 + …
    let waiting = |n: usize| "x + (".repeat(n) + "x" + &")".repeat(n);
    assert!(Expression::parse(&waiting(31), &NAMES).is_ok());
    let error = Expression::parse(&waiting(32), &NAMES).expect_err("too deep");
    assert!(error.message.starts_with("too deep"));
    assert_eq!(error.span, 32 * 5..32 * 5 + 1);

    let long = "x + ".repeat(many) + "x";
    let expression = parse(&long);
    assert_eq!(expression.eval(&[1.0]), 100_001.0);
}
