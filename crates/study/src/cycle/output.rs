//! Writes a steady cycle: tables, figure and summary.

use super::figures;
use crate::cycle::compute::{
    COORDINATE_COLUMN, CycleErrors, CycleResults, CycleSearch, CycleStability, SizedFlywheel,
    compute_cycle,
};
use crate::explain::StudyError;
use crate::machines::{MachineScene, SceneMachine};
use crate::models::SolverSettings;
use crate::number_format::{count, digits, digits_within};
use crate::output::{Outcome, add_results_page};
use crate::page::{scene_page, table_page, unit_group};
use crate::trajectory::output::TrajectoryOutcome;
use dwell_dynamics::Cycle;
use dwell_findings::Record;
use dwell_report::TableFormat;
use dwell_scene::SceneFile;
use std::f64::consts::{PI, TAU};

/// The steady cycle of a scene, and the flywheel for a target coefficient of speed fluctuation if given. If no steady
/// cycle is found, [`TrajectoryOutcome::early_stop`] has the reason.
///
/// # Errors
/// [`StudyError`] when the free coordinate does not rotate fully, nothing does work, or a load depends on time.
pub fn cycle<S: MachineScene>(
    scene: &S,
    settings: &SolverSettings,
    fluctuation: Option<f64>,
) -> Result<TrajectoryOutcome, StudyError> {
    let results = match compute_cycle(scene, settings, fluctuation)? {
        CycleSearch::Steady(results) => results,
        CycleSearch::NoCycle { prepared, reason } => {
            let (coordinate, _) = prepared.first_free_coordinate();
            let name = prepared.coordinate_name(coordinate);
            let note = prepared.branch_note();
            let summary = format!(
                "{}: no steady cycle of {name} is found\n{note}",
                scene.title
            );
            return Ok(TrajectoryOutcome {
                outcome: Outcome {
                    summary,
                    ..Outcome::default()
                },
                early_stop: Some(reason),
            });
        }
    };
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-cycle{rest}", scene.name);
    let mut page_of_rows = table_page(scene_page(scene, "cycle"), &results.samples, unit_group);
    page_of_rows.subtitle = format!(
        "one steady cycle in {}",
        count(results.samples.rows.len(), "position")
    );
    page_of_rows.drawing = scene.drawing_along(&page_of_rows.columns[COORDINATE_COLUMN].values);
    outcome.run = Some(Box::new(page_of_rows));
    let files = &mut outcome.files;
    files.add_table(&name(""), &results.samples, &TableFormat::ALL)?;
    files.add_table(&name("-work"), &results.works, &[TableFormat::Csv])?;
    if let Some(samples) = &results.flywheel_samples {
        files.add_table(&name("-flywheel"), samples, &TableFormat::ALL)?;
    }
    outcome.summary = summary(&results, &mut outcome.record);
    if let Some(flywheel) = &results.flywheel {
        outcome.summary += &flywheel_text(&results.prepared, flywheel, &mut outcome.record);
    }
    let figure = figures::cycle(&results, settings);
    add_results_page(&mut outcome, scene, "steady cycle", &name(""), Some(figure));
    Ok(TrajectoryOutcome {
        outcome,
        early_stop: None,
    })
}

/// A speed in the scene's unit and in revolutions per minute, to the digits that its relative error leaves; it is recorded.
fn speed_text(
    scene: &SceneFile,
    name: &str,
    value: f64,
    relative_error: f64,
    record: &mut Record,
) -> String {
    record.add_within(name, "rad/s", value, relative_error * value.abs());
    let (in_unit, unit) = scene.to_scene_unit(value, true);
    let [in_unit, minute] = [in_unit, value * 30.0 / PI]
        .map(|value| digits_within(value, relative_error * value.abs(), 9));
    format!("{in_unit} {unit}/s ({minute} 1/min)")
}

/// The summary of the cycle; its numbers are recorded.
fn summary(results: &CycleResults<'_, impl MachineScene>, record: &mut Record) -> String {
    let (prepared, cycle, errors) = (&results.prepared, &results.steady, &results.errors);
    let (coordinate, _) = prepared.first_free_coordinate();
    let revolutions = (cycle.cycle_angle / TAU).round() as usize;
    let (scene, name) = (prepared.scene, prepared.coordinate_name(coordinate));
    record.add_count("revolutions", revolutions);
    record.add_within("period", "s", cycle.period, errors.speed * cycle.period);
    let mut text = format!(
        "{}: steady cycle of {name}, {} in {} s\n  mean speed {}\n",
        scene.title,
        count(revolutions, "revolution"),
        digits_within(cycle.period, errors.speed * cycle.period, 9),
        speed_text(scene, "mean_speed", cycle.mean_speed, errors.speed, record),
    );
    let ends = [("slowest", cycle.slowest), ("fastest", cycle.fastest)];
    for ((name, [at, speed]), error) in ends.into_iter().zip(errors.positions) {
        let key = format!("{name}_speed");
        let speed = speed_text(scene, &key, speed, errors.speed, record);
        record.add_within(format!("{key}.at"), "rad", at, error);
        if errors.varies(cycle) {
            let position = prepared.describe_coordinate_within(coordinate, at, error);
            text += &format!("  {name} {speed} at {position}\n");
        }
    }
    let key = "coefficient_of_fluctuation";
    record.add_within(key, "", cycle.fluctuation, errors.fluctuation);
    text += &if errors.varies(cycle) {
        let fluctuation = digits_within(cycle.fluctuation, errors.fluctuation, 9);
        format!("  coefficient of fluctuation {fluctuation}\n")
    } else {
        let error = digits(errors.fluctuation, 1);
        format!("  constant speed: the coefficient of fluctuation is below {error}\n")
    };
    text + &stability_text(cycle, errors, record)
        + &work_text(prepared, cycle, errors, record)
        + &prepared.branch_note()
}

