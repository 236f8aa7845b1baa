//! That no event of `simulate` is missing: where a row is on one side of an event and the next on the other, the table has one between; and that
//! every change point that `check` names is met.

use crate::written::poses::difference::Differences;
use crate::written::poses::law::number;
use crate::written::poses::reading::Reading;
use crate::written::poses::rows::{Rows, extent, largest};
use std::f64::consts::TAU;
use toml::{Table, Value};

/// A row decides where it is off the event by more than this part of the largest.
const CLEAR: f64 = 1e-6;

/// The events between rows, by the scene's text. Nothing of a scene with end stops, whose velocities jump.
pub(super) fn missing_events(
    reading: &Reading,
    scene: &Table,
    rows: &Rows,
    events: Option<&Rows>,
) -> Differences {
    let mut found = Differences::default();
    let of_motion = scene.get("motion").and_then(|motion| motion.get("events"));
    let Some(wanted) = of_motion.and_then(Value::as_table) else {
        return found;
    };
    if scene.contains_key("stops") {
        return found;
    }
    let times = rows.column("t");
    let located = events.map_or(&[][..], |events| events.column("t"));
    for (name, event) in wanted {
        for [from, to] in sides(reading, rows, event)
            .into_iter()
            .flat_map(|side| changes(&side))
        {
            let [from, to] = [from, to].map(|row| times.get(row).copied().unwrap_or(f64::NAN));
            let near = 1e-9 * to.abs();
            let is_there = located
                .iter()
                .any(|t| (from - near..=to + near).contains(t));
            found.require(is_there, || {
                format!("no event `{name}` between t = {from} s and {to} s")
            });
        }
    }
    found
}

/// The quantity whose sign an event is about, row by row; of revolutions one for each whole number of them.
fn sides(reading: &Reading, rows: &Rows, event: &Value) -> Vec<Vec<f64>> {
    let text = |key: &str| event.get(key).and_then(Value::as_str);
    let column = |name: String| rows.columns.get(&name).cloned();
    if let Some(name) = text("reverses") {
        return column(format!("{name}.velocity")).into_iter().collect();
    }
    if let Some(name) = text("reaction") {
        return column(name.to_owned()).into_iter().collect();
    }
    let less = |values: &[f64], by: f64| values.iter().map(|v| v - by).collect();
    if let (Some(name), Some(value)) = (text("reaches"), number(event.get("value"))) {
        let unit = reading.coordinate(name).map(|c| reading.unit_of(c.measure));
        let of = |values: Vec<f64>| Some(less(&values, value * unit?));
        return column(name.to_owned()).and_then(of).into_iter().collect();
    }
    let Some(values) = text("revolution").and_then(|name| column(name.to_owned())) else {
        return Vec::new();
    };
    let start = values.first().copied().unwrap_or(0.0);
    let furthest = values.iter().fold(0.0_f64, |max, q| max.max(q - start));
    let whole = (furthest / TAU).floor() as usize;
    (1..=whole)
        .map(|k| less(&values, start + TAU * k as f64))
        .collect()
}

/// The pairs of rows between which a quantity changes its sign, both clearly off zero.
fn changes(side: &[f64]) -> Vec<[usize; 2]> {
    let clear = CLEAR * largest(side);
    let is_change = |row: &usize| {
        let [a, b] = [side[*row - 1], side[*row]];
        a * b < 0.0 && a.abs() > clear && b.abs() > clear
    };
    (1..side.len())
        .filter(is_change)
        .map(|row| [row - 1, row])
        .collect()
}

/// Every change point that `check` prints and that the rows come to is one that `simulate` says it crosses, or why not: that the fit across it
/// is poor is no reason.
pub(super) fn change_points(checked: &str, simulated: &str, rows: &Rows) -> Differences {
    let mut found = Differences::default();
    let named = checked.lines().filter_map(|line| {
        let (place, rest) = line
            .trim()
            .strip_prefix("change point of ")?
            .split_once(" = ")?;
        let (_, coordinate) = place.rsplit_once(' ')?;
        let [from, to] = extent(rows.column(coordinate));
        let point = rest.split([' ', ',']).next()?.parse::<f64>().ok()?;
        // The next one of an angle that is not below the rows.
        let is_angle = rest.contains(" rad");
        let turns = if is_angle {
            ((from - point) / TAU).ceil()
        } else {
            0.0
        };
        (from..=to)
            .contains(&(point + TAU * turns))
            .then_some(point)
    });
    let said: Vec<(f64, &str)> = simulated
        .lines()
        .filter_map(|line| {
            let line = line
                .trim()
                .trim_start_matches("the ")
                .strip_prefix("change point at ")?;
            let (at, rest) = line.split_once([':', ' '])?;
            Some((at.parse().ok()?, rest))
        })
        .collect();
    for point in named {
        // Angles count on.
        let off = |at: f64| {
            let turns = ((at - point) / TAU).round();
            (at - point - TAU * turns).abs()
        };
        let nearest = said.iter().min_by(|a, b| off(a.0).total_cmp(&off(b.0)));
        match nearest {
            Some((at, rest)) if !rest.contains("cannot be crossed: the branch") => {
                // As many digits as are printed.
                found.add((off(*at) - 1e-5).max(0.0), 1.0, "rad", || {
                    format!("change point at {point}")
                });
            }
            other => found.fail(format!(
                "change point at {point}: `simulate` says {other:?}"
            )),
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reversal_without_an_event_is_found() {
        let scene: Table = "[motion]\nevents.back = { reverses = \"q\" }"
            .parse()
            .expect("a scene");
        let reading = Reading::new("bodies.ground.points = { A = [0, 0] }").expect("a reading");
        let columns = |name: &str, values: Vec<f64>| (name.to_owned(), values);
        let rows = Rows {
            columns: [
                columns("t", vec![0.0, 0.1, 0.2]),
                columns("q.velocity", vec![1.0, 0.5, -0.5]),
            ]
            .into(),
            count: 3,
            ..Rows::default()
        };
        let events = Rows {
            columns: [columns("t", vec![0.15])].into(),
            count: 1,
            ..Rows::default()
        };
        let is_missing =
            |events: Option<&Rows>| missing_events(&reading, &scene, &rows, events).largest();
        assert_eq!(
            missing_events(&reading, &scene, &rows, Some(&events)).count,
            1
        );
        assert_eq!(is_missing(Some(&events)), 0.0);
        assert!(
            missing_events(&reading, &scene, &rows, None)
                .failure()
                .is_some()
        );
    }

    #[test]
    fn a_change_point_that_is_not_crossed_is_found() {
        let turning = |phi: [f64; 2]| Rows {
            columns: [("phi".to_owned(), phi.to_vec())].into(),
            count: 2,
            words: [].into(),
        };
        let checked = "change point of `a`, `b` at phi = 3.141592654 rad (180°), where another assembly mode begins";
        let fails = |simulated: &str| {
            let found = change_points(checked, simulated, &turning([6.0, 12.0]));
            found.failure().is_some() || found.largest() > 0.0
        };
        assert!(!fails(
            "  change point at 3.14159: crossed by a polynomial fit within ±0.01"
        ));
        assert!(fails(
            "  change point at -1.7e-19: crossed by a polynomial fit within ±0.01"
        ));
        assert!(fails(
            "  the change point at 3.14159 cannot be crossed: the branch is not smooth there"
        ));
        assert!(!fails(
            "  the change point at 3.14159 cannot be crossed: couplings"
        ));
        assert!(fails(""));
        // A motion that does not come to it says nothing of it.
        let found = change_points(checked, "", &turning([0.0, 3.0]));
        assert!(found.failure().is_none());
    }
}
