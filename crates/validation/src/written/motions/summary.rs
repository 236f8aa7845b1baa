//! The summary and the printed sentences of `simulate` against its rows and events.

use crate::written::poses::difference::Differences;
use crate::written::poses::formats::last_digit;
use crate::written::poses::program::Run;
use crate::written::poses::rows::{Rows, largest};
use crate::written::poses::stated::result;
use serde_json::Value;
use std::f64::consts::PI;

/// What a printed number may be in, by numbers of the summary: SI units, degrees, mm, revolutions in a minute.
const FACTORS: [f64; 4] = [1.0, 180.0 / PI, 1e3, 30.0 / PI];

/// Energies and events of the summary with the rows.
pub(crate) fn summary_of_rows(summary: &Value, rows: &Rows, events: Option<&Rows>) -> Differences {
    let mut found = Differences::default();
    let result = |name: &str| result(summary, name);
    let [kinetic, potential, balance] =
        ["energy.kinetic", "energy.potential", "energy.balance_error"]
            .map(|name| rows.column(name));
    let works: Vec<&Vec<f64>> = rows.ending(".work").map(|(_, work)| work).collect();
    let energy = |row: usize| {
        let work: f64 = works.iter().map(|work| work[row]).sum();
        kinetic[row] + potential.get(row).unwrap_or(&0.0) - work
    };
    let sizes = works.iter().map(|work| largest(*work));
    let scale = sizes.fold(largest(kinetic).max(largest(potential)), f64::max);
    for (row, error) in balance.iter().enumerate() {
        let expected = energy(row) - energy(0);
        found.add(error - expected, scale, "J", || {
            format!("row {row}, energy.balance_error")
        });
    }
    if let Some(kinetic_energy) = result("largest_kinetic_energy") {
        // Between the rows it may be larger, by no more than the largest change from row to row.
        let changes = kinetic.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let change = changes.fold(0.0, f64::max);
        let difference = kinetic_energy - largest(kinetic);
        let excess = (-difference).max(difference - change).max(0.0);
        found.add(excess, scale, "J", || "largest_kinetic_energy");
        if let (Some(stated), false) = (result("energy_balance_error"), balance.is_empty()) {
            let difference = (stated * kinetic_energy - largest(balance)).min(0.0);
            found.add(difference, scale, "J", || "energy_balance_error");
        }
    }
    if let (Some(time), Some(end)) = (rows.columns.get("t"), result("end")) {
        let last = time.last().copied().unwrap_or(f64::NAN);
        found.add(end - last, last, "s", || "the end");
    }
    add_events(&mut found, summary, events);
    found
}

/// The number of events of each kind, and the first of them.
fn add_events(found: &mut Differences, summary: &Value, events: Option<&Rows>) {
    let Some(results) = summary["results"].as_object() else {
        found.fail("the summary has no results");
        return;
    };
    let stated = results.iter().filter_map(|(name, of)| {
        let event = name.strip_prefix("event.")?.strip_suffix(".count")?;
        Some((event, of["value"].as_f64()?))
    });
    let stated: Vec<(&str, f64)> = stated.collect();
    let rows = events.map_or(0, |events| events.count);
    let sum: f64 = stated.iter().map(|(_, count)| count).sum();
    if !stated.is_empty() || rows > 0 {
        found.add(sum - rows as f64, 1.0, "", || "number of events");
    }
    let times = events.and_then(|events| events.columns.get("t"));
    for (event, count) in stated {
        let first = results.get(&format!("event.{event}.first"));
        let first = first.and_then(|of| of["value"].as_f64());
        if let (true, Some(first)) = (count > 0.0, first) {
            let nearest = times.into_iter().flatten().map(|t| (t - first).abs());
            let nearest = nearest.fold(f64::INFINITY, f64::min);
            found.add(nearest, first.abs().max(1e-3), "s", || {
                format!("first event `{event}`")
            });
        }
    }
}

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

    #[test]
    fn an_event_that_is_not_among_the_rows_is_found() {
        let summary = serde_json::json!({ "results": {
            "event.turn.count": { "value": 1.0 }, "event.turn.first": { "value": 0.5 } } });
        let rows = |t: f64| Rows {
            columns: [("t".to_owned(), vec![t])].into_iter().collect(),
            count: 1,
            ..Rows::default()
        };
        for (t, agrees) in [(0.5, true), (0.51, false)] {
            let found = summary_of_rows(&summary, &Rows::default(), Some(&rows(t)));
            assert_eq!(found.largest() == 0.0, agrees, "{t}");
        }
    }
}
