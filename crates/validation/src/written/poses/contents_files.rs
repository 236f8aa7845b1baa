//! What `check` writes and prints of a scene: masses, the centre of mass, size and angles at the start, against the scene's text
//! and the first row of a motion from there.

use super::contents_motions::motion_lines;
use super::difference::Differences;
use super::motion::Motion;
use super::overshoot::warning_count;
use super::program::Program;
use super::reading::{Body, JointKind, Reading};
use super::rows::{Rows, extent};
use super::scene_text::{table_of, text_of, value_of, without_forces};
use super::stated::{Expected, result, sentence_differences, summary_differences};
use serde_json::Value;

/// Part of a sweep, rad or m, whose first row is the start.
const STEP: f64 = 1e-6;

/// The summary, the sentences and the warnings of `check` on a scene.
pub(super) fn contents_differences(
    program: &Program,
    reading: &Reading,
    scene: &str,
) -> Result<[Differences; 3], String> {
    let run = program.run("contents", scene, &["check"])?;
    let summary = run.json("-check.json")?;
    let rows = start_of(program, reading, scene, &summary)?;
    let start = Motion::new(reading, &rows, 0).ok_or("no row of the start")?;
    let expected = contents_of(&start);
    let numbers = expected.iter();
    let numbers = numbers.map(|(name, value, scale)| (name.as_str(), (*value, *scale)));
    let summed = summary_differences(&summary, numbers, "check");
    let table = table_of(scene)?;
    let mut lines = sentences(&expected, reading);
    lines.extend(motion_lines(reading, &table));
    let mut printed = sentence_differences(&run.printed, &lines, "check");
    add_modes(&mut printed, &run.printed);
    add_requests(&mut printed, program, &table, &run.printed)?;
    Ok([summed, printed, warning_count(&table, &run.messages)])
}

/// What `check` prints of the reactions that are requested.
fn requested_in(printed: &str) -> Option<&str> {
    let mut lines = printed.lines();
    lines.find_map(|line| line.trim().strip_prefix("reactions requested: "))
}

/// How many reactions are not requested: all that there are without requests, less those that are listed.
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
        others => format!(" ({others} others are not computed: not requested)"),
    };
    let said = requested_in(&printed).unwrap_or_default();
    to.require(said == format!("{name}{others}"), || {
        format!("`check` with {name} alone requested lists `{said}`")
    });
    add_single_path(to, program, single);
    Ok(())
}

