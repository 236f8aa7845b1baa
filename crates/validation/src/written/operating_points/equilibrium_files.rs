//! What `equilibria` and `linearise` write of equilibria beside their modes: how far they are from the start, what was searched, the words for
//! their stability, that both commands find the same, and the extent of the static force, which `statics` gives row by row.

use super::characteristic::Complex;
use super::modes::{eigenvalues, number};
use super::starts::Start;
use crate::written::poses::compared::Compared;
use crate::written::poses::difference::Differences;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::scene_text::text_of;
use serde_json::Value as Json;
use std::f64::consts::TAU;
use toml::{Table, Value};

/// Rows over the searched interval, as many as the command takes.
const POSITIONS: &str = "361";

/// The files of `equilibria` and of `linearise` about the equilibrium.
pub(super) fn compare(
    compared: &mut Compared,
    program: &Program,
    start: &Start<'_>,
    (rest, about): (&Run, Option<&Run>),
) -> Result<(), String> {
    let summary = rest.json("-equilibria.json")?;
    let count = number(&summary, "equilibria").unwrap_or(0.0) as usize;
    let names: Vec<String> = (1..=count).map(|k| format!("equilibrium.{k}")).collect();
    let start_of = compared.of("written-rest-start");
    names
        .iter()
        .for_each(|name| add_start(start_of, start, &summary, name));
    add_searched(start_of, start, &summary);
    let words = compared.of("written-rest-words");
    add_words(words, &rest.printed, &summary, &names);
    if let Some(about) = about {
        let linear = about.json("-linearise.json")?;
        let name = "equilibrium".to_owned();
        add_start(compared.of("written-rest-start"), start, &linear, &name);
        let words = compared.of("written-rest-words");
        add_words(words, &about.printed, &linear, std::slice::from_ref(&name));
        add_same(
            compared.of("written-rest-again"),
            start,
            (&summary, &names),
            &linear,
        );
    }
    static_force(compared, program, start, &summary)
}

/// Each coordinate less that of the start.
fn add_start(to: &mut Differences, start: &Start<'_>, summary: &Json, name: &str) {
    for (free, from) in start.free.iter().zip(start.values()) {
        let at = number(summary, &format!("{name}.{}", free.name));
        let written = number(summary, &format!("{name}.{}.from_start", free.name));
        if let (Some(at), Some(written)) = (at, written) {
            to.add(written - (at - from), free.size.max(from.abs()), "", || {
                format!("{name}, {} from the start", free.name)
            });
        }
    }
}

/// Of an angle not more than a revolution is searched, and the start is within.
fn add_searched(to: &mut Differences, start: &Start<'_>, summary: &Json) {
    for (free, from) in start.free.iter().zip(start.values()) {
        let end = |end: &str| number(summary, &format!("searched.{}.{end}", free.name));
        let (Some(low), Some(high)) = (end("from"), end("to")) else {
            continue;
        };
        let outside = (low - from).max(from - high).max(0.0);
        to.add(outside, free.size, "", || {
            format!("{}: the start is not searched", free.name)
        });
        let place = || format!("{}, extent of the search", free.name);
        let is_whole = start.free.len() > 1 && free.size == 1.0 && start.is_angle(&free.name);
        let difference = match is_whole {
            true => high - low - TAU,
            false => (low - high).max(0.0),
        };
        to.add(difference, TAU.max(low.abs()), "", place);
    }
}

/// The words for the stability of eigenvalues whose error is known; none where zero is within it.
fn word(values: &[Complex], error: f64) -> Option<&'static str> {
    let largest = values
        .iter()
        .map(|[re, _]| *re)
        .fold(f64::NEG_INFINITY, f64::max);
    let is_near_zero = |[re, im]: &Complex| re.hypot(*im) <= 2.0 * error;
    if values.is_empty() || values.iter().any(is_near_zero) {
        return None;
    }
    match largest {
        largest if largest > 2.0 * error => Some("unstable"),
        largest if largest < -2.0 * error => Some("asymptotically stable"),
        // Imaginary: without damping.
        0.0 => Some("stable without damping (centre)"),
        _ => None,
    }
}

/// `…, X from the start: WORDS` of each equilibrium, in their order.
fn add_words(to: &mut Differences, printed: &str, summary: &Json, names: &[String]) {
    let said = printed
        .lines()
        .filter_map(|line| line.split_once(" from the start: "));
    let said: Vec<&str> = said.map(|(_, words)| words.trim()).collect();
    for (k, name) in names.iter().enumerate() {
        let error = number(summary, &format!("{name}.error.eigenvalues")).unwrap_or(0.0);
        let Some(expected) = word(&eigenvalues(summary, name), error) else {
            continue;
        };
        match said.get(k) {
            Some(words) if *words == expected => to.add(0.0, 1.0, "", String::new),
            other => to.fail(format!("{name} is {expected}, and printed is {other:?}")),
        }
    }
}

