//! The code that `symbolic` writes, run line by line by the small reader of expressions.

use super::difference::Differences;
use super::expression::Expression;
use super::rows::{Rows, largest};
use std::collections::HashMap;

/// The assignments of generated Rust, Python or C, in their order.
pub(crate) fn assignments(code: &str) -> Vec<(String, Expression)> {
    let assignment = |line: &str| {
        let line = line.trim();
        let line = line.strip_prefix("const double ").unwrap_or(line);
        let line = line.split(['#', ';']).next()?;
        let (name, text) = line.split_once(" = ")?;
        let rust = name.strip_prefix("let ");
        let rust = rust.and_then(|name| name.strip_suffix(": f64"));
        let name = rust.unwrap_or(name);
        let is_name = name.chars().all(|c| c.is_alphanumeric() || c == '_');
        let name = is_name.then(|| name.to_owned())?;
        let text = match rust {
            Some(_) => &functions_of_methods(text)?,
            None => text,
        };
        Some((name, Expression::read(text)?))
    };
    code.lines().filter_map(assignment).collect()
}

/// A term of Rust with functions instead of methods: `a.powi(2)` becomes `pow(a, 2)`. `None` if a bracket is not
/// closed.
fn functions_of_methods(text: &str) -> Option<String> {
    const METHODS: [(&str, &str); 6] = [
        (".powi(", "pow"),
        (".powf(", "pow"),
        (".sqrt(", "sqrt"),
        (".sin(", "sin"),
        (".cos(", "cos"),
        (".atan2(", "atan2"),
    ];
    let mut text = text.replace("_f64", "");
    loop {
        let found = METHODS.iter().filter_map(|(method, function)| {
            let dot = text.find(method)?;
            Some((dot, dot + method.len(), *function))
        });
        let Some((dot, inner, function)) = found.min() else {
            return Some(text);
        };
        let (before, rest) = (text.get(..dot)?, text.get(inner..)?);
        let operand = operand_start(before)?;
        let separator = if rest.starts_with(')') { "" } else { ", " };
        text = format!(
            "{}{function}({}{separator}{rest}",
            &before[..operand],
            &before[operand..]
        );
    }
}

/// The start of the operand at the end of a text: a name, a number, or brackets with the function before them.
fn operand_start(text: &str) -> Option<usize> {
    let mut start = text.len();
    if text.ends_with(')') {
        let mut depth = 0_usize;
        for (place, c) in text.char_indices().rev() {
            match c {
                ')' => depth += 1,
                '(' => depth = depth.checked_sub(1)?,
                _ => {}
            }
            if depth == 0 {
                start = place;
                break;
            }
        }
        // The bracket that closes has none that opens.
        if depth > 0 {
            return None;
        }
    }
    let word = |c: char| c.is_alphanumeric() || c == '_' || c == '.';
    Some(text.get(..start)?.trim_end_matches(word).len())
}

/// The name of the function's argument: `def NAME(ARGUMENT):`, `NAME(double ARGUMENT)` or `fn NAME(ARGUMENT: f64)`.
fn argument(code: &str) -> String {
    let head = code.lines().find(|line| {
        line.starts_with("def ") || line.contains("(double ") || line.starts_with("pub fn ")
    });
    let inner = head.and_then(|line| Some(line.split_once('(')?.1.split_once(')')?.0));
    let inner = inner.unwrap_or("").trim_start_matches("double ");
    inner.trim_end_matches(": f64").to_owned()
}

/// m, ½m′, a and b; `None` for quantities that are not computed.
pub(crate) type Quantities = [Option<f64>; 4];

/// m, ½m′, and a and b of a reaction by the code at every row of `reduce`.
pub(crate) fn code_differences(
    code: &str,
    rows: &Rows,
    coordinate: &str,
    reaction: &str,
) -> Differences {
    let lines = assignments(code);
    let argument = argument(code);
    let at = |q: f64| -> Quantities {
        let mut values = HashMap::from([(argument.clone(), q)]);
        for (name, expression) in &lines {
            if let Some(value) = expression.at(&|name| values.get(name).copied()) {
                values.insert(name.clone(), value);
            }
        }
        ["m", "half_dm", "a", "b"].map(|name| values.get(name).copied())
    };
    code_differences_of("code", &at, rows, coordinate, reaction)
}

/// The differences of the quantities computed by `at`, in words.
pub(crate) fn code_differences_of(
    what: &str,
    at: &dyn Fn(f64) -> Quantities,
    rows: &Rows,
    coordinate: &str,
    reaction: &str,
) -> Differences {
    let mut all = Differences::default();
    let columns = [
        ("m", "m".to_owned()),
        ("half_dm", "half_dm".to_owned()),
        ("a", format!("{reaction}.a")),
        ("b", format!("{reaction}.b")),
    ];
    let largest = |name: &str| largest(rows.column(name));
    let scales = [largest("m"), largest("m").max(largest("half_dm"))];
    let forces = largest(&columns[2].1)
        .max(largest(&columns[3].1))
        .max(scales[0]);
    for row in 0..rows.count {
        let Some(q) = rows.get(row, coordinate) else {
            continue;
        };
        for (k, ((variable, column), value)) in columns.iter().zip(at(q)).enumerate() {
            let (Some(value), Some(written)) = (value, rows.get(row, column)) else {
                all.fail(format!(
                    "the {what} has no {variable}, or `reduce` no {column}"
                ));
                return all;
            };
            let scale = scales.get(k).copied().unwrap_or(forces);
            all.add(written - value, scale, "", || {
                format!("generated {what}, row {row}, {column}")
            });
        }
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn methods_are_read_as_functions() {
        for (rust, expected) in [
            ("-a.powi(2) * b_1.sqrt()", "-pow(a, 2) * sqrt(b_1)"),
            (
                "(a - 2.0 * b).atan2(-c).sin()",
                "sin(atan2((a - 2.0 * b), -c))",
            ),
            (
                "(t3 / D.powi(2) - f.powi(2)).sqrt()",
                "sqrt((t3 / pow(D, 2) - pow(f, 2)))",
            ),
            ("2.0_f64.sqrt()", "sqrt(2.0)"),
            ("a * b", "a * b"),
        ] {
            assert_eq!(functions_of_methods(rust).as_deref(), Some(expected));
        }
        assert_eq!(functions_of_methods("a).sin()"), None);
    }

    #[test]
    fn rust_is_run_line_by_line() {
        let code = "pub fn f(phi: f64) -> F {\n    let l: f64 = 2.0;\n    let m: f64 = l * phi.cos().powi(2);\n}";
        let lines = assignments(code);
        assert_eq!((argument(code).as_str(), lines.len()), ("phi", 2));
        let value = |name: &str| Some(if name == "l" { 2.0 } else { 0.3 });
        let m = lines[1].1.at(&value);
        assert_eq!(m, Some(2.0 * 0.3_f64.cos().powi(2)));
    }
}
