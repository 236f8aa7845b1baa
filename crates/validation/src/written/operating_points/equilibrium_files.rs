//! The texts of `equilibria` and `linearise` on equilibria: the searched range, neutral directions, stability, and the extent of the static
//! force, compared with the rows of `statics`.

use super::eigenvalues::{Complex, eigenvalues};
use super::starts::{FreeCoordinate, Start};
use crate::written::poses::compared::Compared;
use crate::written::poses::difference::Differences;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::rows::{extent, largest};
use crate::written::poses::scene_text::{text_of, value_of};
use crate::written::poses::stated::result;
use serde_json::Value as Json;
use std::f64::consts::TAU;
use toml::{Table, Value};

/// Rows over the searched interval, as many as the command takes.
const POSITIONS: &str = "361";

/// The files of `equilibria` and of `linearise` about the equilibrium.
pub(super) fn compare(
    compared: &mut Compared,
    program: &Program,
    start: &Start,
    (rest, about): (&Run, Option<&Run>),
) -> Result<(), String> {
    let summary = rest.json("-equilibria.json")?;
    let count = result(&summary, "equilibria").unwrap_or(0.0) as usize;
    let names: Vec<String> = (1..=count).map(|k| format!("equilibrium.{k}")).collect();
    let start_of = compared.of("written-rest-start");
    for name in &names {
        add_neutral(start_of, start, &summary, name);
    }
    add_searched(start_of, start, &summary);
    let words = compared.of("written-rest-words");
    add_words(words, &rest.printed, &summary, &names);
    if let Some(about) = about {
        let linear = about.json("-linearise.json")?;
        let name = "equilibrium".to_owned();
        let start_of = compared.of("written-rest-start");
        add_neutral(start_of, start, &linear, &name);
        let words = compared.of("written-rest-words");
        add_words(words, &about.printed, &linear, std::slice::from_ref(&name));
    }
    static_force(compared, program, start, &summary)
}

/// Checks that a neutral direction has 1 as its largest component, and that an interval of equilibria contains its equilibrium.
fn add_neutral(to: &mut Differences, start: &Start, summary: &Json, name: &str) {
    for k in 1..=start.free.len() {
        let part = |free: &FreeCoordinate, of: &str| {
            result(summary, &format!("{name}.neutral.{k}.{}{of}", free.name))
        };
        let parts = start.free.iter().filter_map(|free| part(free, ""));
        let Some(largest) = parts.map(f64::abs).reduce(f64::max) else {
            continue;
        };
        let place = || format!("{name}, neutral direction {k}");
        to.add(largest - 1.0, 1.0, "", place);
        for (free, start_at) in start.free.iter().zip(start.values()) {
            let at = result(summary, &format!("{name}.{}", free.name));
            if let (Some(at), Some(from), Some(end)) = (at, part(free, ".from"), part(free, ".to"))
            {
                to.add((from - at).max(at - end).max(0.0), free.size, "", place);
                // The start is one of them: it is the nearest.
                let is_start = name == "equilibrium" && (from..=end).contains(&start_at);
                if is_start {
                    to.add(at - start_at, free.size, "", place);
                }
            }
        }
    }
}

/// Checks that at most a revolution of an angle is searched, and that the start is within.
fn add_searched(to: &mut Differences, start: &Start, summary: &Json) {
    for (free, from) in start.free.iter().zip(start.values()) {
        let end = |end: &str| result(summary, &format!("searched.{}.{end}", free.name));
        let (Some(low), Some(high)) = (end("from"), end("to")) else {
            continue;
        };
        let outside = (low - from).max(from - high).max(0.0);
        to.add(outside, free.size, "", || {
            format!("{}: the start is not searched", free.name)
        });
        let place = || format!("{}, extent of the search", free.name);
        let is_whole = start.free.len() > 1 && free.is_angle;
        let difference = match is_whole {
            true => high - low - TAU,
            false => (low - high).max(0.0),
        };
        to.add(difference, TAU.max(low.abs()), "", place);
    }
}

/// The words for the stability of eigenvalues whose error is known; `None` if zero is within it.
fn word(values: &[Complex], error: f64) -> Option<&'static str> {
    let parts = values.iter().map(|[re, _]| *re);
    let largest = parts.fold(f64::NEG_INFINITY, f64::max);
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
        let error = result(summary, &format!("{name}.error.eigenvalues")).unwrap_or(0.0);
        let values = eigenvalues(summary, name);
        let grows = values.iter().any(|[re, _]| *re > error);
        let expected = match is_neutral(summary, name) {
            true if grows => Some("unstable"),
            true => Some("neutral"),
            false => word(&values, error),
        };
        let Some(expected) = expected else {
            continue;
        };
        let said = said.get(k);
        to.require(said == Some(&expected), || {
            format!("{name} is {expected}, and printed is {said:?}")
        });
    }
}

/// Whether equilibria go on from one along a direction.
pub(super) fn is_neutral(summary: &Json, name: &str) -> bool {
    let start = format!("{name}.neutral");
    let results = summary["results"].as_object();
    results.is_some_and(|all| all.keys().any(|key| key.starts_with(&start)))
}

