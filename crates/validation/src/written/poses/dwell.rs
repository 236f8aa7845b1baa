//! The dwell that a scene requests, against all windows of the written rows.

use super::difference::Differences;
use super::program::Program;
use super::rows::{Rows, extent};
use super::scene_text::table_of;
use super::stated::{result, sentence_differences, summary_differences};
use toml::Value;

/// Runs `kinematics` on a scene that requests a dwell; nothing where it requests none.
pub(super) fn dwell_differences(program: &Program, scene: &str) -> Result<Differences, String> {
    let table = table_of(scene)?;
    let request = table.get("requests").and_then(|r| r.get("dwell"));
    let Some(body) = request.and_then(|r| r.get("body")).and_then(Value::as_str) else {
        return Ok(Differences::default());
    };
    let run = program.run("dwell", scene, &["kinematics"])?;
    let rows = run.csv("-kinematics.csv")?;
    let summary = run.json("-kinematics.json")?;
    let band = result(&summary, "dwell.relative_band").ok_or("`kinematics` writes no dwell")?;
    let expected =
        numbers(&rows, body, band).ok_or("the rows have no angle of the body that rests")?;
    let expected = expected
        .iter()
        .map(|(name, value)| (name.as_str(), (*value, 1.0)));
    let mut found = summary_differences(&summary, expected, "kinematics");
    let angle = result(&summary, "dwell.angle");
    let said = angle.map(|angle| vec![(angle, 1.0), (100.0 * band, 100.0 * band)]);
    let line = [(format!("{body} rests at "), said.unwrap_or_default())];
    // Of an angle in degrees the number is another.
    if run.printed.contains(" rad within ") {
        found.merge(sentence_differences(&run.printed, &line, "kinematics"));
    }
    Ok(found)
}

/// The middle of the angles in the longest window, and where it begins and ends.
fn numbers(rows: &Rows, body: &str, band: f64) -> Option<Vec<(String, f64)>> {
    let angles = rows.columns.get(&format!("{body}.angle"))?;
    let [low, high] = extent(angles);
    let mut longest = [0, 0];
    for first in 0..angles.len() {
        // A window from here that is longer than the longest one.
        while let Some(window) = angles.get(first..=first + longest[1] - longest[0] + 1)
            && extent(window)[1] - extent(window)[0] <= band * (high - low)
        {
            longest = [first, first + longest[1] - longest[0] + 1];
        }
    }
    let [first, last] = longest;
    let [low, high] = extent(&angles[first..=last]);
    let mut all = vec![("dwell.angle".to_owned(), 0.5 * (low + high))];
    if let Some(times) = rows.columns.get("t") {
        all.push(("dwell.t.from".to_owned(), times[first]));
        all.push(("dwell.t.to".to_owned(), times[last]));
    }
    Some(all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_of_all_windows() {
        let rows = Rows {
            columns: [
                (
                    "guide.angle".to_owned(),
                    vec![0.0, 1.0, 1.05, 1.02, 1.06, 2.0, 2.01, 3.0],
                ),
                ("t".to_owned(), (0..8).map(f64::from).collect()),
            ]
            .into(),
            count: 8,
            ..Rows::default()
        };
        let found = numbers(&rows, "guide", 0.05).expect("a dwell");
        let values: Vec<f64> = found.iter().map(|(_, value)| *value).collect();
        assert_eq!(values, [1.03, 1.0, 4.0]);
    }
}
