//! Warnings of splines that go beyond their points, against the extrema of the motion that follows them.

use super::difference::Differences;
use super::positions::start_of;
use super::program::Program;
use super::scene_text::{Scene, text_of, value_of};

/// Values, as parts of a rise, between which a spline swings, and the rise, rad or parts of the size, with its duration, s.
const ABRUPT: [f64; 7] = [0.0, 0.02, 0.0, 1.0, 0.97, 1.0, 0.98];
const RISE: f64 = 0.2;
const DURATION: f64 = 1.5;

/// Part of the range in per cent, value and place of the farthest point.
type Overshoot = [f64; 3];

/// A spline whose values change abruptly drives the only actuator: the numbers of its warning, each relative to its last printed digit.
pub(super) fn warning_differences(program: &Program, scene: &Scene) -> Result<Differences, String> {
    let actuator = &scene.actuators[0];
    let size = if actuator.is_angle { 1.0 } else { scene.size() };
    let start = start_of(scene, &actuator.name);
    let points = ABRUPT.iter().enumerate().map(|(k, share)| {
        let time = DURATION * k as f64 / (ABRUPT.len() - 1) as f64;
        vec![time, start + RISE * size / actuator.unit * share].into()
    });
    let law = value_of([
        ("table", toml::Value::Array(points.collect())),
        ("interpolation", "spline".into()),
    ]);
    let mut table = scene.everything();
    table.remove("coordinate-sweep");
    let prescribed = value_of([("duration", DURATION.into()), (&actuator.name, law)]);
    table.insert("prescribed".to_owned(), prescribed);
    let run = program.run(
        "abrupt",
        &text_of(&table)?,
        &["kinematics", "--points", "181"],
    )?;
    let summary = run.json("-kinematics.json")?;
    let mut extrema = summary["extrema"].as_array().into_iter().flatten();
    let of_law = extrema.find(|entry| entry["quantity"] == actuator.name.as_str());
    let end = |end: &str| {
        let of = |key: &str| of_law.and_then(|entry| entry[end][key].as_f64());
        [of("value"), of("at")].map(|x| x.unwrap_or(f64::NAN))
    };
    let mut found = Differences::default();
    let warnings = warnings(&run.messages);
    let [warning] = warnings.as_slice() else {
        let count = warnings.len();
        found.fail(format!("{count} warnings of a spline instead of one"));
        return Ok(found);
    };
    let range = RISE * size;
    let [[low, low_at], [high, high_at]] = ["min", "max"].map(end);
    let beyond = [
        start * actuator.unit - low,
        high - start * actuator.unit - range,
    ];
    let [value, at] = match beyond[0] > beyond[1] {
        true => [low, low_at],
        false => [high, high_at],
    };
    let percent = 100.0 * beyond[0].max(beyond[1]) / range;
    for (printed, expected) in warning.iter().zip([percent, value, at]) {
        // Whole per cents; four digits of value and place.
        let last_digit = match expected == percent {
            true => 1.0,
            false => 10.0_f64.powf(expected.abs().log10().floor() - 3.0),
        };
        found.add(printed - expected, last_digit, "", || {
            format!("{printed} of the warning of a spline")
        });
    }
    Ok(found)
}

/// The numbers of all such warnings.
fn warnings(messages: &str) -> Vec<Overshoot> {
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
        assert_eq!(warnings(text), [[12.0, -3.2, 1.5]]);
    }
}