/// The equilibrium of `linearise` is one of the table, with its modes.
fn add_same(
    to: &mut Differences,
    start: &Start<'_>,
    (summary, names): (&Json, &[String]),
    linear: &Json,
) {
    let away = |name: &str| {
        let of = start.free.iter().map(|free| {
            let at = |of: &Json, name: &str| number(of, &format!("{name}.{}", free.name));
            let (Some(one), Some(other)) = (at(summary, name), at(linear, "equilibrium")) else {
                return f64::INFINITY;
            };
            (one - other).abs() / free.size
        });
        of.fold(0.0, f64::max)
    };
    // Where every position is one, it is no other.
    let is_neutral = |name: &String| {
        summary["results"].as_object().is_some_and(|all| {
            all.keys()
                .any(|key| key.starts_with(&format!("{name}.neutral")))
        })
    };
    if names.iter().any(is_neutral) {
        return;
    }
    let Some(nearest) = names.iter().min_by(|a, b| away(a).total_cmp(&away(b))) else {
        to.fail("`linearise` has an equilibrium, and `equilibria` none".to_owned());
        return;
    };
    to.add(away(nearest), 1.0, "", || {
        "the place of the equilibrium".to_owned()
    });
    if let ([free], [from]) = (
        start.free.as_slice(),
        &start.values().collect::<Vec<_>>()[..],
    ) {
        let aside = |at: Option<f64>| at.map_or(f64::INFINITY, |at| (at - from).abs());
        let of_table = names
            .iter()
            .map(|name| number(summary, &format!("{name}.{}", free.name)));
        let least = of_table.map(aside).fold(f64::INFINITY, f64::min);
        let this = aside(number(linear, &format!("equilibrium.{}", free.name)));
        to.add((this - least).max(0.0), free.size, "", || {
            "an equilibrium nearer to the start".to_owned()
        });
    }
    let [these, those] = [
        eigenvalues(linear, "equilibrium"),
        eigenvalues(summary, nearest),
    ];
    let largest = these
        .iter()
        .map(|[re, im]| re.hypot(*im))
        .fold(f64::MIN_POSITIVE, f64::max);
    if these.len() != those.len() {
        to.fail(format!("{} and {} eigenvalues", these.len(), those.len()));
    }
    for (a, b) in these.iter().zip(&those) {
        let difference = (a[0] - b[0]).hypot(a[1] - b[1]);
        to.add(difference, largest, "1/s", || {
            format!("eigenvalue {} i {}", a[0], a[1])
        });
    }
}

/// The smallest and largest static force with the rows of `statics` over the interval that was searched.
fn static_force(
    compared: &mut Compared,
    program: &Program,
    start: &Start<'_>,
    summary: &Json,
) -> Result<(), String> {
    let ([free], Some(low), Some(high)) = (
        start.free.as_slice(),
        number(summary, "static_force.min"),
        number(summary, "static_force.max"),
    ) else {
        return Ok(());
    };
    let end = |end: &str| number(summary, &format!("searched.{}.{end}", free.name));
    let (Some(from), Some(to), true) = (end("from"), end("to"), start.drives_at_rest().is_some())
    else {
        return Ok(());
    };
    let mut scene = start.scene.clone();
    for section in ["motion", "prescribed", "coordinate-sweep", "requests"] {
        scene.remove(section);
    }
    let ends = [from, to].map(|q| Value::Float(q / free.unit()));
    let sweep = Table::from_iter([(free.name.clone(), Value::Array(ends.to_vec()))]);
    scene.insert("coordinate-sweep".to_owned(), Value::Table(sweep));
    let run = program.run(
        "static-force",
        &text_of(&scene)?,
        &["statics", "--points", POSITIONS],
    );
    // Loads in time are refused: such a scene has no equilibrium.
    let Ok(run) = run else { return Ok(()) };
    let rows = run.csv("-statics.csv")?;
    let name = format!("{}.actuator_force", free.name);
    let forces = rows.columns.get(&name).ok_or("no actuator force")?;
    // The actuator holds what the loads do; a drive at rest adds the same everywhere.
    let [low_row, high_row] = forces
        .iter()
        .fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], f| {
            [a.min(-f), b.max(-f)]
        });
    let scale = low.abs().max(high.abs());
    let found = compared.of("written-static-force");
    found.add((high - low) - (high_row - low_row), scale, "", || {
        "largest less smallest".to_owned()
    });
    if start.drives_at_rest() == Some(0) {
        found.add(low - low_row, scale, "", || "the smallest".to_owned());
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_are_those_of_the_eigenvalues() {
        assert_eq!(word(&[[1.0, 0.0], [-1.0, 0.0]], 1e-12), Some("unstable"));
        assert_eq!(
            word(&[[-0.1, 2.0], [-0.1, -2.0]], 1e-12),
            Some("asymptotically stable")
        );
        assert_eq!(
            word(&[[0.0, 2.0], [0.0, -2.0]], 1e-12),
            Some("stable without damping (centre)")
        );
        assert_eq!(word(&[[1e-9, 0.0], [-1e-9, 0.0]], 1e-8), None);
    }
}
