//! The findings over the steady cycle of a case.

use super::multipliers::{Multiplier, multiplier_differences};
use crate::written::motions::{sentences, simpson};
use crate::written::poses::compared::Compared;
use crate::written::poses::difference::Differences;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::reading::{Measure, Reading};
use crate::written::poses::rows::{Rows, largest};
use crate::written::poses::scene_text::{table_of, text_of, value_of};
use crate::written::poses::stated::{result, sentence_differences};
use crate::written::poses::units::Units;
use serde_json::Value;
use std::f64::consts::{PI, TAU};
use toml::Table;

/// The fluctuation for which a flywheel is wanted.
const FLUCTUATION: f64 = 0.02;
/// What a motion from another state may still differ from the cycle, by its multipliers.
const SETTLED: f64 = 1e-10;
/// Cycles of the long motion at most: a cycle that settles more slowly is not compared.
const MAX_CYCLES: f64 = 24.0;

/// Runs `cycle` on a scene with drives and a motion and compares what it writes. Where there is no steady cycle, nothing is
/// compared.
pub(crate) fn compare(
    compared: &mut Compared,
    program: &Program,
    scene: &str,
) -> Result<(), String> {
    let table = &table_of(scene)?;
    if !table.contains_key("motion") || !table.contains_key("drives") {
        return Ok(());
    }
    let wanted = FLUCTUATION.to_string();
    // Without a steady cycle the status is another, and there are no files.
    let Ok(run) = program.run("cycle", scene, &["cycle", "--fluctuation", &wanted]) else {
        return Ok(());
    };
    let summary = run.json("-cycle.json")?;
    let Some(period) = result(&summary, "period") else {
        return Ok(());
    };
    let rows = run.csv("-cycle.csv")?;
    let coordinate = coordinate(&rows).ok_or("the rows have no coordinate")?;
    compare_rows(compared, (&summary, ""), &rows, &coordinate, "cycle");
    for (name, work) in rows.ending(".work") {
        add_works(compared.of("written-cycle"), &summary, name, work);
    }
    if let (Ok(rows), Some(_)) = (
        run.csv("-cycle-flywheel.csv"),
        result(&summary, "flywheel.inertia"),
    ) {
        compare_rows(
            compared,
            (&summary, "flywheel."),
            &rows,
            &coordinate,
            "cycle with flywheel",
        );
    }
    add_need(compared.of("written-cycle"), &run, &summary);
    compared.merge("written-cycle-sentences", sentences(&run, &summary));
    let angle = Units::read(table).map_or(1.0, |units| units.angle);
    compared.merge(
        "written-cycle-sentences",
        said(&run.printed, &summary, angle),
    );
    with_heavier_body(compared, program, (scene, table, &coordinate), &summary)?;
    long_motion(compared, program, (table, &coordinate), &summary, period)
}

/// A flywheel is needed where the coefficient of fluctuation is above the wanted one, and nowhere else; then its cycle has a file.
fn add_need(to: &mut Differences, run: &Run, summary: &Value) {
    let of = |name: &str| result(summary, name);
    let (Some(inertia), Some(fluctuation)) =
        (of("flywheel.inertia"), of("coefficient_of_fluctuation"))
    else {
        return;
    };
    let is_needed = fluctuation > FLUCTUATION;
    let has_file = run.csv("-cycle-flywheel.csv").is_ok();
    to.require(is_needed == (inertia > 0.0) && is_needed == has_file, || {
        format!("a flywheel of {inertia} kg m2 where the coefficient of fluctuation is {fluctuation}, and its file: {has_file}")
    });
}

/// The lines that the summary asks for; angles of the scene are in this unit, rad.
fn said(printed: &str, summary: &Value, angle: f64) -> Differences {
    let of = |name: &str| result(summary, name);
    // Each speed in the unit of the scene and as `(… 1/min)`.
    let with_revolutions = |names: [&str; 3]| -> Option<Vec<(f64, f64)>> {
        let speeds: Option<Vec<f64>> = names.into_iter().map(of).collect();
        let parts = |v: f64| [v / angle, v * 30.0 / PI, 1.0].map(|v| (v, v));
        Some(speeds?.into_iter().flat_map(parts).collect())
    };
    let mut lines = Vec::new();
    let inertia = of("flywheel.inertia");
    if inertia == Some(0.0) {
        lines.push(("no flywheel is needed".to_owned(), Vec::new()));
    } else if let Some(inertia) = inertia {
        let numbers = vec![(FLUCTUATION, FLUCTUATION), (inertia, inertia)];
        lines.push(("for a coefficient of fluctuation of".to_owned(), numbers));
        let names = [
            "flywheel.mean_speed",
            "flywheel.slowest_speed",
            "flywheel.fastest_speed",
        ];
        let numbers = with_revolutions(names).unwrap_or_default();
        lines.push(("with it: mean speed".to_owned(), numbers));
    }
    sentence_differences(printed, &lines, "cycle")
}

