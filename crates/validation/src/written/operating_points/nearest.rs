//! `linearise` takes the equilibrium that is nearest to the start. From a start near each equilibrium of the table it must be that one.

use super::rest::Rest;
use super::runs::linearise_nearest;
use super::starts::Start;
use crate::written::poses::compared::Compared;
use crate::written::poses::stated::result;

/// A start is so far from its equilibrium, in parts of the distance to the next one.
const ASIDE: f64 = 0.1;

/// Moves the start near each equilibrium. One that is alone has no other that could be taken.
pub(super) fn compare(rest: &Rest<'_>, compared: &mut Compared) -> Result<(), String> {
    let places: Option<Vec<Vec<f64>>> = (0..rest.rows.count)
        .map(|row| rest.coordinates(row))
        .collect();
    let places = places.ok_or("an equilibrium without a place")?;
    // Friction holds in whole intervals, and the ends of these are no equilibria of their own; of neutral ones each position is one.
    let results = rest.summary["results"].as_object();
    let is_neutral = results.is_some_and(|all| all.keys().any(|key| key.contains(".neutral")));
    if rest.start.scene.contains_key("friction") || is_neutral {
        return Ok(());
    }
    for (row, place) in places.iter().enumerate() {
        let others = places.iter().enumerate().filter(|(k, _)| *k != row);
        let next = others.min_by(|(_, a), (_, b)| {
            let [a, b] = [a, b].map(|other| distance(rest.start, place, other));
            a.total_cmp(&b)
        });
        if let Some((_, next)) = next {
            compare_near(rest, compared, (row, place), next)?;
        }
    }
    Ok(())
}

fn compare_near(
    rest: &Rest<'_>,
    compared: &mut Compared,
    (row, place): (usize, &[f64]),
    next: &[f64],
) -> Result<(), String> {
    let near = |(a, b): (&f64, &f64)| a + ASIDE * (b - a);
    let from: Vec<f64> = place.iter().zip(next).map(near).collect();
    let start = rest.start.at_rest_in(&from);
    let text = start.text_of_scene(start.scene.clone())?;
    let run = linearise_nearest(rest.program, &format!("near{row}"), &text)?;
    let summary = run.json("-linearise.json")?;
    for (k, free) in start.free.iter().enumerate() {
        let what = || {
            format!(
                "equilibrium {}, {} from a start near it",
                row + 1,
                free.name
            )
        };
        let at = result(&summary, &format!("equilibrium.{}", free.name));
        let at = at.ok_or("`linearise` without the place of its equilibrium")?;
        compared.add(
            "written-rest-again",
            at - place[k],
            free.size.max(place[k].abs()),
            "",
            what,
        );
        let away = result(&summary, &format!("equilibrium.{}.from_start", free.name));
        let away = away.ok_or("`linearise` without the distance from the start")?;
        compared.add(
            "written-rest-nearest",
            away - (place[k] - from[k]),
            free.size.max(place[k].abs()),
            "",
            what,
        );
    }
    Ok(())
}

fn distance(start: &Start, one: &[f64], other: &[f64]) -> f64 {
    let free = start.free.iter().zip(one.iter().zip(other));
    free.map(|(free, (a, b))| ((a - b) / free.size).abs())
        .fold(0.0, f64::max)
}
