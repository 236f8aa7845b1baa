//! The printed text of `check`, against its summary; and its text on requests, against the same scene with others.

use super::compared::Compared;
use super::difference::Differences;
use super::program::Program;
use super::scene_text::{Scene, entries, text_of, value_of};
use super::stated::{Expected, expected, sentence_differences};
use serde_json::Value;

/// The sentences of `check` on a scene.
pub(super) fn compare_contents(
    compared: &mut Compared,
    program: &Program,
    scene: &Scene,
) -> Result<(), String> {
    let run = program.run("contents", &text_of(&scene.table)?, &["check"])?;
    let summary = run.json("-check.json")?;
    let mut lines = sentences(&summary, scene);
    // A number in a name is not one of the line's.
    lines.retain(|(start, _)| !start.split_whitespace().any(is_number));
    let mut printed = sentence_differences(&run.printed, &lines, "check");
    for what in counts(&summary) {
        printed.require(run.printed.contains(&what), || {
            format!("`check` does not say `{what}`")
        });
    }
    add_modes(&mut printed, &run.printed);
    add_requests(&mut printed, program, &scene.table, &run.printed)?;
    compared.merge("written-contents-sentences", printed);
    Ok(())
}

/// The sentences of `check` that count.
fn counts(summary: &Value) -> impl Iterator<Item = String> {
    let names = [
        ("moving_bodies", "moving body", "moving bodies"),
        ("joints", "joint", "joints"),
        (
            "degrees_of_freedom",
            "degree of freedom",
            "degrees of freedom",
        ),
    ];
    names.into_iter().map(|(name, one, many)| {
        let count = summary["results"][name]["value"].as_f64();
        match count.unwrap_or(f64::NAN) {
            1.0 => format!("1 {one}"),
            count => format!("{count} {many}"),
        }
    })
}

/// Whether a word of a name reads as a number.
fn is_number(word: &str) -> bool {
    let word = word.trim_end_matches(':');
    word.parse::<f64>().is_ok_and(f64::is_finite)
}

/// The beginnings of printed lines, and the numbers of the summary that follow.
// Long because it is the list of all lines.
fn sentences(summary: &Value, scene: &Scene) -> Vec<(String, Vec<Expected>)> {
    let length = scene.units.length;
    let mut lines: Vec<(String, Vec<Expected>)> = Vec::new();
    let mut add = |start: String, parts: &[(&[String], f64)]| {
        let numbers = parts.iter().map(|(names, unit)| {
            let names: Vec<&str> = names.iter().map(String::as_str).collect();
            expected(summary, &names, *unit)
        });
        let numbers: Option<Vec<Vec<Expected>>> = numbers.collect();
        lines.extend(numbers.map(|numbers| (start, numbers.concat())));
    };
    let of = |name: &str, ends: &[&str]| -> Vec<String> {
        let named = ends.iter().map(|end| format!("{name}{end}"));
        named.collect()
    };
    // Of the plane and of space: the other has no such numbers.
    for ends in [&[".width", ".height"][..], &[".x", ".y", ".z"]] {
        let start = "overall size at the start: ".to_owned();
        add(start, &[(&of("size", ends), length)]);
    }
    let is_in_space = expected(summary, &["size.z"], 1.0).is_some();
    let axes: &[&str] = if is_in_space {
        &[".x", ".y", ".z"]
    } else {
        &[".x", ".y"]
    };
    let center = of("mass.center", axes);
    let mass = of("mass", &[""]);
    add(
        "moving mass ".to_owned(),
        &[(&mass, 1.0), (&center, length)],
    );
    for (body, _) in scene.moving_bodies() {
        let [mass, start] = ["mass.", "start."].map(|of| format!("{of}{body}"));
        let inertia = match is_in_space {
            true => of(&format!("inertia.{body}"), &[".xx", ".yy", ".zz"]),
            false => of(&format!("inertia.{body}"), &[""]),
        };
        add(
            format!("{body}: "),
            &[(&of(&mass, &[""]), 1.0), (&inertia, 1.0)],
        );
        let degree = 1_f64.to_radians();
        if is_in_space {
            let position = of(&format!("{start}.position"), axes);
            let rotation = of(&format!("{start}.rotation"), axes);
            add(
                format!("{body} "),
                &[(&position, length), (&rotation, degree)],
            );
        } else {
            let angle = of(&start, &[".angle"]);
            add(format!("{body} "), &[(&angle, 1.0), (&angle, degree)]);
        }
    }
    let unit_of = |name: &str| scene.coordinate(name).map_or(1.0, |c| c.unit);
    let mut motion: Vec<(Vec<String>, f64)> = Vec::new();
    for actuator in &scene.actuators {
        let name = format!("free_motion.{}", actuator.name);
        motion.push((of(&name, &["", ".velocity"]), actuator.unit));
    }
    motion.push((of("free_motion", &[".duration"]), 1.0));
    let motion: Vec<(&[String], f64)> = motion.iter().map(|(n, u)| (&n[..], *u)).collect();
    add("free motion: ".to_owned(), &motion);
    let prescribed = of("prescribed", &[".duration", ".positions"]);
    add("prescribed motion: ".to_owned(), &[(&prescribed, 1.0)]);
    for (name, stop) in entries(&scene.table, "stops") {
        let of_stop = |ends: &[&str]| of(&format!("stop.{name}"), ends);
        let limits: Vec<&str> = [("min", ".min"), ("max", ".max")]
            .into_iter()
            .filter_map(|(key, end)| stop.contains_key(key).then_some(end))
            .collect();
        let coordinate = stop.get("coordinate").and_then(toml::Value::as_str);
        let limits = of_stop(&limits);
        let unit = unit_of(coordinate.unwrap_or(""));
        for rest in [&[".restitution"][..], &[".stiffness"]] {
            let start = format!("end stop {name}: ");
            add(start, &[(&limits, unit), (&of_stop(rest), 1.0)]);
        }
    }
    lines
}