/// The cycle of the scene in which the body that turns with the coordinate has the flywheel's inertia is that with flywheel.
fn with_heavier_body(
    compared: &mut Compared,
    program: &Program,
    (scene, table, coordinate): (&str, &Table, &str),
    summary: &Value,
) -> Result<(), String> {
    let reading = Reading::new(scene)?;
    let turning = reading.coordinates.iter().find(|c| c.name == coordinate);
    let body = match turning.map(|c| c.measure) {
        Some(Measure::Angle([first, second])) if reading.bodies[first].is_ground => second,
        _ => return Ok(()),
    };
    let Some(inertia) = result(summary, "flywheel.inertia") else {
        return Ok(());
    };
    let mut heavier = table.clone();
    let bodies = heavier
        .get_mut("bodies")
        .and_then(toml::Value::as_table_mut);
    let entry =
        bodies.and_then(|bodies| bodies.get_mut(&reading.bodies[body].name)?.as_table_mut());
    let Some(entry) = entry else { return Ok(()) };
    let sum = (reading.bodies[body].inertia + inertia) / reading.units.inertia;
    entry.insert("inertia".to_owned(), sum.into());
    let text = text_of(&heavier)?;
    let run = program.run("heavier", &text, &["cycle"])?;
    let other = run.json("-cycle.json")?;
    let found = compared.of("written-cycle-flywheel");
    let [wheel, body] = [(summary, "flywheel."), (&other, "")].map(|(of, prefix)| {
        ["mean_speed", "slowest_speed", "fastest_speed"]
            .map(|name| result(of, &format!("{prefix}{name}")).unwrap_or(f64::NAN))
    });
    for (one, two) in wheel.into_iter().zip(body) {
        found.add(one - two, two, "rad/s", || "speeds with the flywheel");
    }
    Ok(())
}

/// The coordinate whose velocity is a column.
fn coordinate(rows: &Rows) -> Option<String> {
    let mut names = rows
        .columns
        .keys()
        .filter_map(|name| name.strip_suffix(".velocity"));
    names
        .find(|name| rows.columns.contains_key(*name))
        .map(str::to_owned)
}

/// Rows of a cycle: rates, the same state at both ends, and speeds of the summary.
fn compare_rows(
    compared: &mut Compared,
    (summary, prefix): (&Value, &str),
    rows: &Rows,
    coordinate: &str,
    file: &str,
) {
    let (time, q) = (rows.column("t"), rows.column(coordinate));
    let [speed, acceleration] =
        ["velocity", "acceleration"].map(|end| rows.column(&format!("{coordinate}.{end}")));
    let columns = [time, q, speed, acceleration];
    add_rates(compared.of("written-cycle-rates"), columns, file);
    let fastest = largest(speed);
    let found = compared.of("written-cycle");
    let place = |what: &str| format!("{file}, {what}");
    found.add(change(speed), fastest, "rad/s", || {
        place("speed at both ends")
    });
    let mean = change(q) / change(time);
    let of = |name: &str| result(summary, &format!("{prefix}{name}")).unwrap_or(f64::NAN);
    found.add(of("mean_speed") - mean, fastest, "rad/s", || {
        place("mean speed")
    });
    if prefix.is_empty() {
        let period = change(time);
        found.add(of("period") - period, period, "s", || place("period"));
    }
    // A cycle begins in the first revolutions of its coordinate.
    let turns = result(summary, "revolutions").unwrap_or(f64::NAN);
    let start = q.first().copied().unwrap_or(f64::NAN);
    let outside = (-start).max(start - TAU * turns).max(0.0);
    found.add(outside, TAU, "rad", || place("the first coordinate"));
    found.add(change(q) - TAU * turns, TAU, "rad", || place("revolutions"));
    add_speeds(found, &of, speed, file);
    let fluctuation = (of("fastest_speed").abs() - of("slowest_speed").abs()) / mean.abs();
    // With the flywheel it is the wanted one.
    let stated = match prefix {
        "" => of("coefficient_of_fluctuation"),
        _ => FLUCTUATION,
    };
    found.add(stated - fluctuation, 1.0, "", || {
        place("coefficient of fluctuation")
    });
}

