//! The findings over the motions of a case.

use super::change_points::change_points;
use crate::written::poses::compared::Compared;
use crate::written::poses::difference::Differences;
use crate::written::poses::extrema_again::same_extrema;
use crate::written::poses::largest_values::printed_extrema;
use crate::written::poses::printed_numbers::sentences;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::rows::{Rows, largest};
use crate::written::poses::scene_text::{Coordinate, Scene, text_of, value_of};
use crate::written::poses::stated::result;
use toml::Table;

/// The accuracy of one of the runs.
const ACCURACY: &str = "1e-8";

/// Speed of a free motion that the scene does not give, rad/s or sizes/s, and how long it lasts, s.
const SPEED: f64 = 1.5;
const DURATION: f64 = 0.3;

/// Intervals between the rows of another.
const OTHER_ROWS: f64 = 131.7;

/// Runs `simulate` on a scene and compares its files. Scenes without a motion are skipped, except those in space with one
/// actuator.
pub(crate) fn compare(
    compared: &mut Compared,
    program: &Program,
    scene: &Scene,
) -> Result<(), String> {
    let Some(text) = with_motion(scene) else {
        return Ok(());
    };
    let text = text_of(&text)?;
    let run = |name: &str, options: &[&str]| {
        let arguments = [&["simulate"], options].concat();
        program.run(name, &text, &arguments)
    };
    let first = run("simulate", &[])?;
    let again = run("again", &["--method", "dop853", "--rtol", "1e-12"])?;
    // By quadrature where the motion has one, by a table or the cheapest method elsewhere.
    let wanted = run("accuracy", &["--accuracy", ACCURACY])?;
    let rows = first.csv("-motion.csv")?;
    let (rows_again, rows_wanted) = (again.npz("-motion.npz")?, wanted.csv("-motion.csv")?);
    let other_rows = other_rows(run, &rows)?;
    let events =
        [&first, &again, &wanted, &other_rows].map(|run| run.csv("-motion-events.csv").ok());
    // After many impacts two motions are no longer near each other.
    let is_same = !scene.has("stops");
    let again = compared.of("written-motion-again");
    let others = [(&rows_again, &events[1]), (&rows_wanted, &events[2])];
    for (other, its_events) in others.into_iter().filter(|_| is_same) {
        again.merge(same_motion(&scene.actuators, [&rows, other]));
        again.merge(same_events(&rows, [&events[0], its_events]));
        again.merge(same_events(&rows, [&events[0], &events[3]]));
    }
    let summaries = [&first, &other_rows].map(|run| run.json("-simulate.json"));
    if let [Ok(one), Ok(other)] = &summaries {
        let what = "simulate and simulate by esdirk34 in other rows";
        let same = same_extrema([one, other], what);
        compared.merge("written-motion-extrema-again", same);
    }
    // Both are free of the error of the default method.
    if is_same {
        let accurate = same_motion(&scene.actuators, [&rows_wanted, &rows_again]);
        compared.merge("written-motion-accuracy", accurate);
    }
    // In space the summary does not say which accuracy was asked for.
    if !scene.is_in_space() {
        compared.merge("written-motion-accuracy", stated_accuracy(&wanted)?);
    }
    let contents = program.run("contents", &text, &["check"])?;
    let points = change_points(&contents.printed, &first.printed, &rows);
    compared.merge("written-motion-change-points", points);
    for run in [&first, &wanted] {
        let found = compared.of("written-motion-sentences");
        found.merge(printed_extrema(run, "simulate")?);
        found.merge(sentences(run, &run.json("-simulate.json")?));
    }
    Ok(())
}

/// The scene without requests; in space with a free motion if it has none and one actuator.
fn with_motion(scene: &Scene) -> Option<Table> {
    let mut table = scene.everything();
    if scene.has("motion") {
        return Some(table);
    }
    let actuator = match &scene.actuators[..] {
        [actuator] if scene.is_in_space() => actuator,
        _ => return None,
    };
    let size = if actuator.is_angle { 1.0 } else { scene.size() };
    let motion = value_of([
        ("duration", DURATION.into()),
        ("initial-velocity", (SPEED * size / actuator.unit).into()),
    ]);
    table.insert("motion".to_owned(), motion);
    Some(table)
}

/// The motion by another method, with rows at other times than those of the first.
fn other_rows(
    run: impl Fn(&str, &[&str]) -> Result<Run, String>,
    rows: &Rows,
) -> Result<Run, String> {
    let end = rows.end();
    let interval = format!("{:e}", (end - rows.time(0)) / OTHER_ROWS);
    let method = ["--method", "esdirk34", "--rtol", "1e-9"];
    run(
        "other-rows",
        &[&method[..], &["--sample-interval", &interval]].concat(),
    )
}

/// The stated errors of a motion to an accuracy are below it, or the accuracy is not reached.
fn stated_accuracy(wanted: &Run) -> Result<Differences, String> {
    let summary = wanted.json("-simulate.json")?;
    let of = |name: &str| result(&summary, name);
    let mut found = Differences::default();
    let Some(accuracy) = of("accuracy") else {
        found.fail("the summary does not say which accuracy was asked for");
        return Ok(found);
    };
    let is_reached = !wanted.messages.contains("is not reached");
    for name in ["coordinates", "kinetic_energy", "reactions"] {
        let error = of(&format!("error.{name}")).unwrap_or(0.0);
        found.require(!is_reached || error <= accuracy, || {
            format!("the stated error of {name}, {error:.1e}, is above the accuracy of {accuracy:.1e} that is said to be reached")
        });
    }
    Ok(found)
}

/// The events of two motions: as many, of the same kinds, at the same times.
fn same_events(rows: &Rows, events: [&Option<Rows>; 2]) -> Differences {
    let mut same = Differences::default();
    match events {
        [Some(events), Some(others)] => {
            let end = rows.end();
            same_column(&mut same, "t", [events, others], end, "events");
            same_column(&mut same, "event", [events, others], 1.0, "events");
        }
        [None, None] => {}
        _ => same.fail("events in a file of one run alone"),
    }
    same
}

/// The coordinates of two motions of the same rows.
fn same_motion(actuators: &[Coordinate], both: [&Rows; 2]) -> Differences {
    let mut to = Differences::default();
    for end in ["", ".velocity"] {
        let names = actuators.iter().map(|a| format!("{}{end}", a.name));
        let names: Vec<String> = names.collect();
        let columns = names.iter().flat_map(|name| both[1].column(name));
        let scale = largest(columns);
        for name in names {
            same_column(&mut to, &name, both, scale, "rows");
        }
    }
    to
}

fn same_column(to: &mut Differences, name: &str, [one, other]: [&Rows; 2], scale: f64, what: &str) {
    let columns = (one.columns.get(name), other.columns.get(name));
    let (Some(one), Some(other)) = columns else {
        to.fail(format!("{what} have no column {name}"));
        return;
    };
    if one.len() != other.len() {
        to.fail(format!(
            "{what}: {} by one method, {} by another",
            one.len(),
            other.len()
        ));
        return;
    }
    let differences = one.iter().zip(other).map(|(one, other)| one - other);
    to.add_rows(differences, scale, "", |row| {
        format!("{what}, {row}, {name}")
    });
}
