//! Speed and reactions in time: the paper's Figure 4.

use super::{caption, coordinate_label, symbol};
use crate::history::History;
use crate::prepare::Prepared;
use crate::simulate::Accuracy;
use dwell_report::{Axis, Chart, Figure, Mark, Panel, Series};

/// Turns that are drawn; more would only repeat.
const TURNS: f64 = 2.0;
/// Most reactions to a panel.
const TOGETHER: usize = 6;

/// The motion over two periods (or all of it, where it has none).
pub(crate) fn history(prepared: &Prepared<'_>, history: &History, accuracy: &Accuracy) -> Figure {
    let drawn = history
        .period
        .map_or(f64::INFINITY, |period| TURNS * period * (1.0 + 1e-9));
    let samples: Vec<usize> = (0..history.run.samples.len())
        .filter(|&i| history.run.samples[i].t - history.run.samples[0].t <= drawn)
        .collect();
    let curve = |of: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        let at = |&i: &usize| [history.run.samples[i].t, of(i)];
        samples.iter().map(at).collect()
    };
    let marks: Vec<Mark> = history
        .run
        .turns
        .iter()
        .take_while(|s| s.t <= drawn)
        .enumerate()
        .map(|(k, s)| Mark::Vertical {
            at: s.t,
            label: if k == 0 {
                format!("T = {:.4} s", s.t)
            } else {
                String::new()
            },
        })
        .collect();
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
    let q = symbol(prepared.coordinate());
    let angle = coordinate_label(prepared);
    let speed = Series::line("", curve(&|i| history.run.samples[i].q_dot));
    let mut panels = vec![chart(
        format!("Speed of the {angle}"),
        format!("d{q}/dt"),
        "rad/s",
        vec![speed],
    )];
    let reactions = prepared.reactions();
    for (unit, words) in [("N", "force"), ("N m", "moment")] {
        let of_unit: Vec<usize> = (0..reactions.len())
            .filter(|&k| reactions[k].1 == unit)
            .collect();
        let together = of_unit
            .len()
            .div_ceil(of_unit.len().div_ceil(TOGETHER).max(1))
            .max(1);
        for some in of_unit.chunks(together).take(2) {
            let line = |&k: &usize| {
                let name = if some.len() > 1 {
                    reactions[k].0.clone()
                } else {
                    String::new()
                };
                Series::line(name, curve(&|i| history.rows[i][2 + k]))
            };
            let (title, label) = match some {
                [k] => (
                    format!("Reaction {}", reactions[*k].0),
                    reactions[*k].0.clone(),
                ),
                [first, .., last] => (
                    format!(
                        "Reactions {} to {}",
                        reactions[*first].0, reactions[*last].0
                    ),
                    format!("reaction {words}"),
                ),
                [] => continue,
            };
            let unit = if unit == "N" { "N" } else { "N m" };
            panels.push(chart(title, label, unit, some.iter().map(line).collect()));
        }
    }
    Figure {
        name: "d-motion".to_owned(),
        title: "Free motion".to_owned(),
        caption: caption(
            prepared,
            &format!(
                "No torque. Reactions by R = a q̈ + b q̇².{}",
                prepared
                    .scene
                    .calibration
                    .as_ref()
                    .map_or_else(String::new, |c| format!(
                        " {} is fitted to a period of {} s, so that agreement is by construction.",
                        c.path, c.period
                    ))
            ),
        ),
        columns: if panels.len() > 2 { 2 } else { 1 },
        panels,
        provenance: format!("reduced model, {}", accuracy.told()),
    }
}
