//! The ranges of the axes of a chart.

use crate::axis::{Axis, Scale};
use crate::axis_range::{AxisRange, drawable};
use crate::figure::{Chart, Mark, Series, Stroke};

/// Empty part of a vertical span beyond the data.
const MARGIN: f64 = 0.06;
/// The same of a horizontal one, if markers stand at its ends.
const MARKER_MARGIN: f64 = 0.035;

/// The spans of a chart.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Extent {
    pub(crate) x: AxisRange,
    pub(crate) y: AxisRange,
    pub(crate) y2: Option<AxisRange>,
}

impl Extent {
    /// The axes' own ranges, or the extent of the data and of the reference lines and points.
    pub(crate) fn of(chart: &Chart) -> Self {
        let x = Self::horizontal(&chart.x, std::slice::from_ref(chart));
        Self::with_horizontal(x, chart)
    }

    /// What a horizontal axis must show to be that of all these charts.
    pub(crate) fn horizontal(axis: &Axis, charts: &[Chart]) -> AxisRange {
        let positions = charts.iter().flat_map(|c| &c.marks).filter_map(position);
        let series = || charts.iter().flat_map(|c| &c.series);
        let lines_only = series().all(|s| !has_markers(s.stroke));
        // A point that has no height, such as an error of exactly 0, still has an abscissa: charts over the same time
        // keep the same axis.
        let abscissae = series()
            .flat_map(|s| &s.points)
            .filter(|p| p[1].is_finite())
            .map(|p| p[0]);
        // A revolution is shown as exactly one.
        let margin = if lines_only || axis.scale == Scale::Degrees {
            0.0
        } else {
            MARKER_MARGIN
        };
        let all = abscissae.chain(positions.filter_map(|p| p[0]));
        AxisRange::of(axis, all, margin)
    }

    /// The spans of a chart whose horizontal one is given.
    pub(crate) fn with_horizontal(x: AxisRange, chart: &Chart) -> Self {
        let positions = || chart.marks.iter().filter_map(position);
        let vertical = |axis: &Axis, right: bool| {
            let on_this_axis = |s: &&Series| (s.right_axis && chart.y2.is_some()) == right;
            let in_view =
                |p: &&[f64; 2]| drawable(x.scale, p[0]) && (x.min..=x.max).contains(&p[0]);
            let series = || chart.series.iter().filter(on_this_axis);
            let data = series().flat_map(|s| &s.points).filter(in_view);
            let marks = positions().filter(|_| !right).filter_map(|p| p[1]);
            let zero = series().any(|s| s.stroke == Stroke::Filled).then_some(0.0);
            let all = data.map(|p| p[1]).chain(marks).chain(zero);
            AxisRange::of(axis, all, MARGIN)
        };
        Self {
            x,
            y: vertical(&chart.y, false),
            y2: chart.y2.as_ref().map(|axis| vertical(axis, true)),
        }
    }
}

/// Whether a series has markers, which need room at the ends.
pub(crate) fn has_markers(stroke: Stroke) -> bool {
    has_markers_only(stroke) || stroke == Stroke::LineAndPoints
}

/// Whether the points of a series are shown alone.
pub(crate) fn has_markers_only(stroke: Stroke) -> bool {
    matches!(stroke, Stroke::Points | Stroke::Hollow | Stroke::Crosses)
}

/// Where a mark is, on the axes it belongs to. Bands and power laws go as far as the axes do.
fn position(mark: &Mark) -> Option<[Option<f64>; 2]> {
    match mark {
        Mark::Vertical { at, .. } => Some([Some(*at), None]),
        Mark::Horizontal { at, .. } => Some([None, Some(*at)]),
        Mark::Point { at, .. } | Mark::Text { at, .. } => Some(at.map(Some)),
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
            x: Axis::default().with_range(0.0, 1.0),
            series: vec![Series::line("", points)],
            ..Chart::default()
        };
        let extent = Extent::of(&chart);
        assert!(extent.y.min > 0.5 && extent.y.max < 2.5);
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
        assert_eq!((extent.x.min, extent.x.max), (0.0, 2.0));
        assert!(extent.y.min > 1e-10);
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
        assert!(extent.y.max > 1e-9 && extent.y.max < 1.0);
        assert!(extent.y2.is_some_and(|s| s.min > 4.0 && s.max < 8.0));
    }
}
