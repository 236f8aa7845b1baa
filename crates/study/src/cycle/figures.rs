//! The steady cycle: speed over the coordinate, and acceleration over speed.

use crate::cycle::compute::{CycleResults, CycleStability};
use crate::machines::MachineScene;
use crate::models::SolverSettings;
use crate::number_format::digits_within;
use crate::output::{chart, figure, symbol};
use dwell_report::{Axis, Figure, Mark, Series, Stroke, Table};

/// A speed that varies relatively by less than this is drawn as constant.
const CONSTANT_FLUCTUATION: f64 = 1e-7;

/// The cycle, and the same with the flywheel.
pub(crate) fn cycle(
    results: &CycleResults<'_, impl MachineScene>,
    settings: &SolverSettings,
) -> Figure {
    let (prepared, steady) = (&results.prepared, &results.steady);
    let (actuator, _) = prepared.first_free_coordinate();
    let name = symbol(prepared.coordinate_name(actuator));
    let mean = steady.mean_speed;
    let is_constant =
        steady.fluctuation.abs() < CONSTANT_FLUCTUATION || !results.errors.varies(steady);
    let mut speed = Axis::new(format!("d{name}/dt"), "rad/s");
    if is_constant {
        let margin = 0.01 * mean.abs();
        speed = speed.with_range(mean - margin, mean + margin);
    }
    let (title, position) = ("Speed over the coordinate", Axis::degrees(&*name));
    let speed_curves = curves(results, |row| [row[1].to_degrees(), row[2]]);
    let mut over_coordinate = chart(title, position, speed.clone(), speed_curves);
    over_coordinate.marks.push(Mark::Horizontal {
        at: mean,
        label: format!(
            "mean {} rad/s",
            digits_within(mean, results.errors.speed * mean.abs(), 6)
        ),
    });
    let mut panels = vec![over_coordinate.into()];
    // At constant speed the phase portrait is a point.
    if !is_constant {
        let acceleration = Axis::new(format!("d²{name}/dt²"), "rad/s²");
        let phase = curves(results, |row| [row[2], row[3]]);
        let title = "Phase: acceleration over speed";
        panels.push(chart(title, speed, acceleration, phase).into());
    }
    let errors = &results.errors;
    let stability = match errors.stability(steady) {
        CycleStability::Stable => "Stable",
        CycleStability::Unstable => "Unstable",
        CycleStability::Undecided => "Stability not decided within the error",
    };
    let period = digits_within(steady.period, errors.speed * steady.period, 7);
    let fluctuation = digits_within(steady.fluctuation, errors.fluctuation, 5);
    let text = format!("{stability}; period {period} s, coefficient of fluctuation {fluctuation}.");
    let method = format!("shooting over the coordinate, {}", settings.describe());
    let (scene, title) = (prepared.scene, "Steady cycle");
    figure(scene, "cycle", title, &text, panels, method)
}

/// A curve of the cycle, and of the cycle with the flywheel.
fn curves(
    results: &CycleResults<'_, impl MachineScene>,
    of: fn(&[f64]) -> [f64; 2],
) -> Vec<Series> {
    let line = |name: &str, table: &Table| {
        Series::line(name, table.rows.iter().map(|row| of(row)).collect())
    };
    match &results.flywheel_samples {
        None => vec![line("", &results.samples)],
        Some(with_flywheel) => vec![
            line("without flywheel", &results.samples),
            line("with the flywheel", with_flywheel).stroke(Stroke::Dashed),
        ],
    }
}
