//! The steady cycle: speed over the coordinate, and acceleration over speed.

use super::{foot, symbol};
use crate::driven::Driven;
use crate::simulate::Accuracy;
use dwell_dynamics::Cycle;
use dwell_report::{Axis, Chart, Figure, Mark, Panel, Series, Stroke, Table};

/// A speed that changes by less than this part of itself is drawn as a constant one.
const EVEN: f64 = 1e-7;

/// A cycle and its samples (t, coordinate, speed, acceleration, …), and the same with a flywheel.
pub(crate) fn cycle(
    driven: &Driven<'_>,
    (steady, samples): (&Cycle, &Table),
    even: Option<(&Cycle, &Table)>,
    accuracy: &Accuracy,
) -> Figure {
    let (only, _) = driven.only();
    let name = symbol(driven.name(only));
    let curve = |table: &Table, of: fn(&[f64]) -> [f64; 2]| -> Vec<[f64; 2]> {
        table.rows.iter().map(|row| of(row)).collect()
    };
    let both = |of: fn(&[f64]) -> [f64; 2]| {
        let label = if even.is_some() { "as it is" } else { "" };
        let mut series = vec![Series::line(label, curve(samples, of))];
        if let Some((_, table)) = even {
            let with = Series::line("with the flywheel", curve(table, of));
            series.push(with.stroke(Stroke::Dashed));
        }
        series
    };
    let axis = Axis::new(format!("d{name}/dt"), "rad/s");
    let mean = steady.mean_speed;
    let is_even = steady.fluctuation.abs() < EVEN;
    let axis = if is_even {
        let margin = 0.01 * mean.abs();
        axis.within(mean - margin, mean + margin)
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
    // Of an even speed it is a point.
    if !is_even {
        panels.push(Panel::from(Chart {
            title: "Phase: acceleration over speed".to_owned(),
            x: axis,
            y: Axis::new(format!("d²{name}/dt²"), "rad/s²"),
            series: both(|row| [row[2], row[3]]),
            ..Chart::default()
        }));
    }
    let stable = if steady.stable() {
        "Stable"
    } else {
        "Unstable"
    };
    let words = format!(
        "{stable}; period {:.6} s, coefficient of fluctuation {:.4e}.",
        steady.period, steady.fluctuation
    );
    Figure {
        name: "cycle".to_owned(),
        title: "Steady cycle".to_owned(),
        caption: foot(driven.scene, &words),
        columns: 1,
        panels,
        provenance: format!("shooting over the coordinate, {}", accuracy.told()),
    }
}
