//! Distances: to a limit position, to a flat parallelogram, to a dead point.

use super::closed_forms::{self, arc_cosine, dd};
use super::forms::{Form, FormModel};
use super::mechanisms::{FourBar, SliderCrank, mass};
use super::series::{
    ALLOWED_ROUNDINGS, ParameterSeries, Requirement, RunResult, cell, decades, scaled_cell,
};
use dwell_geometry::{Vec2, vec2};
use dwell_numerics::{DoubleDouble, Scalar};

/// A triple rocker: coupler and rocker are stretched in one line at both ends of the crank's swing.
const ROCKER: FourBar = FourBar {
    base: [Vec2::ZERO, vec2(4.0, 0.0)],
    lengths: [2.0, 1.5, 1.625],
    assembly: [0.125, 1.0],
    ..super::mechanisms::CRANK_ROCKER
};

/// A parallelogram whose coupler has inertia of its own.
const PARALLELOGRAM: FourBar = FourBar {
    base: [Vec2::ZERO, vec2(2.0, 0.0)],
    lengths: [1.0, 2.0, 1.0],
    assembly: [1.0, 0.0],
    ..super::mechanisms::CRANK_ROCKER
};

/// A rod shorter than the crank: it stands across the guide where the crank can go no further.
const SHORT_ROD: SliderCrank = SliderCrank {
    lengths: [1.5, 1.0],
    height: 0.125,
    masses: [
        mass(2.0, [0.25, 0.125], 0.5),
        mass(1.5, [0.5, 0.0625], 0.25),
        mass(1.0, [0.0, 0.0], 0.0),
    ],
    assembly: [0.125, 0.0],
};

/// Figure of these rows, and its title.
const FIGURE: (&str, &str) = ("limits", "Near limit positions");

pub(super) fn series(form: Form) -> Vec<ParameterSeries> {
    vec![four_bar(form), slider_crank(form), parallelogram(form)]
}

/// m, ½m′, and the coefficients of q̈ and q̇² in the reaction of C (component along x).
pub(super) const QUANTITIES: [&str; 4] = ["m", "½m′", "a of C", "b of C"];

/// The reduced parameters of a four-bar against the closed form by the intersection of circles.
pub(super) fn compare_four_bar(four_bar: &FourBar, model: &FormModel, q: f64) -> RunResult {
    let (computed, error) = model.coefficients_with_errors(q)?;
    let reference = closed_forms::four_bar(four_bar, dd(q));
    let (a, b) = (reference.a, reference.b);
    let size = |v: Vec2<DoubleDouble>| v.dot(v).sqrt().value();
    Ok(vec![
        cell((computed.m, error.m), reference.m),
        cell((computed.half_dm, error.half_dm), reference.half_dm),
        scaled_cell((computed.a[0], error.a[0]), a.x, size(a)),
        scaled_cell((computed.b[0], error.b[0]), b.x, size(b)),
    ])
}

fn four_bar(form: Form) -> ParameterSeries {
    let [a, b, c] = ROCKER.lengths.map(dd);
    let d = dd(ROCKER.base[1].x);
    let stretched = b + c;
    let limit = arc_cosine((a * a + d * d - stretched * stretched) / (dd(2.0) * a * d));
    ParameterSeries {
        figure: FIGURE,
        key: "limit-four-bar".into(),
        description: "Four-bar: distance of the crank from its limit position".into(),
        parameter: ("distance δ", "rad"),
        values: decades(-1, -15),
        quantities: &QUANTITIES,
        reference: "circle and circle in 32 digits, at the same double-precision number φ",
        reason: "the coordinate and the lengths are known to their rounding: m and a grow as 1/δ and err as φ eps/δ, \
              ½m′ and b as 1/δ² and err twice as much; 16 roundings",
        requirement: Box::new(move |at, quantity| {
            let factor = if quantity % 2 == 1 { 2.0 } else { 1.0 };
            Requirement::from_rounding(ALLOWED_ROUNDINGS, factor * limit.value() / at)
        }),
        run: Box::new(move |at| {
            let q = form.coordinate((limit - dd(at)).value());
            let model = FormModel::of(form, &ROCKER.text(), "C", Some([q, at]))?;
            compare_four_bar(&ROCKER, &model, q)
        }),
    }
}

