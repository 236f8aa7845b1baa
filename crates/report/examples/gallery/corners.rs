//! Awkward cases: long words, many series, one point, three columns.

use crate::charts::sampled;
use crate::linkage::block;
use dwell_report::{Axis, Chart, Drawing, Figure, Paint, Pen, Series, Shape, Stroke};

// Long: one picture, written out as data.
pub(crate) fn corners() -> Figure {
    let many = Chart {
        title: "A title that is much too long for the panel it stands above, and is set smaller"
            .to_owned(),
        x: Axis::new(
            "a label that is rather long as well, longer than the axis it belongs to is wide",
            "kg m²",
        ),
        y: Axis::new(
            "a vertical label that does not fit the height of its panel at all",
            "N m s²/rad²",
        ),
        series: (0..8)
            .map(|i| {
                Series::line(
                    format!("series {i}"),
                    sampled(300, -3.0, 3.0, |x| (x + f64::from(i)).tanh()),
                )
            })
            .collect(),
        ..Chart::default()
    };
    let one = Chart {
        title: "One point".to_owned(),
        x: Axis::new("q", "m"),
        y: Axis::log("error", ""),
        series: vec![Series::line("only", vec![[2.0, 3e-7]]).stroke(Stroke::Points)],
        ..Chart::default()
    };
    let constant = Chart {
        title: "A constant and large numbers".to_owned(),
        x: Axis::new("revolutions", "").with_range(0.0, 1e6),
        y: Axis::new("stiffness", "N/m"),
        series: vec![Series::line("k", vec![[0.0, 2.5e8], [1e6, 2.5e8]])],
        ..Chart::default()
    };
    let tall = Drawing {
        title: "Tall".to_owned(),
        x: Axis::new("x", "m"),
        y: Axis::new("y", "m"),
        shapes: vec![
            Shape::area(
                block([0.0, 0.0], 0.4, [0.2, 2.0]),
                Pen::new(Paint::Palette(5), 4.0),
                0.3,
            )
            .named("bar"),
            Shape::GroundPin { at: [0.0, 0.0] },
        ],
        ..Drawing::default()
    };
    let flat = Drawing {
        title: "Flat".to_owned(),
        x: Axis::new("x", "m"),
        y: Axis::new("y", "m"),
        shapes: vec![
            Shape::line(
                vec![[0.0, 0.0], [5.0, 0.0]],
                Pen::new(Paint::Palette(0), 8.0),
            ),
            Shape::pin([5.0, 0.0], Paint::Ink, 0.0),
        ],
        ..Drawing::default()
    };
    Figure {
        name: "corners".to_owned(),
        title: "Awkward cases".to_owned(),
        caption: "Nothing here may overlap or be cut.".to_owned(),
        columns: 3,
        panels: vec![
            many.into(),
            one.into(),
            constant.into(),
            tall.into(),
            flat.into(),
        ],
        ..Figure::default()
    }
}