/// The multipliers, and whether the cycle is stable.
fn stability_text(cycle: &Cycle, errors: &CycleErrors, record: &mut Record) -> String {
    let mut multipliers = Vec::new();
    let each = cycle.floquet_multipliers.iter().zip(&errors.multipliers);
    for (k, (&[re, im], &error)) in each.enumerate() {
        let name = |part: &str| format!("floquet_multiplier.{}.{part}", k + 1);
        record.add_within(name("re"), "", re, error);
        record.add_within(name("im"), "", im, error);
        multipliers.push(complex_text([re, im], error, 6));
    }
    let multipliers = multipliers.join(", ");
    let stability = match errors.stability(cycle) {
        CycleStability::Stable => "stable",
        CycleStability::Unstable => "unstable",
        CycleStability::Undecided => "stability not decided within the error",
    };
    format!(
        "  {stability}: a disturbance changes by these factors per cycle (Floquet multipliers): {multipliers}\n"
    )
}

/// The works, the remainder of their sum, and the errors of all numbers.
fn work_text(
    prepared: &SceneMachine<'_, impl MachineScene>,
    cycle: &Cycle,
    errors: &CycleErrors,
    record: &mut Record,
) -> String {
    let mut text = String::new();
    let sources = prepared.machine.nonconservative_sources().iter();
    for (&source, &work) in sources.zip(&cycle.works) {
        let name = prepared.scene.name_of_source(source);
        record.add_within(format!("{name}.work"), "J", work, errors.work);
        let work = digits_within(work, errors.work, 9);
        text += &format!("  work of {name} per cycle {work} J\n");
    }
    let sum: f64 = cycle.works.iter().sum();
    let size: f64 = cycle.works.iter().map(|work| work.abs()).sum();
    record.add("work_sum", "J", sum);
    // A single source has undone in a cycle what it did.
    if cycle.works.len() > 1 && size > errors.work {
        let relative = (sum / size).abs();
        record.add("work_sum.relative", "", relative);
        text +=
            &format!("  sum of these works: {relative:.1e} of the sum of their absolute values\n");
    }
    let multiplier = errors.multipliers.iter().copied().fold(0.0, f64::max);
    record.add("error.speeds", "", errors.speed);
    record.add("error.coefficient_of_fluctuation", "", errors.fluctuation);
    record.add("error.works", "J", errors.work);
    record.add("error.floquet_multipliers", "", multiplier);
    text + &format!(
        "  estimated errors: {:.1e} of the speeds, {:.1e} in the coefficient of fluctuation, {:.1e} J in the works, \
         {multiplier:.1e} in the multipliers, from a second run at a tenth of the tolerance\n",
        errors.speed, errors.fluctuation, errors.work
    )
}

/// The flywheel and its effect.
fn flywheel_text(
    prepared: &SceneMachine<'_, impl MachineScene>,
    sized: &SizedFlywheel,
    record: &mut Record,
) -> String {
    let (flywheel, error) = (&sized.flywheel, sized.errors.speed);
    record.add("flywheel.coefficient_of_fluctuation", "", sized.target);
    let (inertia, inertia_error) = (flywheel.inertia, sized.inertia_error);
    record.add_within("flywheel.inertia", "kg m2", inertia, inertia_error);
    let cycle = &flywheel.cycle;
    let [mean, slowest, fastest] = [
        ("flywheel.mean_speed", cycle.mean_speed),
        ("flywheel.slowest_speed", cycle.slowest[1]),
        ("flywheel.fastest_speed", cycle.fastest[1]),
    ]
    .map(|(name, speed)| speed_text(prepared.scene, name, speed, error, record));
    let target = digits(sized.target, 6);
    if inertia == 0.0 {
        return format!("  no flywheel is needed for a coefficient of fluctuation of {target}\n");
    }
    let (coordinate, _) = prepared.first_free_coordinate();
    let name = prepared.coordinate_name(coordinate);
    let inertia = digits_within(inertia, inertia_error, 9);
    format!(
        "  for a coefficient of fluctuation of {target}: flywheel of {inertia} kg m² on {name}\n  with it: mean speed \
         {mean}, from {slowest} to {fastest}\n"
    )
}

/// A complex number to the digits that its error leaves, at most `count`.
fn complex_text([re, im]: [f64; 2], error: f64, count: usize) -> String {
    if im == 0.0 {
        digits_within(re, error, count)
    } else {
        let sign = if im < 0.0 { '−' } else { '+' };
        let [re, im] = [re, im.abs()].map(|part| digits_within(part, error, count));
        format!("{re} {sign} {im}i")
    }
}
