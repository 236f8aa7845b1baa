//! What the axes of a chart must show.

use crate::figure::{Axis, Chart, Mark, Scale, Series, Stroke};
use crate::span::{Span, drawable};

/// Empty part of a vertical span beyond the data.
const MARGIN: f64 = 0.06;
/// The same of a horizontal one, if markers stand at its ends.
const MARKER_MARGIN: f64 = 0.035;

/// The spans of a chart.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    pub(crate) x: Span,
    pub(crate) y: Span,
    pub(crate) y2: Option<Span>,
}

impl Extent {
    /// The axes' own ranges, or the extent of the data and of the reference lines and points.
    pub(crate) fn of(chart: &Chart) -> Self {
        Self::over(Self::across(&chart.x, std::slice::from_ref(chart)), chart)
    }

    /// What a horizontal axis must show to be that of all these charts.
    pub(crate) fn across(axis: &Axis, charts: &[Chart]) -> Span {
        let places = charts.iter().flat_map(|c| &c.marks).filter_map(place);
        let series = || charts.iter().flat_map(|c| &c.series);
        let lines_only = series().all(|s| !marked(s.stroke));
        // A point that has no height, such as an error of exactly 0, still took place: charts over the same time
        // keep the same axis.
        let across = series()
            .flat_map(|s| &s.points)
            .filter(|p| p[1].is_finite())
            .map(|p| p[0]);
        // A revolution is shown as exactly one.
        let margin = if lines_only || axis.scale == Scale::Degrees {
            0.0
        } else {
            MARKER_MARGIN
        };
        Span::of(axis, across.chain(places.filter_map(|p| p[0])), margin)
    }

    /// The spans of a chart whose horizontal one is given.
    pub(crate) fn over(x: Span, chart: &Chart) -> Self {
        let places = || chart.marks.iter().filter_map(place);
        let heights = |axis: &Axis, right: bool| {
            let here = |s: &&Series| (s.right_axis && chart.y2.is_some()) == right;
            let shown = |p: &&[f64; 2]| drawable(x.scale, p[0]) && (x.low..=x.high).contains(&p[0]);
            let series = || chart.series.iter().filter(here);
            let data = series().flat_map(|s| &s.points).filter(shown);
            let marks = places().filter(|_| !right).filter_map(|p| p[1]);
            let zero = series().any(|s| s.stroke == Stroke::Filled).then_some(0.0);
            let all = data.map(|p| p[1]).chain(marks).chain(zero);
            Span::of(axis, all, MARGIN)
        };
        Self {
            x,
            y: heights(&chart.y, false),
            y2: chart.y2.as_ref().map(|axis| heights(axis, true)),
        }
    }
}

/// Whether a series has markers, which need room at the ends.
pub(crate) fn marked(stroke: Stroke) -> bool {
    matches!(
        stroke,
        Stroke::Points | Stroke::Hollow | Stroke::Crosses | Stroke::LineAndPoints
    )
}

/// Where a mark is, on the axes it belongs to. Bands and power laws go as far as the axes do.
fn place(mark: &Mark) -> Option<[Option<f64>; 2]> {
    match mark {
        Mark::Vertical { at, .. } => Some([Some(*at), None]),
        Mark::Horizontal { at, .. } => Some([None, Some(*at)]),
        Mark::Point { at, .. } | Mark::Words { at, .. } => Some(at.map(Some)),
        Mark::Band { .. } | Mark::Slope { .. } => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn heights_are_those_in_the_horizontal_range() {
        let points = vec![[-1.0, 1e9], [0.0, 1.0], [1.0, 2.0], [2.0, -1e9]];
        let chart = Chart {
            x: Axis::default().within(0.0, 1.0),
            series: vec![Series::line("", points)],
            ..Chart::default()
        };
        let extent = Extent::of(&chart);
        assert!(extent.y.low > 0.5 && extent.y.high < 2.5);
    }

    #[test]
    fn an_error_of_zero_widens_the_time_axis_but_not_the_error_axis() {
        let points = vec![[0.0, 0.0], [1.0, 1e-9], [2.0, 1e-8], [f64::NAN, 1.0]];
        let chart = Chart {
            y: Axis::log("error", ""),
            series: vec![Series::line("", points)],
            ..Chart::default()
        };
        let extent = Extent::of(&chart);
        assert_eq!((extent.x.low, extent.x.high), (0.0, 2.0));
        assert!(extent.y.low > 1e-10);
    }

    #[test]
    fn a_tolerance_is_always_in_view_and_each_side_has_its_own_data() {
        let chart = Chart {
            y: Axis::log("error", ""),
            y2: Some(Axis::new("speed", "")),
            series: vec![
                Series::line("", vec![[0.0, 1e-15], [1.0, 1e-14]]),
                Series::line("", vec![[0.0, 5.0], [1.0, 7.0]]).right(),
            ],
            marks: vec![Mark::Horizontal {
                at: 1e-9,
                label: String::new(),
            }],
            ..Chart::default()
        };
        let extent = Extent::of(&chart);
        assert!(extent.y.high > 1e-9 && extent.y.high < 1.0);
        assert!(extent.y2.is_some_and(|s| s.low > 4.0 && s.high < 8.0));
    }
}
