//! The style of a series: its colour, line and marker.

use crate::axis::Paint;
use crate::canvas::LineStyle;
use crate::dash::Dash;
use crate::figure::{Series, Stroke};
use crate::marks;
use crate::theme::{CURVE_WIDTH, default_paint, rgb};

/// The style of a series.
#[derive(Debug, Clone, Copy)]
pub(crate) struct SeriesStyle {
    pub(crate) line: LineStyle,
    pub(crate) marker: marks::Marker,
}

/// The style of the `index`th series of a chart.
pub(crate) fn series_style(series: &Series, index: usize) -> SeriesStyle {
    let paint = series.color.unwrap_or(default_paint(index));
    let shape = match paint {
        _ if series.stroke == Stroke::Crosses => marks::CROSS,
        Paint::Palette(i) => i,
        Paint::Ink => marks::CROSS,
        Paint::Grey => index,
    };
    let hollow = series.stroke == Stroke::Hollow;
    let marker = marks::Marker { shape, hollow };
    SeriesStyle {
        line: LineStyle {
            color: rgb(paint),
            width: CURVE_WIDTH,
            dash: (series.stroke == Stroke::Dashed).then(|| Dash::of_width(CURVE_WIDTH)),
        },
        marker,
    }
}
