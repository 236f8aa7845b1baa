//! The code that `symbolic` writes, run line by line by the small reader of expressions.

use super::difference::Differences;
use super::expression::Expression;
use super::jet::Jet;
use super::rows::Rows;
use std::collections::HashMap;

/// The assignments of generated Python or C, in their order.
pub(crate) fn assignments(code: &str) -> Vec<(String, Expression)> {
    let assignment = |line: &str| {
        let line = line.trim();
        let line = line.strip_prefix("const double ").unwrap_or(line);
        let line = line.split(['#', ';']).next()?;
        let (name, text) = line.split_once(" = ")?;
        let is_name = name.chars().all(|c| c.is_alphanumeric() || c == '_');
        let name = is_name.then(|| name.to_owned())?;
        Some((name, Expression::read(text)?))
    };
    code.lines().filter_map(assignment).collect()
}

/// The name of the function's argument: `def NAME(ARGUMENT):`, or `NAME(double ARGUMENT)`.
fn argument(code: &str) -> String {
    let head = code
        .lines()
        .find(|line| line.starts_with("def ") || line.contains("(double "));
    let inner = head.and_then(|line| Some(line.split_once('(')?.1.split_once(')')?.0));
    inner.unwrap_or("").trim_start_matches("double ").to_owned()
}

/// m, ½m′, and a and b of a reaction by the code at every row of `reduce`.
pub(crate) fn code_differences(
    code: &str,
    rows: &Rows,
    coordinate: &str,
    reaction: &str,
) -> Differences {
    let mut all = Differences::default();
    let lines = assignments(code);
    let argument = argument(code);
    let columns = [
        ("m", "m".to_owned()),
        ("half_dm", "half_dm".to_owned()),
        ("a", format!("{reaction}.a")),
        ("b", format!("{reaction}.b")),
    ];
    let largest = |name: &str| {
        let column = rows.columns.get(name).into_iter().flatten();
        column.fold(0.0_f64, |max, v| max.max(v.abs()))
    };
    let scales = [largest("m"), largest("m").max(largest("half_dm"))];
    let forces = largest(&columns[2].1)
        .max(largest(&columns[3].1))
        .max(scales[0]);
    for row in 0..rows.count {
        let Some(q) = rows.get(row, coordinate) else {
            continue;
        };
        let mut values = HashMap::from([(argument.clone(), Jet::constant(q))]);
        for (name, expression) in &lines {
            if let Some(value) = expression.at(&|name| values.get(name).copied()) {
                values.insert(name.clone(), value);
            }
        }
        for (k, (variable, column)) in columns.iter().enumerate() {
            let value = values.get(*variable).map(|v| v.value());
            let (Some(value), Some(written)) = (value, rows.get(row, column)) else {
                all.fail(format!(
                    "the code has no {variable}, or `reduce` no {column}"
                ));
                return all;
            };
            let scale = scales.get(k).copied().unwrap_or(forces);
            all.add(written - value, scale, "", || {
                format!("generated code, row {row}, {column}")
            });
        }
    }
    all
}