/// The last value less the first.
fn change(values: &[f64]) -> f64 {
    let ends = values.last().zip(values.first());
    ends.map_or(f64::NAN, |(last, first)| last - first)
}

/// Between rows the motion may be faster or slower, by no more than the largest change from row to row.
fn add_speeds(to: &mut Differences, of: &dyn Fn(&str) -> f64, speed: &[f64], file: &str) {
    let changes = speed.windows(2).map(|pair| (pair[1] - pair[0]).abs());
    let change = changes.fold(0.0, f64::max);
    let sizes = speed.iter().map(|v| v.abs());
    let (least, most) = (sizes.fold(f64::INFINITY, f64::min), largest(speed));
    for (beyond, what) in [
        (least - of("slowest_speed").abs(), "slowest speed"),
        (of("fastest_speed").abs() - most, "fastest speed"),
    ] {
        let excess = (-beyond).max(beyond - change).max(0.0);
        to.add(excess, most, "rad/s", || format!("{file}, {what}"));
    }
}

/// The rows are at equal distances of the coordinate, where t′ = 1/q̇ and (½q̇²)′ = q̈.
fn add_rates(to: &mut Differences, [time, q, speed, acceleration]: [&[f64]; 4], file: &str) {
    let slowness: Vec<f64> = speed.iter().map(|v| 1.0 / v).collect();
    let squares: Vec<f64> = speed.iter().map(|v| 0.5 * v * v).collect();
    for (values, rate, what) in [
        (time, &slowness[..], "t"),
        (&squares, acceleration, "speed"),
    ] {
        let place = format!("{file}, {what}");
        simpson(to, q, [values, rate], largest(values), &place);
    }
}

/// The work of a source in a cycle, by its column.
fn add_works(to: &mut Differences, summary: &Value, name: &str, work: &[f64]) {
    if let Some(stated) = result(summary, name) {
        to.add(stated - change(work), largest(work), "J", || {
            format!("{name} of a cycle")
        });
    }
}

/// The time between the last two revolutions of a motion that has settled is the period.
fn long_motion(
    compared: &mut Compared,
    program: &Program,
    (table, coordinate): (&Table, &str),
    summary: &Value,
    period: f64,
) -> Result<(), String> {
    let multipliers: Vec<Multiplier> = (1..)
        .map_while(|k| {
            let part = |p: &str| result(summary, &format!("floquet_multiplier.{k}.{p}"));
            Some([part("re")?, part("im")?])
        })
        .collect();
    let sizes = multipliers.iter().map(|[re, im]| re.hypot(*im));
    let slowest = sizes.fold(0.0, f64::max);
    let cycles = (SETTLED.ln() / slowest.max(1e-3).ln()).ceil() + 3.0;
    if slowest >= 1.0 || cycles > MAX_CYCLES || result(summary, "revolutions") != Some(1.0) {
        return Ok(());
    }
    let mut long = table.clone();
    let Some(motion) = long.get_mut("motion").and_then(toml::Value::as_table_mut) else {
        return Ok(());
    };
    let event = value_of([("revolution", coordinate.into())]);
    motion.insert("events".to_owned(), value_of([("settled", event)]));
    motion.insert("duration".to_owned(), (period * (cycles + 2.0)).into());
    let text = text_of(&long)?;
    let arguments = ["simulate", "--method", "dop853", "--rtol", "1e-11"];
    let run = program.run("long", &text, &arguments)?;
    let events = run.csv("-motion-events.csv")?;
    let times = events.column("t");
    let [.., before, last] = times else {
        return Err("the long motion has no two revolutions".to_owned());
    };
    let mean = result(summary, "mean_speed").map_or(f64::NAN, f64::abs);
    let turn = TAU / (last - before);
    compared.add(
        "written-cycle-period",
        last - before - period,
        period,
        "s",
        || format!("period after {} cycles of `simulate`", times.len()),
    );
    compared.add(
        "written-cycle-period",
        mean - turn,
        turn,
        "rad/s",
        || "mean speed of `simulate`",
    );
    let speeds = events.column(&format!("{coordinate}.velocity"));
    let decay = multiplier_differences(speeds, &multipliers);
    compared.merge("written-cycle-multiplier", decay);
    Ok(())
}
