//! Velocity and reactions in time: the paper's Figure 4.

use crate::checked::history::History;
use dwell_report::{Axis, Chart, Figure, Mark, Panel, Series};
use dwell_study::output::{caption, coordinate_label, symbol};
use dwell_study::{PreparedScene, SolverSettings};

/// Periods that are drawn; more would only repeat.
const DRAWN_PERIODS: f64 = 2.0;
/// Most reactions to a panel.
const MAX_CURVES: usize = 6;

/// The motion over two periods (or all of it, where it has none).
pub(crate) fn history(
    prepared: &PreparedScene<'_>,
    history: &History,
    accuracy: &SolverSettings,
) -> Figure {
    let all = &history.run.samples;
    let drawn = history.period.map(|t| DRAWN_PERIODS * t * (1.0 + 1e-9));
    let drawn = drawn.unwrap_or(f64::INFINITY);
    let samples = (0..all.len()).filter(|&i| all[i].t - all[0].t <= drawn);
    let samples: Vec<usize> = samples.collect();
    let curve = |of: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        samples.iter().map(|&i| [all[i].t, of(i)]).collect()
    };
    let revolutions = history.run.event_occurrences.iter().map(|o| o.state.t);
    let revolutions = revolutions.take_while(|t| *t <= drawn).enumerate();
    let mark = |(k, at): (usize, f64)| Mark::Vertical {
        at,
        label: if k == 0 {
            format!("T = {at:.4} s")
        } else {
            String::new()
        },
    };
    let marks: Vec<Mark> = revolutions.map(mark).collect();
    let chart = |title: String, label: String, unit: &str, series: Vec<Series>| {
        Panel::from(Chart {
            title,
            x: Axis::new("time", "s"),
            y: Axis::new(label, unit),
            series,
            marks: marks.clone(),
            ..Chart::default()
        })
    };
    let q = symbol(prepared.coordinate_name());
    let angle = coordinate_label(prepared);
    let velocity = vec![Series::line("", curve(&|i| all[i].y[1]))];
    let title = format!("Velocity of the {angle}");
    let mut panels = vec![chart(title, format!("d{q}/dt"), "rad/s", velocity)];
    let reactions = prepared.reaction_units();
    for (unit, noun) in [("N", "force"), ("N m", "moment")] {
        let of_unit = (0..reactions.len()).filter(|&k| reactions[k].1 == unit);
        let of_unit: Vec<usize> = of_unit.collect();
        let count = of_unit.len();
        let per_panel = count.div_ceil(count.div_ceil(MAX_CURVES).max(1)).max(1);
        for group in of_unit.chunks(per_panel).take(2) {
            let name = |k: usize| reactions[k].0.clone();
            let line = |&k: &usize| {
                let name = if group.len() > 1 {
                    name(k)
                } else {
                    String::new()
                };
                Series::line(name, curve(&|i| history.rows[i][2 + k]))
            };
            let (title, label) = match group {
                [k] => (format!("Reaction {}", name(*k)), name(*k)),
                [first, .., last] => (
                    format!("Reactions {} to {}", name(*first), name(*last)),
                    format!("reaction {noun}"),
                ),
                [] => continue,
            };
            panels.push(chart(title, label, unit, group.iter().map(line).collect()));
        }
    }
    let fitted = prepared.scene.calibration.as_ref().map(|c| {
        format!(
            " {} is fitted to a period of {} s, so that agreement is by construction.",
            c.path, c.period
        )
    });
    let fitted = fitted.unwrap_or_default();
    let text = format!("No torque. Reactions by R = a q̈ + b q̇².{fitted}");
    Figure {
        name: "motion".to_owned(),
        title: "Free motion".to_owned(),
        caption: caption(prepared, &text),
        columns: if panels.len() > 2 { 2 } else { 1 },
        panels,
        provenance: format!("reduced model, {}", accuracy.describe()),
    }
}