/// The rows of `statics` over the interval that was searched: the smallest and largest static force, and an equilibrium wherever the force
/// changes its sign.
fn static_force(
    compared: &mut Compared,
    program: &Program,
    start: &Start,
    summary: &Json,
) -> Result<(), String> {
    let [free] = start.free.as_slice() else {
        return Ok(());
    };
    let end = |end: &str| result(summary, &format!("searched.{}.{end}", free.name));
    let (Some(from), Some(to), Some(drives)) = (end("from"), end("to"), start.drives_at_rest())
    else {
        return Ok(());
    };
    // Friction that holds is no load of `statics`.
    if holds(&start.scene) {
        return Ok(());
    }
    let Some([places, forces]) = static_rows(program, start, free, [from, to])? else {
        return Ok(());
    };
    let found = compared.of("written-static-force");
    let ends = ["min", "max"].map(|end| result(summary, &format!("static_force.{end}")));
    if let [Some(low), Some(high)] = ends {
        let [low_row, high_row] = extent(&forces);
        let scale = low.abs().max(high.abs());
        // A drive at rest adds the same everywhere.
        found.add(
            (high - low) - (high_row - low_row),
            scale,
            "",
            || "largest less smallest",
        );
        if drives == 0 {
            found.add(low - low_row, scale, "", || "the smallest");
        }
    }
    if drives == 0 {
        add_balanced(found, summary, free, [&places, &forces]);
        let count = result(summary, "equilibria").unwrap_or(0.0) as usize;
        let at = |k: usize| result(summary, &format!("equilibrium.{k}.{}", free.name));
        let known: Vec<f64> = (1..=count).filter_map(at).collect();
        add_sign_changes(found, &known, [&places, &forces]);
    }
    Ok(())
}

/// Whether there is friction that is not zero at rest.
fn holds(scene: &Table) -> bool {
    let all = scene.get("friction").and_then(Value::as_table);
    all.is_some_and(|all| {
        all.values()
            .any(|one| one.get("regularization-speed").is_none())
    })
}

/// Coordinates, and the static forces of the loads there; `None` if the loads are rejected, as loads that depend on
/// time.
fn static_rows(
    program: &Program,
    start: &Start,
    free: &FreeCoordinate,
    interval: [f64; 2],
) -> Result<Option<[Vec<f64>; 2]>, String> {
    let mut scene = start.scene.clone();
    for section in ["motion", "prescribed", "coordinate-sweep"] {
        scene.remove(section);
    }
    let ends = interval.map(|q| q / free.unit).to_vec();
    let sweep = value_of([(free.name.as_str(), ends.into())]);
    scene.insert("coordinate-sweep".to_owned(), sweep);
    let arguments = ["statics", "--points", POSITIONS];
    let Ok(run) = program.run("static-force", &text_of(&scene)?, &arguments) else {
        return Ok(None);
    };
    let mut rows = run.csv("-statics.csv")?;
    let mut column = |name: &str| rows.columns.remove(name).ok_or(format!("no column {name}"));
    // The actuator holds what the loads do.
    let forces = column(&format!("{}.actuator_force", free.name))?;
    let forces = forces.iter().map(|f| -f).collect();
    Ok(Some([column(&free.name)?, forces]))
}

/// Where every position is an equilibrium, no row has a force.
fn add_balanced(
    to: &mut Differences,
    summary: &Json,
    free: &FreeCoordinate,
    [places, forces]: [&[f64]; 2],
) {
    let largest = largest(forces);
    let count = result(summary, "equilibria").unwrap_or(0.0) as usize;
    for k in 1..=count {
        let end = |end: &str| {
            let key = format!("equilibrium.{k}.neutral.1.{}.{end}", free.name);
            result(summary, &key)
        };
        let (Some(from), Some(end)) = (end("from"), end("to")) else {
            continue;
        };
        let within = |q: &f64| (from..=end).contains(q);
        for (q, force) in places.iter().zip(forces).filter(|(q, _)| within(q)) {
            to.add(*force, largest, "", || {
                format!("equilibrium {k} goes on to {q}")
            });
        }
    }
}

/// Checks that there is an equilibrium between two rows with forces of different sign.
fn add_sign_changes(to: &mut Differences, known: &[f64], [places, forces]: [&[f64]; 2]) {
    let [low, high] = extent(forces);
    let clear = 1e-9 * low.abs().max(high.abs());
    for (q, force) in places.windows(2).zip(forces.windows(2)) {
        let is_change = force[0] * force[1] < 0.0 && force.iter().all(|f| f.abs() > clear);
        if !is_change {
            continue;
        }
        let [from, to_here] = [q[0].min(q[1]), q[0].max(q[1])];
        let slack = 1e-6 * (to_here - from);
        let mut near = known.iter();
        let is_known = near.any(|k| (from - slack..=to_here + slack).contains(k));
        to.require(is_known, || {
            format!("no equilibrium between {from} and {to_here}, where the force changes its sign")
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_missing_equilibrium_is_found() {
        let [places, forces] = [[0.0, 1.0, 2.0], [1.0, -1.0, -2.0]];
        for (known, passes) in [(vec![0.5], true), (vec![1.5], false), (vec![], false)] {
            let mut found = Differences::default();
            add_sign_changes(&mut found, &known, [&places, &forces]);
            assert_eq!(found.failure().is_none(), passes, "{known:?}");
        }
    }

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
