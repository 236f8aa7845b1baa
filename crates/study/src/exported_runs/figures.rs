//! The reduced parameters of exported runs: at the positions of the files, and between them.

use super::combine::ExportedRuns;
use super::sample_errors::all_of;
use super::sampled_model::SampledModel;
use crate::output::{chart, coordinate_axis};
use crate::reduce::compute::{coefficient_units, inertia_units};
use dwell_report::{Axis, Figure, Panel, Series, Stroke};

/// Reactions that are drawn, points between the positions, and about how many positions are marked.
const MAX_REACTIONS: usize = 2;
const POINTS: usize = 720;
const MARKS: usize = 36;

/// m, ½m′, and a and b of the first reactions over the coordinate.
pub(super) fn figure(runs: &ExportedRuns, model: &SampledModel, caption: String) -> Figure {
    let [m, half_dm] = inertia_units(runs.is_angle);
    let panel = |title: &str, symbol, unit, index| panel(runs, model, title, symbol, unit, index);
    let mut panels = vec![
        panel("m (generalised inertia)", "m", m, 0),
        panel("½m′ (half its derivative)", "½m′", half_dm, 1),
    ];
    let count = runs.reactions.len();
    for (r, (name, unit)) in runs.reactions.iter().take(MAX_REACTIONS).enumerate() {
        let [a, b] = coefficient_units(unit.as_deref().unwrap_or("N"), runs.is_angle);
        panels.push(panel(&format!("a of {name}"), "a", a, 2 + r));
        panels.push(panel(&format!("b of {name}"), "b", b, 2 + count + r));
    }
    Figure {
        name: "reduced".to_owned(),
        title: "Reduced parameters from two exported runs".to_owned(),
        caption,
        columns: 1,
        panels,
        provenance: format!("Dwell {}", env!("CARGO_PKG_VERSION")),
    }
}

/// The coefficient of a number among all.
fn panel(
    runs: &ExportedRuns,
    model: &SampledModel,
    title: &str,
    symbol: &str,
    unit: &str,
    index: usize,
) -> Panel {
    let x = |q: f64| if runs.is_angle { q.to_degrees() } else { q };
    let (first, last) = (runs.q[0], runs.q[runs.q.len() - 1]);
    let end = if runs.is_whole_revolution {
        first + std::f64::consts::TAU
    } else {
        last
    };
    let between = (0..=POINTS).filter_map(|k| {
        let q = first + (end - first) * k as f64 / POINTS as f64;
        Some([x(q), model.value(q, index)?])
    });
    let line = Series::line("between the positions", between.collect());
    let stride = runs.q.len().div_ceil(MARKS).max(1);
    let positions = runs.q.iter().zip(&runs.coefficients).step_by(stride);
    let points = positions
        .map(|(q, at)| [x(*q), all_of(at)[index]])
        .collect();
    let marked = Series::line("positions of the runs", points).stroke(Stroke::Points);
    let y = Axis::new(symbol, unit.replace('2', "²"));
    let axis = coordinate_axis(&runs.coordinate, runs.is_angle);
    chart(title, axis, y, vec![line, marked]).into()
}
