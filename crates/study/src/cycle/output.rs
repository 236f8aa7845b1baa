//! Writes a steady cycle: tables, figure and summary.

use super::figures;
use crate::cycle::compute::compute_cycle;
use crate::explain::StudyError;
use crate::models::{SceneMachine, SolverSettings, source_name};
use crate::number_format::{count, digits};
use crate::output::{Outcome, signed_png};
use dwell_dynamics::{Cycle, Flywheel};
use dwell_report::TableFormat;
use dwell_scene::Scene;
use std::f64::consts::{PI, TAU};

/// The steady cycle of a scene, and the flywheel for a target coefficient of speed fluctuation if given.
///
/// # Errors
/// [`StudyError`] when the free coordinate does not rotate fully, a load depends on time, or no steady cycle is found.
pub fn cycle(
    scene: &Scene,
    settings: &SolverSettings,
    fluctuation: Option<f64>,
) -> Result<Outcome, StudyError> {
    let results = compute_cycle(scene, settings, fluctuation)?;
    let mut outcome = Outcome::default();
    let name = |rest: &str| format!("{}-cycle{rest}", scene.name);
    let files = &mut outcome.files;
    files.add_table(&name(""), &results.samples, &TableFormat::ALL)?;
    files.add_table(&name("-work"), &results.works, &[TableFormat::Csv])?;
    if let Some(samples) = &results.flywheel_samples {
        files.add_table(&name("-flywheel"), samples, &TableFormat::ALL)?;
    }
    let figure = figures::cycle(&results, settings);
    outcome.files.add(name(".png"), signed_png(scene, &figure)?);
    outcome.summary = summary(&results.prepared, &results.steady);
    if let Some((target, flywheel)) = &results.flywheel {
        outcome.summary += &flywheel_text(&results.prepared, *target, flywheel);
    }
    Ok(outcome)
}

/// Mean, slowest and fastest angular velocity in rad/s and revolutions per minute.
fn speeds(cycle: &Cycle) -> [String; 3] {
    [cycle.mean_speed, cycle.slowest[1], cycle.fastest[1]].map(|value| {
        let minute = digits(value * 30.0 / PI, 6);
        format!("{} rad/s ({minute} 1/min)", digits(value, 9))
    })
}

pub(crate) fn summary(prepared: &SceneMachine<'_>, cycle: &Cycle) -> String {
    let (coordinate, _) = prepared.first_free_coordinate();
    let revolutions = count((cycle.cycle_angle / TAU).round() as usize, "revolution");
    let position = |[q, _]: [f64; 2]| prepared.describe_coordinate(coordinate, q);
    let (title, name) = (&prepared.scene.title, prepared.coordinate_name(coordinate));
    let [period, fluctuation] = [cycle.period, cycle.fluctuation].map(|v| digits(v, 9));
    let [mean, slowest, fastest] = speeds(cycle);
    let [slowest_at, fastest_at] = [cycle.slowest, cycle.fastest].map(position);
    let mut text = format!(
        "{title}: steady cycle of {name}, {revolutions} in {period} s\n  mean speed {mean}\n  slowest {slowest} at \
         {slowest_at}\n  fastest {fastest} at {fastest_at}\n  coefficient of fluctuation {fluctuation}\n"
    );
    let multipliers = cycle.floquet_multipliers.iter();
    let multipliers: Vec<String> = multipliers.map(|&z| complex_text(z, 6)).collect();
    let multipliers = multipliers.join(", ");
    text += match cycle.is_stable() {
        true => "  stable",
        false => "  unstable",
    };
    text += &format!(
        ": a disturbance changes by these factors per cycle (Floquet multipliers): {multipliers}\n"
    );
    let sources = prepared.machine.nonconservative_sources().iter();
    for (&source, &work) in sources.zip(&cycle.works) {
        let name = source_name(prepared.scene, source);
        text += &format!("  work of {name} per cycle {} J\n", digits(work, 9));
    }
    let sum: f64 = cycle.works.iter().sum();
    let size: f64 = cycle.works.iter().map(|work| work.abs()).sum();
    if size > 0.0 {
        let relative = (sum / size).abs();
        text +=
            &format!("  sum of these works: {relative:.1e} of the sum of their absolute values\n");
    }
    text
}

/// The flywheel and its effect.
pub(crate) fn flywheel_text(
    prepared: &SceneMachine<'_>,
    target: f64,
    flywheel: &Flywheel,
) -> String {
    let target = digits(target, 6);
    if flywheel.inertia == 0.0 {
        return format!("  no flywheel is needed for a coefficient of fluctuation of {target}\n");
    }
    let (coordinate, _) = prepared.first_free_coordinate();
    let name = prepared.coordinate_name(coordinate);
    let inertia = digits(flywheel.inertia, 9);
    let [mean, slowest, fastest] = speeds(&flywheel.cycle);
    format!(
        "  for a coefficient of fluctuation of {target}: flywheel of {inertia} kg m² on {name}\n  with it: mean speed \
         {mean}, from {slowest} to {fastest}\n"
    )
}

/// A complex number.
fn complex_text([re, im]: [f64; 2], count: usize) -> String {
    if im == 0.0 {
        digits(re, count)
    } else {
        let sign = if im < 0.0 { '−' } else { '+' };
        format!("{} {sign} {}i", digits(re, count), digits(im.abs(), count))
    }
}
