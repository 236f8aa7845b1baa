//! Speed and reactions in time: the paper's Figure 4.

use crate::checked::history::History;
use dwell_report::{Axis, Chart, Figure, Mark, Panel, Series};
use dwell_study::PreparedScene;
use dwell_study::SolverSettings;
use dwell_study::output::{caption, coordinate_label, symbol};

/// Turns that are drawn; more would only repeat.
const DRAWN_PERIODS: f64 = 2.0;
/// Most reactions to a panel.
const MAX_CURVES: usize = 6;

/// The motion over two periods (or all of it, where it has none).
pub(crate) fn history(
    prepared: &PreparedScene<'_>,
    history: &History,
    accuracy: &SolverSettings,
) -> Figure {
    let drawn = history.period.map_or(f64::INFINITY, |period| {
        DRAWN_PERIODS * period * (1.0 + 1e-9)
    });
    let samples: Vec<usize> = (0..history.run.samples.len())
        .filter(|&i| history.run.samples[i].t - history.run.samples[0].t <= drawn)
        .collect();
    let curve = |of: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        let at = |&i: &usize| [history.run.samples[i].t, of(i)];
        samples.iter().map(at).collect()
    };
    let marks: Vec<Mark> = history
        .run
        .event_occurrences
        .iter()
        .map(|revolution| revolution.state.t)
        .take_while(|t| *t <= drawn)
        .enumerate()
        .map(|(k, at)| Mark::Vertical {
            at,
            label: if k == 0 {
                format!("T = {at:.4} s")
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
    let q = symbol(prepared.coordinate_name());
    let angle = coordinate_label(prepared);
    let speed = Series::line("", curve(&|i| history.run.samples[i].y[1]));
    let mut panels = vec![chart(
        format!("Speed of the {angle}"),
        format!("d{q}/dt"),
        "rad/s",
        vec![speed],
    )];
    let reactions = prepared.reaction_units();
    for (unit, noun) in [("N", "force"), ("N m", "moment")] {
        let of_unit: Vec<usize> = (0..reactions.len())
            .filter(|&k| reactions[k].1 == unit)
            .collect();
        let per_panel = of_unit
            .len()
            .div_ceil(of_unit.len().div_ceil(MAX_CURVES).max(1))
            .max(1);
        for group in of_unit.chunks(per_panel).take(2) {
            let line = |&k: &usize| {
                let name = if group.len() > 1 {
                    reactions[k].0.clone()
                } else {
                    String::new()
                };
                Series::line(name, curve(&|i| history.rows[i][2 + k]))
            };
            let (title, label) = match group {
                [k] => (
                    format!("Reaction {}", reactions[*k].0),
                    reactions[*k].0.clone(),
                ),
                [first, .., last] => (
                    format!(
                        "Reactions {} to {}",
                        reactions[*first].0, reactions[*last].0
                    ),
                    format!("reaction {noun}"),
                ),
                [] => continue,
            };
            let unit = if unit == "N" { "N" } else { "N m" };
            panels.push(chart(title, label, unit, group.iter().map(line).collect()));
        }
    }
    Figure {
        name: "motion".to_owned(),
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
        provenance: format!("reduced model, {}", accuracy.describe()),
    }
}
