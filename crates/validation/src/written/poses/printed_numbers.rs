//! Printed sentences: every number with decimals is one of the summary, to its digits.

use super::difference::Differences;
use super::program::Run;
use super::stated::last_digit;
use serde_json::Value;
use std::f64::consts::PI;

/// Factors from numbers of the summary to printed numbers: SI units, degrees, mm, revolutions per minute.
const FACTORS: [f64; 4] = [1.0, 180.0 / PI, 1e3, 30.0 / PI];

/// Every printed number with decimals is one of the summary, to its digits.
pub(crate) fn sentences(run: &Run, summary: &Value) -> Differences {
    let mut all = Vec::new();
    collect(summary, &mut all);
    let mut found = Differences::default();
    for line in run.printed.lines() {
        // Files and what a branch point leaves open are listed elsewhere.
        let is_list = ["  /", "  change point", "time:"]
            .iter()
            .any(|s| line.starts_with(s));
        if is_list || line.contains(" reaches ") {
            continue;
        }
        for number in numbers(line) {
            let Ok(value) = number.parse::<f64>() else {
                continue;
            };
            let unit = last_digit(number);
            let excess = |known: &f64, factor: f64| {
                ((known * factor).abs() - value.abs()).abs() - 0.500_000_1 * unit
            };
            let nearest = FACTORS
                .iter()
                .flat_map(|factor| all.iter().map(|known| excess(known, *factor)))
                .fold(f64::INFINITY, f64::min);
            found.add(nearest.max(0.0), value.abs().max(unit), "", || {
                format!("`{}` of `{}`", number, line.trim())
            });
        }
    }
    found
}

/// All numbers of a summary.
fn collect(value: &Value, to: &mut Vec<f64>) {
    match value {
        Value::Number(number) => to.extend(number.as_f64()),
        Value::Array(all) => all.iter().for_each(|v| collect(v, to)),
        Value::Object(all) => all.values().for_each(|v| collect(v, to)),
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

/// The numbers with decimals of a line, not those within names.
fn numbers(line: &str) -> impl Iterator<Item = &str> {
    let words = line.split(|c: char| c.is_whitespace() || ",;:()".contains(c));
    words.filter(|word| {
        let starts = word
            .trim_start_matches('-')
            .starts_with(|c: char| c.is_ascii_digit());
        starts && word.contains('.') && word.parse::<f64>().is_ok()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_a_sentence_are_found() {
        let line =
            "  turn: twice, first at t = 0.279107092 s (estimated error 1.6e-10 s), -5.2e3 of A.x";
        assert_eq!(
            numbers(line).collect::<Vec<_>>(),
            ["0.279107092", "1.6e-10", "-5.2e3"]
        );
        assert!((last_digit("1.6e-10") - 1e-11).abs() < 1e-24);
    }
}
