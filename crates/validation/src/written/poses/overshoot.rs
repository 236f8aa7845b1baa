//! Warnings of splines that go beyond their points, against the curves of a second reading.

use super::difference::Differences;
use super::drawn_laws::DrawnMotion;
use super::jet::Jet;
use super::program::Program;
use super::rows::extent;
use super::scene_text::{table_of, text_of};
use super::table_curve::TableCurve;
use toml::{Table, Value};

/// From which part of the range of its points on a spline is warned of.
const WARNED_FROM: f64 = 0.05;
/// Values, as parts of a rise, between which a spline swings.
const ABRUPT: [f64; 7] = [0.0, 0.02, 0.0, 1.0, 0.97, 1.0, 0.98];
/// Parts of a piece in which an extremum is looked for.
const PARTS: usize = 16;

/// Part of the range in per cent, value and place of the farthest point.
type Overshoot = [f64; 3];

/// A drawn spline whose values change abruptly: what is warned of it. Its numbers are printed with as many digits as these
/// differences are relative to.
pub(super) fn warning_differences(
    program: &Program,
    motion: &DrawnMotion,
) -> Result<Differences, String> {
    let mut scene = table_of(&motion.text)?;
    let mut all = Differences::default();
    let Some(coordinate) = motion.reading.coordinates.first() else {
        return Ok(all);
    };
    let law = scene
        .get_mut("prescribed")
        .and_then(|p| p.get_mut(&coordinate.name));
    let Some(law) = law.and_then(Value::as_table_mut) else {
        return Ok(all);
    };
    make_abrupt(law).ok_or("the drawn spline has no points")?;
    let unit = motion.reading.unit_of(coordinate.measure);
    let expected = TableCurve::read(law, "spline", [1.0, unit]).and_then(|curve| overshoot(&curve));
    let name = format!("{}-abrupt", motion.name);
    let run = program.run(&name, &text_of(&scene)?, &["kinematics", "--points", "7"]);
    let printed = printed(&run?.messages);
    let expected: Vec<Overshoot> = expected
        .filter(|o| o[0] > 100.0 * WARNED_FROM)
        .into_iter()
        .collect();
    if printed.len() != expected.len() {
        all.fail(format!(
            "{name}: {} warnings of a spline instead of {}",
            printed.len(),
            expected.len()
        ));
        return Ok(all);
    }
    for (printed, expected) in printed
        .iter()
        .flatten()
        .zip(expected.iter().flatten())
        .enumerate()
        .map(|(k, p)| ((k, p.0), p.1))
    {
        let (k, value) = printed;
        // Whole per cents; four digits of value and place.
        let last_digit = match k {
            0 => 1.0,
            _ => 10.0_f64.powf(expected.abs().log10().floor() - 3.0),
        };
        all.add(value - expected, last_digit, "", || {
            format!("{name}, number {k} of the warning")
        });
    }
    Ok(all)
}

/// How many splines of a scene are warned of, against those that go beyond their points.
pub(super) fn warning_count(scene: &Table, messages: &str) -> Differences {
    let mut all = Differences::default();
    let mut expected = 0;
    count(scene, "spline", &mut expected);
    let found = printed(messages).len();
    all.add(
        found as f64 - expected as f64,
        1.0,
        "",
        || "warnings of splines in `check`",
    );
    all
}

/// Adds the splines of a table of the scene, and of those in it, that go far beyond their points.
fn count(table: &Table, usual: &str, found: &mut usize) {
    if let Some(curve) = TableCurve::read(table, usual, [1.0; 2])
        && overshoot(&curve).is_some_and(|o| o[0] > 100.0 * WARNED_FROM)
    {
        *found += 1;
    }
    for (key, value) in table {
        if let Value::Table(inner) = value {
            // The magnitudes of loads are monotone between their points where nothing else is asked for.
            count(
                inner,
                if key == "loads" { "monotone" } else { usual },
                found,
            );
        }
    }
}

/// Changes the values of a law's table to abrupt ones.
fn make_abrupt(law: &mut Table) -> Option<()> {
    let rows = law.get_mut("table")?.as_array_mut()?;
    let value = |row: &Value| row.get(1)?.as_float();
    let [first, last] = [value(rows.first()?)?, value(rows.last()?)?];
    for (row, share) in rows.iter_mut().zip(ABRUPT) {
        *row.get_mut(1)? = Value::Float(first + 0.7 * (last - first) * share);
    }
    Some(())
}

/// Where a spline goes farthest beyond the range of its points; none where it stays within.
fn overshoot(curve: &TableCurve) -> Option<Overshoot> {
    let points = curve.points();
    let [low, high] = extent(points.iter().map(|p| &p[1]));
    let at = |x: f64| curve.at(Jet([x, 1.0, 0.0])).map(|jet| jet.0);
    let mut farthest: Option<Overshoot> = None;
    for piece in points.windows(2) {
        let step = (piece[1][0] - piece[0][0]) / PARTS as f64;
        for k in 0..PARTS {
            let mut ends = [k, k + 1].map(|k| piece[0][0] + step * k as f64);
            let sign = at(ends[0])?[1].signum();
            if at(ends[1])?[1].signum() == sign {
                continue;
            }
            for _ in 0..60 {
                let middle = 0.5 * (ends[0] + ends[1]);
                ends[usize::from(at(middle)?[1].signum() != sign)] = middle;
            }
            let value = at(ends[0])?[0];
            let beyond = 100.0 * (value - high).max(low - value) / (high - low);
            if beyond > farthest.map_or(0.0, |o| o[0]) {
                farthest = Some([beyond, value, ends[0]]);
            }
        }
    }
    farthest
}

/// The numbers of all such warnings.
fn printed(messages: &str) -> Vec<Overshoot> {
    let words = messages.replace('│', " ");
    let text = words.split_whitespace().collect::<Vec<_>>().join(" ");
    let number = |text: &str| text.split_whitespace().next()?.parse::<f64>().ok();
    let of = |text: &str| {
        let (percent, rest) = text.split_once("% of their range: ")?;
        let (value, place) = rest.split_once(" at ")?;
        Some([number(percent)?, number(value)?, number(place)?])
    };
    text.split("goes beyond its points by ")
        .skip(1)
        .filter_map(of)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn warnings_are_read_over_broken_lines() {
        let text = "  ⚠ the spline of phi goes beyond its points\n  │ by 12 % of their range: -3.2 at 1.5 (SI\n  │ units); more";
        assert_eq!(printed(text), [[12.0, -3.2, 1.5]]);
    }

    /// The parabola through three points goes beyond them by an eighth of their range, a quarter before the last.
    #[test]
    fn a_parabola_beyond_its_points() {
        let table: Table = "table = [[0, 0], [2, 8], [4, 8]]".parse().expect("a table");
        let curve = TableCurve::read(&table, "spline", [1.0; 2]).expect("a curve");
        let [percent, value, place] = overshoot(&curve).expect("beyond");
        assert!(
            (percent - 12.5).abs() < 1e-12
                && (value - 9.0).abs() < 1e-14
                && (place - 3.0).abs() < 1e-7
        );
        let mut found = 0;
        count(&table, "monotone", &mut found);
        assert_eq!(found, 0);
        count(&table, "spline", &mut found);
        assert_eq!(found, 1);
    }
}
