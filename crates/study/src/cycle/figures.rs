//! The steady cycle: speed over the coordinate, and acceleration over speed.

use crate::cycle::compute::CycleResults;
use crate::models::SolverSettings;
use crate::output::{scene_caption, symbol};
use dwell_report::{Axis, Chart, Figure, Mark, Panel, Series, Stroke, Table};

/// A speed that varies relatively by less than this is drawn as constant.
const CONSTANT_FLUCTUATION: f64 = 1e-7;

/// The cycle, and the same with the flywheel.
pub(crate) fn cycle(results: &CycleResults<'_>, settings: &SolverSettings) -> Figure {
    let CycleResults {
        scene_machine: machine,
        steady,
        samples,
        flywheel_samples,
        ..
    } = results;
    let (actuator, _) = machine.first_free_coordinate();
    let name = symbol(machine.coordinate_name(actuator));
    let curve = |table: &Table, of: fn(&[f64]) -> [f64; 2]| -> Vec<[f64; 2]> {
        table.rows.iter().map(|row| of(row)).collect()
    };
    let both = |of: fn(&[f64]) -> [f64; 2]| {
        let label = if flywheel_samples.is_some() {
            "without flywheel"
        } else {
            ""
        };
        let mut series = vec![Series::line(label, curve(samples, of))];
        if let Some(table) = flywheel_samples {
            let with = Series::line("with the flywheel", curve(table, of));
            series.push(with.stroke(Stroke::Dashed));
        }
        series
    };
    let axis = Axis::new(format!("d{name}/dt"), "rad/s");
    let mean = steady.mean_speed;
    let is_constant = steady.fluctuation.abs() < CONSTANT_FLUCTUATION;
    let axis = if is_constant {
        let margin = 0.01 * mean.abs();
        axis.with_range(mean - margin, mean + margin)
    } else {
        axis
    };
    let mut panels = vec![Panel::from(Chart {
        title: "Speed over the coordinate".to_owned(),
        x: Axis::degrees(name.clone()),
        y: axis.clone(),
        series: both(|row| [row[1].to_degrees(), row[2]]),
        marks: vec![Mark::Horizontal {
            at: mean,
            label: format!("mean {mean:.5} rad/s"),
        }],
        ..Chart::default()
    })];
    // At constant speed the phase portrait is a point.
    if !is_constant {
        panels.push(Panel::from(Chart {
            title: "Phase: acceleration over speed".to_owned(),
            x: axis,
            y: Axis::new(format!("d²{name}/dt²"), "rad/s²"),
            series: both(|row| [row[2], row[3]]),
            ..Chart::default()
        }));
    }
    let stable = if steady.is_stable() {
        "Stable"
    } else {
        "Unstable"
    };
    let text = format!(
        "{stable}; period {:.6} s, coefficient of fluctuation {:.4e}.",
        steady.period, steady.fluctuation
    );
    Figure {
        name: "cycle".to_owned(),
        title: "Steady cycle".to_owned(),
        caption: scene_caption(machine.scene, &text),
        columns: 1,
        panels,
        provenance: format!("shooting over the coordinate, {}", settings.describe()),
    }
}
