//! Variants of a scene: the value of `calibrate` against the period that quadrature gives of the rows of `reduce`.

use super::difference::Differences;
use super::program::Program;
use super::reading::Reading;
use super::rows::{Rows, largest};
use super::scene_text::text_of;
use super::stated::result;
use toml::{Table, Value};

/// By how much an extremum is not between the highest row and a parabola's height above it, which is at most an eighth of
/// the second difference there; and the largest value.
pub(crate) fn beyond_rows(values: &[f64], extremum: f64, sign: f64) -> (f64, f64) {
    let of = |k: usize| sign * values[k];
    let highest = (0..values.len())
        .max_by(|a, b| of(*a).total_cmp(&of(*b)))
        .unwrap_or(0);
    let last = values.len() - 1;
    let neighbours = [
        highest.checked_sub(1).unwrap_or(last - 1),
        if highest == last { 1 } else { highest + 1 },
    ];
    let bend = neighbours.map(|k| of(highest) - of(k)).iter().sum::<f64>();
    let above = sign * extremum - of(highest);
    // Twice the eighth: the curve is no parabola.
    ((-above).max(above - 0.25 * bend).max(0.0), largest(values))
}

/// The scene with another number; in an array, by its place.
pub(crate) fn with_number(scene: &Table, path: &[&str], number: f64) -> Option<Table> {
    let mut changed = scene.clone();
    let (first, keys) = path.split_first()?;
    let mut value = changed.get_mut(*first)?;
    for key in keys {
        value = match value {
            Value::Array(values) => values.get_mut(key.parse::<usize>().ok()?)?,
            other => other.get_mut(*key)?,
        };
    }
    *value = Value::Float(number);
    Some(changed)
}

/// The period with the calibrated number: of a mechanism without loads that turns fully, q̇ √m is constant, so that the
/// period is the integral of √m over a revolution. Trapezoids are exact to rounding there. Empty without a calibration.
pub(crate) fn calibration_differences(
    program: &Program,
    scene: &Table,
    reading: &Reading,
) -> Result<Differences, String> {
    let mut all = Differences::default();
    let calibration = scene.get("calibration").and_then(Value::as_table);
    let parameter = calibration
        .and_then(|c| c.get("parameter"))
        .and_then(Value::as_str);
    let (Some(parameter), true) = (parameter, reading.loads.is_empty()) else {
        return Ok(all);
    };
    let Some((body, key)) = parameter
        .split_once('.')
        .filter(|(_, key)| !key.contains(['.', '[']))
    else {
        return Ok(all);
    };
    let run = program.run("calibrate", &text_of(scene)?, &["calibrate"])?;
    let summary = run.json("-calibrate.json")?;
    let number = |name: &str| result(&summary, name).unwrap_or(f64::NAN);
    let unit = if key == "mass" {
        reading.units.mass
    } else {
        reading.units.inertia
    };
    let changed = with_number(scene, &["bodies", body, key], number(parameter) / unit)
        .ok_or("no such number")?;
    let run = program.run("calibrated", &text_of(&changed)?, &["reduce"])?;
    let rows = run.csv("-reduced.csv")?;
    let Some(period) = period(scene, reading, &rows) else {
        return Ok(all);
    };
    all.add(period - number("required_period"), period, "s", || {
        format!("period with the calibrated {parameter}")
    });
    Ok(all)
}

fn period(scene: &Table, reading: &Reading, rows: &Rows) -> Option<f64> {
    let coordinate = reading.coordinates.first()?;
    let start = |key: &str| {
        let value = scene.get("motion")?.get(key)?;
        let unit = reading.unit_of(coordinate.measure);
        super::law::number(value.get(&coordinate.name).or(Some(value))).map(|x| x * unit)
    };
    let (q, m) = (rows.columns.get(&coordinate.name)?, rows.columns.get("m")?);
    let first = start("initial-coordinate")?;
    let row = q.iter().position(|q| (q - first).abs() < 1e-12)?;
    let steps = q
        .windows(2)
        .zip(m.windows(2))
        .map(|(q, m)| 0.5 * (q[1] - q[0]) * (m[0].sqrt() + m[1].sqrt()));
    Some(steps.sum::<f64>() / (m[row].sqrt() * start("initial-velocity")?.abs()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_extremum_is_at_its_row_or_little_above() {
        let values: Vec<f64> = (0..=62)
            .map(|k| (f64::from(k) * 0.1 + 0.03).cos())
            .collect();
        let (beyond, _) = beyond_rows(&values, 1.0, 1.0);
        assert_eq!(beyond, 0.0);
        for wrong in [1.02, 0.97] {
            assert!(beyond_rows(&values, wrong, 1.0).0 > 1e-3, "{wrong}");
        }
    }
}
