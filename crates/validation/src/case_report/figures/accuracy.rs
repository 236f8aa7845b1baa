//! How accurate a case's results are: margins of its checks, the effect of rounding, errors of finite differences.

use crate::checked::rounding_check::StateRounding;
use crate::checked::states::CheckedStates;
use crate::report_parts::{margin, margin_text, nearest};
use dwell_findings::{Check, Finding};
use dwell_report::{Axis, Cell, Chart, Figure, Grid, Group, Mark, Row, Series, Stroke};
use dwell_scene::PlaneScene;
use dwell_study::PreparedScene;
use dwell_study::number_format::count;
use dwell_study::output::{chart, figure};
use dwell_verify::ErrorCurve;

/// Difference, tolerance and margin of the finding of each check that is nearest to its tolerance, and of all that fail.
pub(crate) fn margins(scene: &PlaneScene, findings: &[Finding]) -> Figure {
    let rows = Check::ALL.into_iter().flat_map(|check| {
        let of_check = move || findings.iter().filter(move |f| f.check == check);
        let failed = of_check().filter(|f| !f.pass);
        let nearest = nearest(of_check()).filter(|f| f.pass);
        failed
            .chain(nearest)
            .map(move |f| row(f, of_check().count()))
    });
    let grid = Grid {
        columns: ["difference", "tolerance", "margin"]
            .map(str::to_owned)
            .into(),
        groups: vec![Group {
            heading: String::new(),
            rows: rows.collect(),
        }],
        values: Axis::log("margin: tolerance over difference", "").with_range(1.0, 1e4),
        compact: true,
        ..Grid::default()
    };
    let text = "Of each check the finding that is nearest to its tolerance, and how many it has; = where there is no difference.";
    let provenance = format!(
        "{}, each with its own check and tolerance",
        count(findings.len(), "finding")
    );
    figure(
        scene,
        "margins",
        "Margins of all checks",
        text,
        vec![grid.into()],
        provenance,
    )
}

fn row(finding: &Finding, of: usize) -> Row {
    let number = |value: f64| {
        let text = format!("{value:.1e}").replace('-', "−");
        Some(Cell::text_only(if value == 0.0 {
            "0".to_owned()
        } else {
            text
        }))
    };
    let margin = margin(finding);
    let last = match finding.pass {
        true => Cell::new(margin.min(1e4), margin_text(margin)),
        false => Cell::text_only("FAIL").failed(),
    };
    let name = format!("{}: {} (of {of})", finding.check, finding.key);
    let (difference, tolerance) = (finding.relative_difference, finding.tolerance);
    Row::new(
        name,
        vec![number(difference), number(tolerance), Some(last)],
    )
}

/// A smaller error is drawn at this value.
const MIN_DRAWN_ERROR: f64 = 1e-18;

/// The errors of `f64` and `f32` along the motion that was checked.
pub(crate) fn rounding(
    scene: &PlaneScene,
    checked: &CheckedStates,
    rounding: &[StateRounding],
) -> Figure {
    let drawn = &rounding[..checked.drawn_count.min(rounding.len())];
    let points = |of: &dyn Fn(&StateRounding) -> Option<f64>| -> Vec<[f64; 2]> {
        let at = |s: &StateRounding| of(s).map(|error| [s.t, error.max(MIN_DRAWN_ERROR)]);
        drawn.iter().filter_map(at).collect()
    };
    let chart = Chart {
        x: Axis::new("time", "s"),
        y: Axis::log("relative error", "").with_range(MIN_DRAWN_ERROR, 1.0),
        series: vec![
            Series::line("f32", points(&|s| s.f32_error)).stroke(Stroke::LineAndPoints),
            Series::line("f64", points(&|s| Some(s.f64_error))).stroke(Stroke::LineAndPoints),
        ],
        marks: vec![
            Mark::horizontal(f64::from(f32::EPSILON), "last place of f32"),
            Mark::horizontal(f64::EPSILON, "last place of f64"),
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

/// Error against step, one panel a quantity.
pub(crate) fn finite_differences(prepared: &PreparedScene<'_>, curves: &[ErrorCurve]) -> Figure {
    let panel = |curve: &ErrorCurve| {
        let points = |errors: &[(f64, f64)]| errors.iter().map(|&(h, e)| [h, e]).collect();
        let line =
            |name: &str, errors| Series::line(name, points(errors)).stroke(Stroke::LineAndPoints);
        let x = Axis::log("step h", "rad");
        let y = Axis::log("relative difference", "").with_range(1e-17, 1e1);
        let lines = vec![
            line("central difference", &curve.second_order),
            line("extrapolated once", &curve.fourth_order),
            line("extrapolated twice", &curve.sixth_order),
        ];
        let title = format!("{} at {:.3} rad", curve.quantity, curve.q);
        let mut chart = chart(title, x, y, lines);
        let rounding = Mark::horizontal(f64::EPSILON, "one rounding");
        chart.marks.push(rounding);
        chart.into()
    };
    // A quantity that is zero has no relative error.
    let has_points = |curve: &&ErrorCurve| {
        curve
            .second_order
            .iter()
            .any(|&(_, error)| error > 0.0 && error.is_finite())
    };
    figure(
        prepared.scene,
        "differences",
        "Unit runs against differences of the kinetic energy",
        "Differences of the unit-run coefficients from finite differences, over the step. The V is the error of the \
         differences: truncation on the right, rounding on the left. ½m′ is differenced from E(q); b with the joint \
         really released, ∂m₁₂/∂q₁ − ½ ∂m₁/∂q₂.",
        curves.iter().filter(has_points).map(panel).collect(),
        "reduced model by unit runs, and differences of the kinetic energy",
    )
}
