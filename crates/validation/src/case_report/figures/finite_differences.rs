//! The V-shaped error of finite differences.

use dwell_report::{Axis, Figure, Mark, Series, Stroke};
use dwell_study::PreparedScene;
use dwell_study::output::{chart, figure};
use dwell_verify::ErrorCurve;

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
        chart.marks.push(Mark::Horizontal {
            at: f64::EPSILON,
            label: "one rounding".to_owned(),
        });
        chart.into()
    };
    figure(
        prepared.scene,
        "differences",
        "Unit runs against differences of the kinetic energy",
        "Differences of the unit-run coefficients from finite differences, over the step. The V is the error of the \
         differences: truncation on the right, rounding on the left. ½m′ is differenced from E(q); b with the joint \
         really released, ∂m₁₂/∂q₁ − ½ ∂m₁/∂q₂.",
        curves.iter().map(panel).collect(),
        "reduced model by unit runs, and differences of the kinetic energy",
    )
}
