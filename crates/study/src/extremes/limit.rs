//! Distances: to a limit position, to a flat parallelogram, to a dead point.

use super::grid::{Reading, Row, Stated, Told, decades, refused};
use super::shapes::{FourBar, SliderCrank};
use super::truth::{self, arc_cosine, wide};
use crate::estimate;
use dwell_geometry::{Reaction, Scalar, Vec2, Wide, vec2};
use dwell_kinetostatics::{Exact, Mass};

/// Roundings that an evaluation of a dyad's reduced model is allowed, each magnified by the condition: it
/// takes some hundred operations, whose roundings add up as their root.
pub(super) const ROUNDINGS: f64 = 16.0;

/// A triple rocker: coupler and rocker are stretched in one line at both ends of the crank's swing.
const ROCKER: FourBar = FourBar {
    base: [Vec2::ZERO, vec2(4.0, 0.0)],
    lengths: [2.0, 1.5, 1.625],
    start: [0.125, 1.0],
    ..super::shapes::CRANK_ROCKER
};

/// A parallelogram whose coupler has inertia of its own.
const PARALLELOGRAM: FourBar = FourBar {
    base: [Vec2::ZERO, vec2(2.0, 0.0)],
    lengths: [1.0, 2.0, 1.0],
    start: [1.0, 0.0],
    ..super::shapes::CRANK_ROCKER
};

/// A rod shorter than the crank: it stands across the guide where the crank can go no further.
const SHORT_ROD: SliderCrank = SliderCrank {
    lengths: [1.5, 1.0],
    height: 0.125,
    masses: [
        Mass {
            mass: 2.0,
            center: vec2(0.25, 0.125),
            inertia: 0.5,
        },
        Mass {
            mass: 1.5,
            center: vec2(0.5, 0.0625),
            inertia: 0.25,
        },
        Mass {
            mass: 1.0,
            center: Vec2::ZERO,
            inertia: 0.0,
        },
    ],
    start: [0.125, 0.0],
};

/// Page of these rows, and its title.
const FAMILY: (&str, &str) = ("limits", "Near limit positions");

pub(super) fn rows() -> Vec<Row> {
    vec![four_bar(), slider_crank(), parallelogram()]
}

/// m, ½m′ and what C's reaction has of q̈ and q̇² (the component along x).
pub(super) const REDUCED: [&str; 4] = ["m", "½m′", "a of C", "b of C"];

/// The reduced parameters of a four-bar against circle and circle.
pub(super) fn judged(bars: &FourBar, model: &Exact, side: f64, q: f64) -> Vec<Told> {
    let (got, error) = match estimate::reduced(model.model(), q) {
        Ok(both) => both,
        Err(error) => return refused(&error, REDUCED.len()),
    };
    let truth = truth::four_bar(bars, side, wide(q));
    let size = |v: Vec2<Wide>| v.dot(v).sqrt().value();
    vec![
        Ok(Reading::new(got.m, truth.m, error.m)),
        Ok(Reading::new(got.half_dm, truth.half_dm, error.half_dm)),
        Ok(Reading::new(got.a[0], truth.a.x, error.a[0]).of(size(truth.a))),
        Ok(Reading::new(got.b[0], truth.b.x, error.b[0]).of(size(truth.b))),
    ]
}

fn four_bar() -> Row {
    let [a, b, c] = ROCKER.lengths.map(wide);
    let d = wide(ROCKER.base[1].x);
    let reach = b + c;
    let limit = arc_cosine((a * a + d * d - reach * reach) / (wide(2.0) * a * d));
    let shape = ROCKER.shape();
    let reactions: Vec<Reaction> = shape.reactions("C");
    let model = shape.exact(&reactions);
    Row {
        family: FAMILY,
        key: "limit-four-bar".into(),
        what: "Four-bar: distance of the crank from its limit position".into(),
        parameter: ("distance δ", "rad"),
        values: decades(-1, -15),
        quantities: &REDUCED,
        truth: "circle and circle in 32 digits, at the same plain number φ",
        why: "the coordinate and the lengths are known to their rounding: m and a grow as 1/δ and err as φ eps/δ, \
              ½m′ and b as 1/δ² and err twice as much; 16 roundings",
        stated: Box::new(move |at, quantity| {
            let twice = if quantity % 2 == 1 { 2.0 } else { 1.0 };
            Stated::rounding(ROUNDINGS, twice * limit.value() / at)
        }),
        run: Box::new(move |at| match &model {
            Ok(model) => judged(&ROCKER, model, 1.0, (limit - wide(at)).value()),
            Err(error) => refused(&error, REDUCED.len()),
        }),
    }
}

