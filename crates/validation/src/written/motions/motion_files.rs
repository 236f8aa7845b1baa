//! The findings over the motions of a case.

use super::between_rows::between_rows;
use super::events::{change_points, missing_events};
use super::motors::motors;
use super::row_forces::MotionReading;
use super::summary::{sentences, summary_of_rows};
use crate::written::poses::closure::closure;
use crate::written::poses::compared::Compared;
use crate::written::poses::difference::Differences;
use crate::written::poses::extrema_again::same_extrema;
use crate::written::poses::formats::formats;
use crate::written::poses::headings::heading_differences;
use crate::written::poses::joint_forces::joint_force_differences;
use crate::written::poses::positions::corners;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::rates::rates;
use crate::written::poses::reading::Reading;
use crate::written::poses::rows::{Rows, largest};
use crate::written::poses::scene_text::{requests_everything, text_of};

/// The accuracy of one of the runs.
const ACCURACY: &str = "1e-8";

/// Intervals between the rows of another.
const OTHER_ROWS: f64 = 131.7;

/// Runs `simulate` on a scene and compares its files; nothing of a scene without a motion.
// Long because it is the list of all runs of a motion and what is compared of them.
pub(crate) fn compare(
    compared: &mut Compared,
    program: &Program,
    scene: &str,
) -> Result<(), String> {
    let everything = requests_everything(scene)?;
    if !everything.contains_key("motion") {
        return Ok(());
    }
    let text = text_of(&everything)?;
    let motion = MotionReading::new(&text)?;
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
    let files = ["simulate", "simulate by dop853", "simulate --accuracy"];
    for (rows, file) in [&rows, &rows_again, &rows_wanted].into_iter().zip(files) {
        compare_rows(compared, &motion, rows, file)?;
    }
    let other_rows = other_rows(run, &rows)?;
    let events =
        [&first, &again, &wanted, &other_rows].map(|run| run.csv("-motion-events.csv").ok());
    let again = compared.of("written-motion-again");
    for (other, its_events) in [(&rows_again, &events[1]), (&rows_wanted, &events[2])] {
        again.merge(same_motion(&motion.reading, [&rows, other]));
        again.merge(same_events(&rows, [&events[0], its_events]));
    }
    again.merge(same_events(&rows, [&events[0], &events[3]]));
    let summaries = [&first, &other_rows].map(|run| run.json("-simulate.json"));
    if let [Ok(one), Ok(other)] = &summaries {
        let what = "simulate and simulate by esdirk34 in other rows";
        let same = same_extrema([one, other], what);
        compared.merge("written-motion-extrema-again", same);
    }
    // Both are free of the error of the default method.
    let accurate = same_motion(&motion.reading, [&rows_wanted, &rows_again]);
    compared.merge("written-motion-accuracy", accurate);
    compared.merge("written-motion-accuracy", stated_accuracy(&wanted)?);
    let missing = missing_events(&motion.reading, &everything, &rows, events[0].as_ref());
    compared.merge("written-motion-events", missing);
    let contents = program.run("contents", &text, &["check"])?;
    let points = change_points(&contents.printed, &first.printed, &rows);
    compared.merge("written-motion-change-points", points);
    for (run, rows, events) in [
        (&first, &rows, &events[0]),
        (&wanted, &rows_wanted, &events[2]),
    ] {
        compare_summary(compared, &motion, run, rows, events.as_ref())?;
    }
    Ok(())
}

/// The files and sentences of one run with each other.
fn compare_summary(
    compared: &mut Compared,
    motion: &MotionReading,
    run: &Run,
    rows: &Rows,
    events: Option<&Rows>,
) -> Result<(), String> {
    let of = formats(run, "motion", "simulate", &corners(&motion.reading))?;
    compared.merge("written-motion-files", of.files);
    let file = run.text("-motion.csv")?;
    let headings = heading_differences(&file, &motion.reading, "simulate");
    compared.merge("written-motion-headings", headings);
    compared.merge("written-motion-extrema", of.extrema);
    compared.merge("written-motion-places", of.places);
    compared.merge("written-motion-sentences", of.printed);
    let summary = run.json("-simulate.json")?;
    compared.merge(
        "written-motion-summary",
        summary_of_rows(&summary, rows, events),
    );
    compared.merge("written-motion-sentences", sentences(run, &summary));
    Ok(())
}

fn compare_rows(
    compared: &mut Compared,
    motion: &MotionReading,
    rows: &Rows,
    file: &str,
) -> Result<(), String> {
    let of = closure(&motion.reading, rows, file);
    compared.merge("written-motion-closure", of.joints);
    let pins = joint_force_differences(&motion.reading, rows, file);
    compared.merge("written-motion-joint-forces", pins);
    let of_motors = motors(motion, rows, file);
    compared.merge("written-motion-motors", of_motors.electrical);
    compared.merge("written-motion-efficiency", of_motors.delivered);
    let of = motion.compare(rows, file);
    let of = of.ok_or_else(|| format!("{file}: a column is missing"))?;
    let energy = between_rows(motion, &of, rows, file);
    compared.merge("written-motion-energy", energy.balance);
    compared.merge("written-motion-energies", energy.columns);
    compared.merge("written-motion-equations", of.equations);
    compared.merge("written-motion-forces", of.forces);
    compared.merge("written-motion-rates", rates(&motion.reading, rows, file));
    Ok(())
}

/// The motion once more by another method, with rows at other times, which do not meet those of the first.
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
    let of = |name: &str| summary["results"][name]["value"].as_f64();
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
fn same_motion(reading: &Reading, both: [&Rows; 2]) -> Differences {
    let mut to = Differences::default();
    for coordinate in reading.actuators() {
        for end in ["", ".velocity"] {
            let name = format!("{}{end}", coordinate.name);
            let scale = largest(both[1].column(&name));
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
