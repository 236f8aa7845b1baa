//! The findings over the steady cycle of a case.

use super::multipliers::{Multiplier, multiplier_differences};
use crate::written::poses::compared::Compared;
use crate::written::poses::difference::Differences;
use crate::written::poses::printed_numbers::sentences;
use crate::written::poses::program::{Program, Run};
use crate::written::poses::rows::Rows;
use crate::written::poses::scene_text::{Scene, number, text_of, value_of, with_number};
use crate::written::poses::stated::{result, sentence_differences};
use serde_json::Value;
use std::f64::consts::{PI, TAU};
use toml::Table;

/// The fluctuation for which a flywheel is wanted.
const FLUCTUATION: f64 = 0.02;
/// Allowed difference from the cycle of a motion from another state, by its multipliers.
const SETTLED: f64 = 1e-10;
/// Cycles of the long motion at most: a cycle that settles more slowly is not compared.
const MAX_CYCLES: f64 = 24.0;

/// Runs `cycle` on a scene with drives and a motion and compares its files. Without a steady cycle, nothing is compared.
pub(crate) fn compare(
    compared: &mut Compared,
    program: &Program,
    scene: &Scene,
) -> Result<(), String> {
    let table = &scene.table;
    if !scene.has("motion") || !scene.has("drives") {
        return Ok(());
    }
    let text = text_of(table)?;
    let wanted = FLUCTUATION.to_string();
    // Without a steady cycle the status is another, and there are no files.
    let Ok(run) = program.run("cycle", &text, &["cycle", "--fluctuation", &wanted]) else {
        return Ok(());
    };
    let summary = run.json("-cycle.json")?;
    let Some(period) = result(&summary, "period") else {
        return Ok(());
    };
    let rows = run.csv("-cycle.csv")?;
    let coordinate = coordinate(&rows).ok_or("the rows have no coordinate")?;
    add_need(compared.of("written-cycle-sentences"), &run, &summary);
    compared.merge("written-cycle-sentences", sentences(&run, &summary));
    compared.merge(
        "written-cycle-sentences",
        said(&run.printed, &summary, scene.units.angle),
    );
    with_heavier_body(compared, program, (scene, &coordinate), &summary)?;
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
    (scene, coordinate): (&Scene, &str),
    summary: &Value,
) -> Result<(), String> {
    let actuator = scene.table.get("actuators").and_then(|a| a.get(coordinate));
    let bodies = actuator.and_then(|actuator| actuator.get("angle")?.as_array());
    let body = match bodies.map(Vec::as_slice) {
        Some([ground, body]) if ground.as_str() == Some("ground") => body.as_str(),
        _ => None,
    };
    let (Some(body), Some(inertia)) = (body, result(summary, "flywheel.inertia")) else {
        return Ok(());
    };
    let of_body = scene.table.get("bodies").and_then(|b| b.get(body));
    let Some(own) = number(of_body.and_then(|body| body.get("inertia"))) else {
        return Ok(());
    };
    let sum = own + inertia / scene.units.inertia;
    let heavier = with_number(&scene.table, &["bodies", body, "inertia"], sum);
    let text = text_of(&heavier.ok_or("the body has no inertia")?)?;
    let run = program.run("heavier", &text, &["cycle"])?;
    let other = run.json("-cycle.json")?;
    let found = compared.of("written-cycle-flywheel");
    for name in ["mean_speed", "slowest_speed", "fastest_speed"] {
        let of = |summary: &Value, name: &str| result(summary, name).unwrap_or(f64::NAN);
        let [wheel, body] = [of(summary, &format!("flywheel.{name}")), of(&other, name)];
        found.add(wheel - body, body, "rad/s", || "speeds with the flywheel");
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
