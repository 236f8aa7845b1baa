//! Equilibria on the static force, and on the potential of a conservative machine.

use crate::equilibria::compute::{EquilibriaResults, StaticCurves};
use crate::machines::MachineScene;
use crate::number_format::{count, force_unit};
use crate::output::{chart, coordinate_axis, figure, symbol};
use dwell_dynamics::Stability;
use dwell_report::{Axis, Figure, Mark, Paint, Panel, Series, Stroke};

/// The curves with the equilibria found.
pub(crate) fn equilibria(
    results: &EquilibriaResults<'_, impl MachineScene>,
    curves: &StaticCurves,
) -> Figure {
    let prepared = &results.prepared;
    let (actuator, angle) = prepared.first_free_coordinate();
    let name = symbol(prepared.coordinate_name(actuator));
    let x = |q: f64| if angle { q.to_degrees() } else { q };
    let panel = |title: &str, y: Axis, k: usize| {
        let pairs = curves.q.iter().zip(&curves.force_and_potential);
        let line = Series::line("", pairs.map(|(q, values)| [x(*q), values[k]]).collect());
        let points = results.found.iter().zip(&curves.at_equilibria);
        let (intervals, points): (Vec<_>, Vec<_>) =
            points.partition(|(e, _)| e.neutral.iter().any(|neutral| neutral.extent.is_some()));
        let points = points.into_iter();
        let points = points.map(|(e, values)| (e.stability, [x(e.y[0]), values[k]]));
        let (stable, others): (Vec<_>, Vec<_>) = points.partition(|(stability, _)| {
            matches!(stability, Stability::Asymptotic | Stability::Centre)
        });
        let mut series = vec![line];
        if !stable.is_empty() {
            let points = stable.into_iter().map(|(_, at)| at).collect();
            let filled = Series::line("stable", points).stroke(Stroke::Points);
            series.push(filled.color(Paint::Palette(1)));
        }
        for (e, values) in intervals {
            let extents = e.neutral.iter().filter_map(|neutral| neutral.extent);
            series.extend(extents.map(|extent| {
                let ends = extent.map(|q| [x(q), values[k]]);
                let interval = Series::line("every position an equilibrium", ends.to_vec());
                interval.color(Paint::Palette(1))
            }));
        }
        let mut chart = chart(title, coordinate_axis(&name, angle), y, series);
        for (_, at) in others {
            let label = String::new();
            chart.marks.push(Mark::Point { at, label });
        }
        if k == 0 {
            let (at, label) = (0.0, String::new());
            chart.marks.push(Mark::Horizontal { at, label });
        }
        Panel::from(chart)
    };
    let force = Axis::new("Q", force_unit(angle));
    let mut panels = vec![panel("Static generalised force", force, 0)];
    if prepared.machine.nonconservative_sources().is_empty() {
        panels.push(panel("Potential energy", Axis::new("V", "J"), 1));
    }
    let text = "Filled: stable equilibria; rings: others. Drives are in their steady state at each position.";
    let positions = count(curves.q.len(), "position");
    let method = format!("static force at {positions}, and its zeros");
    let (scene, title) = (prepared.scene, "Equilibria");
    figure(scene, "equilibria", title, text, panels, method)
}