fn slider_crank() -> Row {
    let [crank, rod] = SHORT_ROD.lengths.map(wide);
    let sine = (wide(SHORT_ROD.height) + rod) / crank;
    let limit = Wide::PI * wide(0.5) - arc_cosine(sine);
    let model = SHORT_ROD.shape(false).exact(&[]);
    Row {
        family: FAMILY,
        key: "limit-slider-crank".into(),
        what: "Slider-crank with a short rod: distance of the crank from its limit position".into(),
        parameter: ("distance δ", "rad"),
        values: decades(-1, -15),
        quantities: &REDUCED[..2],
        truth: "right-angled triangle in 32 digits, at the same plain number φ",
        why: "as of the four-bar: φ eps/δ for m, twice that for ½m′; 16 roundings",
        stated: Box::new(move |at, quantity| {
            let times = [1.0, 2.0][quantity];
            Stated::rounding(ROUNDINGS, times * limit.value() / at)
        }),
        run: Box::new(move |at| {
            let told = |model: &Exact| {
                let q = (limit - wide(at)).value();
                let (got, error) =
                    estimate::reduced(model.model(), q).map_err(|e| e.to_string())?;
                let [m, half_dm] = truth::slider_crank(&SHORT_ROD, wide(q));
                Ok(vec![
                    Ok(Reading::new(got.m, m, error.m)),
                    Ok(Reading::new(got.half_dm, half_dm, error.half_dm)),
                ])
            };
            let told = model.as_ref().map_err(Clone::clone).and_then(told);
            told.unwrap_or_else(|e: String| refused(&e, 2))
        }),
    }
}

fn parallelogram() -> Row {
    let model = PARALLELOGRAM.shape().exact(&[]);
    Row {
        family: FAMILY,
        key: "flat-parallelogram".into(),
        what: "Parallelogram: distance of the crank from the flat position".into(),
        parameter: ("distance δ", "rad"),
        values: decades(-1, -15),
        quantities: &["m", "½m′"],
        truth: "the coupler keeps its direction: m is constant but for what its centre and the rocker's add, \
                in closed form",
        why: "a length off by eps turns the coupler by eps/δ, its speed by eps/δ² and its acceleration by eps/δ³; \
              16 roundings. Branches meet at δ = 0",
        stated: Box::new(|at, quantity| Stated::rounding(ROUNDINGS, at.powi(-2 - quantity as i32))),
        run: Box::new(move |at| {
            let told = |model: &Exact| {
                let (got, error) =
                    estimate::reduced(model.model(), at).map_err(|e| e.to_string())?;
                let [m, half_dm] = truth::parallelogram(&PARALLELOGRAM);
                Ok(vec![
                    Ok(Reading::new(got.m, m, error.m)),
                    Ok(Reading::new(got.half_dm, half_dm, error.half_dm).of(m.value())),
                ])
            };
            let told = model.as_ref().map_err(Clone::clone).and_then(told);
            told.unwrap_or_else(|e: String| refused(&e, 2))
        }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use dwell_kinetostatics::Coefficients;

    /// The same plan in two words keeps twice as many digits as in one, at every distance: 1e-31 × some
    /// hundred roundings × the condition.
    #[test]
    fn val_the_plan_in_two_words() {
        let shape = ROCKER.shape();
        let exact = shape.exact(&shape.reactions("C")).expect("a model");
        let model = exact.model();
        for distance in decades(-1, -12) {
            // Of [2, 1.5, 1.625] on 4 m the crank stops at 0.8767… rad.
            let q = wide(0.876_755_514_351_7 - distance);
            let mut got: Coefficients<Wide> = model.coefficients();
            model
                .reduce(q, &mut model.workspace(), &mut got)
                .expect("a pose");
            let truth = truth::four_bar(&ROCKER, 1.0, q);
            let tolerance = 1e-28 / distance;
            let off = |a: Wide, b: Wide| ((a - b) / b).value().abs();
            assert!(off(got.m, truth.m) < tolerance, "{distance:e}");
            assert!(off(got.half_dm, truth.half_dm) < tolerance, "{distance:e}");
            assert!(off(got.a[0], truth.a.x) < tolerance, "{distance:e}");
            assert!(off(got.b[0], truth.b.x) < tolerance, "{distance:e}");
        }
    }
}
