//! What rounding does to the kinetostatics of a case.

use super::foot;
use crate::rounding::{Rounded, Rounding};
use crate::states::Judged;
use crate::words::count;
use dwell_report::{Axis, Chart, Figure, Mark, Panel, Series, Stroke};
use dwell_scene::Scene;

/// An error below this is drawn here.
const EXACT: f64 = 1e-18;

/// The errors of `f64` and `f32` along the motion that was judged.
pub(crate) fn rounding(scene: &Scene, judged: &Judged, rounding: &Rounding) -> Figure {
    let drawn = &rounding.states[..judged.drawn.min(rounding.states.len())];
    let points = |of: &dyn Fn(&Rounded) -> Option<f64>| -> Vec<[f64; 2]> {
        let at = |s: &Rounded| of(s).map(|error| [s.t, error.max(EXACT)]);
        drawn.iter().filter_map(at).collect()
    };
    let last_place = |at: f64, label: &str| Mark::Horizontal {
        at,
        label: label.to_owned(),
    };
    Figure {
        name: "i-rounding".to_owned(),
        title: "What rounding does".to_owned(),
        caption: foot(
            scene,
            &format!(
                "The worst error of an action or a reaction in each state along {}, as a part of the largest of its unit: \
                 the same evaluation in f32 and in f64, held against numbers of 32 digits.",
                judged.motion
            ),
        ),
        columns: 1,
        panels: vec![Panel::from(Chart {
            x: Axis::new("time", "s"),
            y: Axis::log("relative error", "").within(EXACT, 1.0),
            series: vec![
                Series::line("f32", points(&|s| s.short)).stroke(Stroke::LineAndPoints),
                Series::line("f64", points(&|s| Some(s.plain))).stroke(Stroke::LineAndPoints),
            ],
            marks: vec![
                last_place(f64::from(f32::EPSILON), "last place of f32"),
                last_place(f64::EPSILON, "last place of f64"),
            ],
            ..Chart::default()
        })],
        provenance: format!(
            "exact evaluation in f32, f64 and 32 digits at {}",
            count(drawn.len(), "state")
        ),
    }
}