/// The line of `check` on requested reactions.
fn requested_in(printed: &str) -> Option<&str> {
    let mut lines = printed.lines();
    lines.find_map(|line| line.trim().strip_prefix("reactions requested: "))
}

/// The number of reactions that are not requested: all reactions minus the listed ones.
fn add_requests(
    to: &mut Differences,
    program: &Program,
    scene: &toml::Table,
    printed: &str,
) -> Result<(), String> {
    let mut everything = scene.clone();
    everything.remove("requests");
    let run = program.run("all-reactions", &text_of(&everything)?, &["check"])?;
    let all = run.printed;
    add_single_request(to, program, &everything, &all)?;
    let listed = |printed: &str| -> Option<(usize, usize)> {
        let rest = requested_in(printed)?;
        let (names, others) = rest.split_once(" (").unwrap_or((rest, "0"));
        let count = names.split(", ").filter(|name| *name != "none").count();
        let others = others.split(' ').next()?.parse().unwrap_or(0);
        Some((count, others))
    };
    if let (Some((these, others)), Some((all, more))) = (listed(printed), listed(&all)) {
        let difference = (these + others) as f64 - (all + more) as f64;
        to.add(
            difference,
            1.0,
            "",
            || "reactions that are requested, and others",
        );
        to.add(more as f64, 1.0, "", || "others where all are requested");
    }
    Ok(())
}

/// A single component that is requested is the one that is listed, and all others are not computed.
fn add_single_request(
    to: &mut Differences,
    program: &Program,
    scene: &toml::Table,
    all: &str,
) -> Result<(), String> {
    let names = requested_in(all).unwrap_or_default().split(", ");
    let names: Vec<&str> = names.collect();
    // The last of a joint with several: the first would be taken for it most easily.
    let Some(name) = names.last().filter(|name| name.contains('.')) else {
        return Ok(());
    };
    let mut single = scene.clone();
    let requests = value_of([("reactions", vec![*name].into())]);
    single.insert("requests".to_owned(), requests);
    let run = program.run("single-reaction", &text_of(&single)?, &["check"])?;
    let printed = run.printed;
    let others = match names.len() - 1 {
        0 => String::new(),
        others => format!(" ({others} others are neither requested nor computed)"),
    };
    let said = requested_in(&printed).unwrap_or_default();
    to.require(said == format!("{name}{others}"), || {
        format!("`check` with {name} alone requested lists `{said}`")
    });
    add_single_path(to, program, single);
    Ok(())
}

/// Requests the path of one point with one reaction: only this point has columns. Skipped if the rows are rejected.
fn add_single_path(to: &mut Differences, program: &Program, mut scene: toml::Table) {
    let points = named_points(&scene);
    let Some(asked) = points.iter().rfind(|at| at.body != "ground") else {
        return;
    };
    if let Some(toml::Value::Table(requests)) = scene.get_mut("requests") {
        requests.insert("paths".to_owned(), vec![asked.name()].into());
    }
    // `kinematics`, which has no reactions, gives everything.
    let arguments = ["statics", "--points", "3"];
    let run = |text: String| program.run("single-path", &text, &arguments).ok();
    let run = text_of(&scene).ok().and_then(run);
    let Some(Ok(rows)) = run.map(|run| run.csv("-statics.csv")) else {
        return;
    };
    let has = |at: &NamedPoint| rows.columns.contains_key(&format!("{}.x", at.name()));
    // Another name of the same point stands for it.
    let is_asked = |at: &NamedPoint| at.body == asked.body && at.place == asked.place;
    let is_there = points.iter().any(|at| is_asked(at) && has(at));
    to.require(is_there, || {
        format!("`statics` has no column of the path of {}", asked.name())
    });
    if let Some(other) = points.iter().find(|at| !is_asked(at) && has(at)) {
        let [other, asked] = [other, asked].map(NamedPoint::name);
        to.fail(format!(
            "`statics` has columns of {other}, where only the path of {asked} is requested"
        ));
    }
}

/// A point of a body by the scene's text.
struct NamedPoint {
    body: String,
    point: String,
    place: toml::Value,
}

impl NamedPoint {
    fn name(&self) -> String {
        format!("{}.{}", self.body, self.point)
    }
}

/// All points that are named.
fn named_points(scene: &toml::Table) -> Vec<NamedPoint> {
    let of_body = |(body, keys): (&String, &toml::Table)| -> Vec<NamedPoint> {
        let points = keys.get("points").and_then(toml::Value::as_table);
        let named = |(point, place): (&String, &toml::Value)| NamedPoint {
            body: body.clone(),
            point: point.clone(),
            place: place.clone(),
        };
        points.into_iter().flatten().map(named).collect()
    };
    entries(scene, "bodies").flat_map(of_body).collect()
}

/// A dyad with three pins has two assembly modes, which are listed below its group.
fn add_modes(to: &mut Differences, printed: &str) {
    let lines: Vec<&str> = printed.lines().map(str::trim).collect();
    let dyads = (0..lines.len()).filter(|k| lines[*k].contains(" unknowns, pinned dyad"));
    for k in dyads {
        let next = [k + 1, k + 2].map(|k| lines.get(k).copied().unwrap_or(""));
        let starts = ["assembly mode in use: ", "other assembly mode: "];
        let is_listed = (0..2).all(|k| next[k].starts_with(starts[k]));
        to.require(is_listed, || {
            format!("`check` lists no two assembly modes of `{}`", lines[k])
        });
    }
}