fn slider_crank(form: Form) -> ParameterSeries {
    let [crank, rod] = SHORT_ROD.lengths.map(dd);
    let sine = (dd(SHORT_ROD.height) + rod) / crank;
    let limit = DoubleDouble::PI * dd(0.5) - arc_cosine(sine);
    ParameterSeries {
        figure: FIGURE,
        key: "limit-slider-crank".into(),
        description: "Slider-crank with a short rod: distance of the crank from its limit position"
            .into(),
        parameter: ("distance δ", "rad"),
        values: decades(-1, -15),
        quantities: &QUANTITIES[..2],
        reference: "right-angled triangle in 32 digits, at the same double-precision number φ",
        reason: "as of the four-bar: φ eps/δ for m, twice that for ½m′; 16 roundings",
        requirement: Box::new(move |at, quantity| {
            let factor = [1.0, 2.0][quantity];
            Requirement::from_rounding(ALLOWED_ROUNDINGS, factor * limit.value() / at)
        }),
        run: Box::new(move |at| {
            let q = form.coordinate((limit - dd(at)).value());
            let model = FormModel::of(form, &SHORT_ROD.text(false), "", Some([q, at]))?;
            let (computed, error) = model.coefficients_with_errors(q)?;
            let [m, half_dm] = closed_forms::slider_crank(&SHORT_ROD, dd(q));
            let m = cell((computed.m, error.m), m);
            Ok(vec![m, cell((computed.half_dm, error.half_dm), half_dm)])
        }),
    }
}

fn parallelogram(form: Form) -> ParameterSeries {
    ParameterSeries {
        figure: FIGURE,
        key: "flat-parallelogram".into(),
        description: "Parallelogram: distance of the crank from the flat position".into(),
        parameter: ("distance δ", "rad"),
        values: decades(-1, -15),
        quantities: &["m", "½m′"],
        reference: "the coupler keeps its direction: m is constant but for what its centre and the rocker's add, \
                in closed form",
        reason: "a length off by eps rotates the coupler by eps/δ, its speed by eps/δ² and its acceleration by eps/δ³; \
              16 roundings. Branches meet at δ = 0",
        requirement: Box::new(|at, quantity| {
            Requirement::from_rounding(ALLOWED_ROUNDINGS, at.powi(-2 - quantity as i32))
        }),
        run: Box::new(move |at| {
            let q = form.coordinate(at);
            let model = FormModel::of(form, &PARALLELOGRAM.text(), "", Some([q, at]))?;
            let (computed, error) = model.coefficients_with_errors(q)?;
            let [m, half_dm] = closed_forms::parallelogram(&PARALLELOGRAM);
            Ok(vec![
                cell((computed.m, error.m), m),
                scaled_cell((computed.half_dm, error.half_dm), half_dm, m.value()),
            ])
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::super::mechanisms::reduced;
    use super::*;
    use dwell_kinetostatics::Coefficients;

    /// The plan in double-double numbers keeps twice as many digits as in double precision, at every distance: 1e-31 × some
    /// hundred rounding errors × the condition number.
    #[test]
    fn val_the_plan_in_two_words() {
        let exact = reduced(&ROCKER.text(), "C").expect("a model");
        let model = exact.model();
        for distance in decades(-1, -12) {
            // Of [2, 1.5, 1.625] on 4 m the crank stops at 0.8767… rad.
            let q = dd(0.876_755_514_351_7 - distance);
            let mut computed: Coefficients<DoubleDouble> = model.coefficient_buffer();
            model
                .reduce(q, &mut model.workspace(), &mut computed)
                .expect("a pose");
            let reference = closed_forms::four_bar(&ROCKER, q);
            let tolerance = 1e-28 / distance;
            for (value, exact) in [
                (computed.m, reference.m),
                (computed.half_dm, reference.half_dm),
                (computed.a[0], reference.a.x),
                (computed.b[0], reference.b.x),
            ] {
                let error = ((value - exact) / exact).value().abs();
                assert!(error < tolerance, "{distance:e}");
            }
        }
    }
}
