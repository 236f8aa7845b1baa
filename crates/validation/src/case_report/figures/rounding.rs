//! The effect of rounding on the kinetostatics of a case.

use crate::checked::rounding_check::StateRounding;
use crate::checked::states::CheckedStates;
use dwell_report::{Axis, Chart, Figure, Mark, Series, Stroke};
use dwell_scene::Scene;
use dwell_study::number_format::count;
use dwell_study::output::figure;

/// A smaller error is drawn at this value.
const MIN_DRAWN_ERROR: f64 = 1e-18;

/// The errors of `f64` and `f32` along the motion that was checked.
pub(crate) fn rounding(
    scene: &Scene,
    checked: &CheckedStates,
    rounding: &[StateRounding],
) -> Figure {
    let drawn = &rounding[..checked.drawn_count.min(rounding.len())];
    let points = |of: &dyn Fn(&StateRounding) -> Option<f64>| -> Vec<[f64; 2]> {
        let at = |s: &StateRounding| of(s).map(|error| [s.t, error.max(MIN_DRAWN_ERROR)]);
        drawn.iter().filter_map(at).collect()
    };
    let precision_mark = |at: f64, label: &str| Mark::Horizontal {
        at,
        label: label.to_owned(),
    };
    let chart = Chart {
        x: Axis::new("time", "s"),
        y: Axis::log("relative error", "").with_range(MIN_DRAWN_ERROR, 1.0),
        series: vec![
            Series::line("f32", points(&|s| s.f32_error)).stroke(Stroke::LineAndPoints),
            Series::line("f64", points(&|s| Some(s.f64_error))).stroke(Stroke::LineAndPoints),
        ],
        marks: vec![
            precision_mark(f64::from(f32::EPSILON), "last place of f32"),
            precision_mark(f64::EPSILON, "last place of f64"),
        ],
        ..Chart::default()
    };
    let text = format!(
        "The largest error of an actuator force or a reaction in each state along {}, as a part of the largest of its unit: \
         the same evaluation in f32 and in f64, compared with numbers of 32 digits.",
        checked.motion_text
    );
    let states = count(drawn.len(), "state");
    let provenance = format!("exact evaluation in f32, f64 and 32 digits at {states}");
    figure(
        scene,
        "rounding",
        "Effect of rounding",
        &text,
        vec![chart.into()],
        provenance,
    )
}
