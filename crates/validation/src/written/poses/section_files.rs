//! The files of internal forces of drawn links.

use super::difference::Differences;
use super::positions::Case;
use super::reading::Reading;
use super::rows::{Rows, largest};
use super::scene_text::{table_of, text_of, value_of};
use super::sections::{Link, links, sections};
use super::stated::{result, sentence_differences};

/// Links of a case whose internal forces are compared.
const LINKS: usize = 2;

/// The internal forces of drawn links, in the row where the program has found the largest bending moment.
pub(super) fn compare_sections(case: &mut Case<'_>, scene: &str) -> Result<(), String> {
    let reading = case.reading;
    let mut links = links(reading);
    let drawn: Vec<_> = (0..LINKS.min(links.len()))
        .map(|_| links.remove(case.draws.below(links.len())))
        .collect();
    if drawn.is_empty() {
        return Ok(());
    }
    let arguments = ["kinetostatics", "--points", "37"];
    let scene = requesting_sections(scene, reading, &drawn)?;
    let run = case.run("sections", &scene, &arguments)?;
    let rows = run.csv("-kinetostatics.csv")?;
    let summary = run.json("-kinetostatics.json")?;
    let abscissa = summary["extrema_over"]["name"].as_str().unwrap_or("t");
    for link in &drawn {
        let body = &reading.bodies[link.body].name;
        let [from, to] = &link.names;
        let cuts = run.csv(&format!(
            "-kinetostatics-internal-forces-{body}.{from}.{to}.csv"
        ))?;
        let name = format!("{body} from {from} to {to}.bending_moment");
        let at = result(&summary, &format!("{name}.at"));
        let is_there = |x: &f64| at.is_some_and(|at| (x - at).abs() <= 1e-12 * (1.0 + at.abs()));
        let Some(row) = rows.column(abscissa).iter().position(is_there) else {
            let reason = format!("the largest {name} is at {at:?}, which is no row");
            case.compared.fail("written-sections", reason);
            continue;
        };
        let of = sections(reading, &rows, row, link, &cuts);
        case.merge("written-sections", of.cuts);
        case.merge("written-section-ends", of.ends);
        let file = format!("-kinetostatics-internal-forces-{body}.{from}.{to}.envelope.csv");
        case.merge("written-envelope", within(&cuts, &run.csv(&file)?, &name));
        // The largest moment that is printed is one of the cuts.
        let said = result(&summary, &name).unwrap_or(f64::NAN);
        case.merge(
            "written-sentences",
            moment_sentence(&run.printed, [body, from, to], said),
        );
        let largest = largest(cuts.column("bending"));
        case.compared.add(
            "written-files",
            said.abs() - largest,
            largest,
            "N m",
            || name.clone(),
        );
    }
    Ok(())
}

/// The sentence about the largest bending moment of a link: its value, and the end from which its station is counted.
fn moment_sentence(printed: &str, [body, from, to]: [&str; 3], said: f64) -> Differences {
    let start = format!("bending moment of {body} from {from} to {to}: ");
    let line = [(start.clone(), vec![(said, said.abs())])];
    let mut all = sentence_differences(printed, &line, "kinetostatics");
    let mut lines = printed
        .lines()
        .map(str::trim_start)
        .filter(|line| line.starts_with(&start));
    let end = format!(" from {from}, at ");
    if lines.any(|line| !line.contains(&end)) {
        all.fail(format!(
            "the station in `{start}` is not counted from {from}"
        ));
    }
    all
}

/// Every cut is within the envelope of its station, which goes nowhere beyond the largest bending moment.
fn within(cuts: &Rows, envelope: &Rows, link: &str) -> Differences {
    let mut all = Differences::default();
    let scale = |name: &str| largest(cuts.column(name));
    let forces = scale("axial").max(scale("shear"));
    for (name, scale) in [
        ("axial", forces),
        ("shear", forces),
        ("bending", scale("bending")),
    ] {
        let of = |end: &str| envelope.columns.get(&format!("{name}.{end}"));
        let (Some(values), Some(min), Some(max)) = (cuts.columns.get(name), of("min"), of("max"))
        else {
            all.fail(format!("{link}: no envelope of {name}"));
            continue;
        };
        let stations = envelope.column("station");
        for (row, value) in values.iter().enumerate() {
            let at = cuts.get(row, "station").unwrap_or(f64::NAN);
            let aside = |k: &usize| (stations[*k] - at).abs();
            let nearest = (0..stations.len()).min_by(|a, b| aside(a).total_cmp(&aside(b)));
            // Stations on both sides of a concentrated load are cuts of their own.
            let Some(k) = nearest.filter(|k| aside(k) <= 1e-12 * (1.0 + at.abs())) else {
                continue;
            };
            let beyond = (min[k] - value).max(value - max[k]).max(0.0);
            all.add(beyond, scale, "", || format!("{link}, {name} at {at}"));
        }
        if name == "bending" {
            // Its station need not be one of the envelope, but none of those has a larger one.
            let beyond = (largest(min).max(largest(max)) - scale).max(0.0);
            all.add(beyond, scale, "N m", || {
                format!("{link}, the largest bending moment")
            });
        }
    }
    all
}

fn requesting_sections(scene: &str, reading: &Reading, drawn: &[Link]) -> Result<String, String> {
    let mut scene = table_of(scene)?;
    let request = |link: &Link| {
        let [from, to] = &link.names;
        let body = &reading.bodies[link.body].name;
        let entries = [("body", body), ("from", from), ("to", to)];
        value_of(entries.map(|(key, value)| (key, value.as_str().into())))
    };
    let requested = toml::Value::Array(drawn.iter().map(request).collect());
    let requests = value_of([("sections", requested)]);
    scene.insert("requests".to_owned(), requests);
    text_of(&scene)
}
