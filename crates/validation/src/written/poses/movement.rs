//! The printed text of `kinematics` on the movement (ranges of body angles and travels), compared with its summary.

use super::difference::Differences;
use super::program::Run;
use super::scene_text::Scene;
use super::stated::{Expected, result, sentence_differences};
use serde_json::Value;

/// An extent below this part of the mechanism, or of a radian, is rounding.
const ROUNDING: f64 = 1e-6;
/// Extents that differ by less than this part of them are the same, and named once.
const SAME: f64 = 1e-9;

/// The lines `NAME turns by …` and `NAME travels by …` of a run with the numbers of its summary; the largest movements are
/// among them.
pub(super) fn movement(run: &Run, scene: &Scene) -> Result<Differences, String> {
    let summary = run.json("-kinematics.json")?;
    let results = summary["results"]
        .as_object()
        .ok_or("the summary has no results")?;
    let mut lines: Vec<(String, Vec<Expected>)> = Vec::new();
    let mut largest = [0.0_f64; 2];
    for (key, entry) in results {
        let Some(name) = key.strip_suffix(".range") else {
            continue;
        };
        let is_angle = entry["unit"] == "rad";
        let (verb, end, factor) = match is_angle {
            true => ("turns", ".angle", scene.units.angle),
            false => ("travels", ".travel", scene.units.length),
        };
        let of = |end: &str| result(&summary, &format!("{key}{end}")).unwrap_or(f64::NAN);
        let shown = name.strip_suffix(end).unwrap_or(name);
        let numbers = ["", ".from", ".to"].map(|end| (of(end) / factor, of("") / factor));
        lines.push((format!("{shown} {verb} by "), numbers.to_vec()));
        let largest = &mut largest[usize::from(!is_angle)];
        *largest = largest.max(of(""));
    }
    let mut found = sentence_differences(&run.printed, &lines, "kinematics");
    add_named(&mut found, &summary, scene, largest);
    Ok(found)
}

/// Checks that the body that turns most and the slide that travels most are named.
fn add_named(to: &mut Differences, summary: &Value, scene: &Scene, named: [f64; 2]) {
    let extrema = summary["extrema"].as_array().map_or(&[][..], Vec::as_slice);
    let kinds = [(".angle", "rad", 1.0), (".travel", "m", scene.size())];
    for ((end, unit, size), named) in kinds.into_iter().zip(named) {
        let of_kind = extrema.iter().filter(|entry| {
            let quantity = entry["quantity"].as_str().unwrap_or("");
            quantity.ends_with(end) && entry["unit"] == unit
        });
        let extent = |entry: &Value| {
            let of = |end: &str| entry[end]["value"].as_f64();
            Some(of("max")? - of("min")?)
        };
        let largest = of_kind.filter_map(extent).fold(0.0, f64::max);
        if largest > ROUNDING * size {
            let missing = (largest - named - SAME * largest).max(0.0);
            to.add(missing, largest, unit, || {
                format!("the largest extent of all columns `*{end}`")
            });
        }
    }
}