/// With one reaction the path of one point is requested: of all points it alone has columns. Nothing where the rows are refused.
fn add_single_path(to: &mut Differences, program: &Program, mut scene: toml::Table) {
    let bodies = scene.get("bodies").and_then(toml::Value::as_table);
    let points = named_points(bodies);
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
fn named_points(bodies: Option<&toml::Table>) -> Vec<NamedPoint> {
    let mut found = Vec::new();
    for (body, table) in bodies.into_iter().flatten() {
        let points = table.get("points").and_then(toml::Value::as_table);
        let named = |(point, place): (&String, &toml::Value)| NamedPoint {
            body: body.clone(),
            point: point.clone(),
            place: place.clone(),
        };
        found.extend(points.into_iter().flatten().map(named));
    }
    found
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

/// How the bodies are at the start, by the first row of a sweep from there.
fn start_of(
    program: &Program,
    reading: &Reading,
    scene: &str,
    summary: &Value,
) -> Result<Rows, String> {
    let mut scene = without_forces(scene)?;
    let mut sweep = toml::Table::new();
    for (k, coordinate) in reading.actuators().iter().enumerate() {
        let start = result(summary, &format!("start.{}", coordinate.name));
        let start =
            start.ok_or_else(|| format!("`check` writes no start of {}", coordinate.name))?;
        let unit = reading.unit_of(coordinate.measure);
        let value = match k {
            0 => vec![start / unit, (start + STEP) / unit].into(),
            _ => (start / unit).into(),
        };
        sweep.insert(coordinate.name.clone(), value);
    }
    scene.insert("coordinate-sweep".to_owned(), sweep.into());
    let run = program.run("start", &text_of(&scene)?, &["kinematics", "--points", "2"])?;
    run.csv("-kinematics.csv")
}

/// What a scene has, by its text and the places of its bodies: by name of the summary, value and scale.
fn contents_of(start: &Motion<'_>) -> Vec<(String, f64, f64)> {
    let reading = start.reading;
    let bodies = reading.bodies.iter().enumerate();
    let moving: Vec<(usize, &Body)> = bodies.filter(|(_, body)| !body.is_ground).collect();
    let mut numbers = vec![("moving_bodies".to_owned(), moving.len() as f64, 1.0)];
    let mass: f64 = moving.iter().map(|(_, body)| body.mass).sum();
    numbers.push(("mass".to_owned(), mass, mass));
    let joints = reading.joints.iter();
    let joints = joints.filter(|joint| !matches!(joint.kind, JointKind::Coupling { .. }));
    let places = joints.flat_map(|joint| joint.places);
    let points: Vec<[f64; 2]> = places.map(|place| start.point(place).order(0)).collect();
    let size = [0, 1].map(|k| {
        let [low, high] = extent(points.iter().map(|p| &p[k]));
        high - low
    });
    let scale = size[0].max(size[1]).max(reading.size());
    for (name, extent) in ["size.width", "size.height"].into_iter().zip(size) {
        numbers.push((name.to_owned(), extent, scale));
    }
    if mass > 0.0 {
        let mut sums = [0.0; 2];
        for (b, body) in &moving {
            let center = start.center(*b).order(0);
            sums = [0, 1].map(|k| sums[k] + body.mass * center[k]);
        }
        for (name, sum) in ["mass.center.x", "mass.center.y"].into_iter().zip(sums) {
            numbers.push((name.to_owned(), sum / mass, scale));
        }
    }
    for (b, body) in moving {
        if body.mass != 0.0 || body.inertia != 0.0 {
            numbers.push((format!("mass.{}", body.name), body.mass, body.mass));
            numbers.push((format!("inertia.{}", body.name), body.inertia, body.inertia));
        }
        let angle = start.bodies[b].angle.value();
        numbers.push((format!("start.{}.angle", body.name), angle, 1.0));
    }
    numbers
}

/// The beginnings of printed lines, and the numbers that follow, with their scales.
fn sentences(numbers: &[(String, f64, f64)], reading: &Reading) -> Vec<(String, Vec<Expected>)> {
    let of = |name: &str, unit: f64| {
        let found = numbers.iter().find(|(named, ..)| named == name);
        found.map(|(_, value, scale)| (value / unit, scale / unit))
    };
    let length = reading.units.length;
    let size: Vec<_> = ["size.width", "size.height"]
        .into_iter()
        .filter_map(|n| of(n, length))
        .collect();
    let mut all = vec![("overall size at the start: ".to_owned(), size)];
    let mut whole: Vec<_> = of("mass", 1.0).into_iter().collect();
    let centers = ["mass.center.x", "mass.center.y"].into_iter();
    whole.extend(centers.filter_map(|name| of(name, length)));
    if whole.len() == 3 {
        all.push(("moving mass ".to_owned(), whole));
    }
    for body in &reading.bodies {
        let named = ["mass", "inertia"].map(|what| of(&format!("{what}.{}", body.name), 1.0));
        if let [Some(mass), Some(inertia)] = named {
            all.push((format!("{}: ", body.name), vec![mass, inertia]));
        }
        if let Some((angle, _)) = of(&format!("start.{}.angle", body.name), 1.0) {
            let degrees = (angle.to_degrees(), 360.0);
            all.push((format!("{} ", body.name), vec![(angle, 1.0), degrees]));
        }
    }
    all
}
