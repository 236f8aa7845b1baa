//! A chart in a cell of the page.

use crate::axes::{self, PlotFrame, VerticalAxisStyle};
use crate::axis::Axis;
use crate::canvas::{Align, Canvas, LineStyle, TextStyle};
use crate::coincidence;
use crate::curve::{clipped, clipped_area};
use crate::end_labels::{self, EndLabel};
use crate::extent::{Extent, has_markers, has_markers_only};
use crate::figure::{Chart, Series, Stroke};
use crate::layout_record::LayoutRecord;
use crate::legend::{self, LegendEntry, LegendHandle, PlacedLegend};
use crate::linear_ticks::Ticks;
use crate::marks;
use crate::occupancy::Occupancy;
use crate::rect::{Insets, Rect};
use crate::series_style::{SeriesStyle, series_style};
use crate::theme::{CURVE_WIDTH, GREY, INK, LABEL_SIZE, Rgb, SPINE_WIDTH, lightened};
use crate::typeset::typeset;

/// Height of a chart's cell as a share of its width.
pub(crate) const HEIGHT: f64 = 0.68;
/// Markers of a line closer together than this add nothing.
const MARKER_STEP: f64 = 15.0;
/// Opacity of an area.
const FILL_OPACITY: f64 = 0.22;

/// A chart with its spans found.
pub(crate) struct PreparedChart<'a> {
    chart: &'a Chart,
    styles: Vec<SeriesStyle>,
    pub(crate) extent: Extent,
    /// The horizontal axis in words; a chart in a stack leaves them to the lowest.
    x_axis: Option<&'a Axis>,
}

/// Where things go in the cell.
struct Layout {
    frame: PlotFrame,
    /// Those of the curves, such that none hides another.
    styles: Vec<SeriesStyle>,
    end_labels: Option<Vec<EndLabel>>,
    legend: Option<PlacedLegend>,
    occupied: Occupancy,
}

/// Room for the words "no data".
fn no_data_area(frame: &PlotFrame) -> Rect {
    let [x, y] = frame.plot.centre();
    Rect::sized(x, y, 0.0, 0.0).grown(2.5 * LABEL_SIZE)
}

impl<'a> PreparedChart<'a> {
    pub(crate) fn new(chart: &'a Chart) -> Self {
        Self::with(chart, Extent::of(chart), Some(&chart.x))
    }

    /// Charts over the horizontal axis of the first.
    pub(crate) fn stacked(charts: &'a [Chart]) -> Vec<Self> {
        let Some(first) = charts.first() else {
            return Vec::new();
        };
        let x = Extent::horizontal(&first.x, charts);
        let lowest = charts.len() - 1;
        let prepared = |(place, chart)| {
            let axis = (place == lowest).then_some(&first.x);
            Self::with(chart, Extent::with_horizontal(x, chart), axis)
        };
        charts.iter().enumerate().map(prepared).collect()
    }

    fn with(chart: &'a Chart, extent: Extent, x_axis: Option<&'a Axis>) -> Self {
        let looks = chart.series.iter().enumerate();
        Self {
            chart,
            styles: looks.map(|(i, series)| series_style(series, i)).collect(),
            extent,
            x_axis,
        }
    }

    /// The series with their styles.
    fn series(&self) -> impl Iterator<Item = (&'a Series, &SeriesStyle)> {
        self.chart.series.iter().zip(&self.styles)
    }

    fn frame(&self, plot: Rect) -> PlotFrame {
        let Extent { x, y, y2 } = self.extent;
        PlotFrame { plot, x, y, y2 }
    }

    /// Widths of the strips that the labels need in a cell of this size.
    pub(crate) fn insets(&self, cell: &Rect) -> Insets {
        let chart = self.chart;
        // A first guess of the sides: ticks depend on the plot, and the plot on their labels.
        let sides = 0.13 * cell.width();
        let x_ticks = axes::horizontal_ticks(&self.extent.x, cell.width() - sides);
        let mut insets = Insets {
            left: sides,
            top: axes::top_room(&chart.title, cell),
            right: axes::right_room(),
            bottom: axes::bottom_room(self.x_axis, &x_ticks, cell),
        };
        let height = cell.inset(insets).height();
        let side =
            |axis, range| axes::side_room(axis, &axes::vertical_ticks(range, height), height);
        insets.left = side(&chart.y, &self.extent.y);
        if let (Some(axis), Some(range)) = (&chart.y2, &self.extent.y2) {
            insets.right = side(axis, range);
        }
        let frame = self.frame(cell.inset(insets));
        if let Some(end_labels) = end_labels::at_ends(chart, &self.styles, &frame) {
            insets.right = insets.right.max(end_labels::room(&end_labels));
        }
        insets
    }

    /// Draws the chart.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>, cell: &Rect, insets: Insets) {
        let chart = self.chart;
        let layout = self.layout(cell, insets);
        let frame = layout.frame;
        let x_ticks = axes::horizontal_ticks(&frame.x, frame.plot.width());
        let y_ticks = axes::vertical_ticks(&frame.y, frame.plot.height());
        marks::bands(canvas, &frame, &chart.marks);
        axes::grid_lines(canvas, &frame, &x_ticks, &y_ticks);
        marks::lines(canvas, &frame, &chart.marks);
        // Under the curves: a marker at the very edge is a datum, the spine is not.
        axes::horizontal_axis(canvas, &frame, cell, self.x_axis, &x_ticks);
        let Rect { y0, y1, .. } = cell.inset(insets);
        self.vertical_axes(canvas, &frame, cell, (y0, y1), &y_ticks);
        for (series, style) in self.series() {
            draw_area(canvas, &frame, series, style);
        }
        canvas.note(LayoutRecord::begin_plot);
        let lines = self.lines(&frame);
        for (k, (series, style)) in chart.series.iter().zip(&layout.styles).enumerate() {
            canvas.note(|record| record.begin_curve(Some(&typeset(&series.name))));
            draw_series(canvas, &frame, series, style);
            let own = self.styles[k].line;
            if style.line.dash != own.dash {
                let alone = coincidence::alone(k, &lines, &frame.plot);
                alone.iter().for_each(|line| canvas.line(line, own));
            }
        }
        canvas.note(|record| record.begin_curve(None));
        marks::rings(canvas, &frame, &chart.marks);
        axes::title(canvas, &chart.title, &frame.plot, cell);
        if let Some(end_labels) = &layout.end_labels {
            end_labels::draw(canvas, end_labels, &frame.plot);
        }
        if let Some(legend) = &layout.legend {
            legend.draw(canvas);
        }
        let mut written: Vec<Rect> = layout.legend.iter().map(|legend| legend.area).collect();
        if !self.has_data(&frame) {
            let [x, y] = frame.plot.centre();
            let style = TextStyle::new(LABEL_SIZE, GREY, Align::Middle);
            canvas.text_centred("no data", [x, y], style);
            written.push(no_data_area(&frame));
        }
        marks::draw_labels(canvas, &frame, &chart.marks, &layout.occupied, written);
    }

    fn vertical_axes(
        &self,
        canvas: &mut Canvas<'_>,
        frame: &PlotFrame,
        cell: &Rect,
        heights: (f64, f64),
        ticks: &Ticks,
    ) {
        let chart = self.chart;
        let second = chart.y2.as_ref().zip(frame.y2.as_ref());
        // With two axes, the colour shows which curve belongs to which.
        let color = |right| self.axis_color(right).filter(|_| second.is_some());
        let side = |ticks, right| VerticalAxisStyle {
            ticks,
            color: color(right).unwrap_or(INK),
            right,
            heights,
        };
        axes::vertical_axis(canvas, frame, cell, &chart.y, &side(ticks, false));
        let Some((axis, range)) = second else {
            return;
        };
        let ticks = &axes::vertical_ticks(range, frame.plot.height());
        axes::vertical_axis(canvas, frame, cell, axis, &side(ticks, true));
    }

    /// The one colour of all the series on a side.
    fn axis_color(&self, right: bool) -> Option<Rgb> {
        let of_side = self.series().filter(|(s, _)| s.right_axis == right);
        let mut colors = of_side.map(|(_, style)| style.line.color);
        let first = colors.next()?;
        colors.all(|color| color == first).then_some(first)
    }

    fn layout(&self, cell: &Rect, insets: Insets) -> Layout {
        let mut frame = self.frame(cell.inset(insets));
        let styles = self.separated(&frame);
        let mut occupied = self.occupied(&frame);
        let end_labels = end_labels::at_ends(self.chart, &styles, &frame)
            .filter(|end_labels| end_labels::room(end_labels) <= insets.right + 0.5);
        let entries = self.entries(&frame, &styles);
        let mut legend = None;
        if end_labels.is_none() && !entries.is_empty() {
            legend = legend::place_inside(&entries, &frame.plot, &occupied);
            if legend.is_none() {
                // No free area among the data: the legend goes above the plot, which becomes smaller.
                legend = Some(legend::place_above(&entries, &mut frame.plot));
                occupied = self.occupied(&frame);
            }
        }
        Layout {
            frame,
            styles,
            end_labels,
            legend,
            occupied,
        }
    }

    /// By curve, its lines in pixels; none of those with markers.
    fn lines(&self, frame: &PlotFrame) -> Vec<coincidence::Lines> {
        let lines = |series: &Series| {
            if has_markers(series.stroke) {
                Vec::new()
            } else {
                polylines(frame, series)
            }
        };
        self.chart.series.iter().map(lines).collect()
    }

    /// The styles, with dashes in turn for curves that lie on each other.
    fn separated(&self, frame: &PlotFrame) -> Vec<SeriesStyle> {
        let mut styles = self.styles.clone();
        coincidence::separate(&mut styles, &self.lines(frame), &frame.plot);
        styles
    }

    fn has_data(&self, frame: &PlotFrame) -> bool {
        self.chart.series.iter().any(|s| is_visible(frame, s))
    }

    /// The area covered by the data and the reference lines.
    fn occupied(&self, frame: &PlotFrame) -> Occupancy {
        let mut occupied = Occupancy::new(frame.plot);
        for series in &self.chart.series {
            if !has_markers_only(series.stroke) {
                let runs = polylines(frame, series);
                runs.iter().for_each(|run| occupied.line(run));
            }
            visible_points(frame, series).for_each(|p| occupied.point(p));
        }
        marks::mark_occupied(frame, &self.chart.marks, &mut occupied);
        if !self.has_data(frame) {
            occupied.block(&no_data_area(frame));
        }
        occupied
    }

    fn entries(&self, frame: &PlotFrame, styles: &[SeriesStyle]) -> Vec<LegendEntry> {
        let ambiguous = frame.y2.is_some()
            && (self.axis_color(false).is_none() || self.axis_color(true).is_none());
        // Invisible curves are not in the legend.
        let series = self.chart.series.iter().zip(styles);
        let named = series.filter(|(s, _)| !s.name.trim().is_empty() && is_visible(frame, s));
        let entry = |(series, style): (&Series, &SeriesStyle)| {
            let mut name = typeset(series.name.trim());
            if ambiguous {
                name.push_str(if series.right_axis { " →" } else { " ←" });
            }
            let color = style.line.color;
            let patch = lightened(color, 1.0 - FILL_OPACITY);
            let handle = LegendHandle {
                line: (!has_markers_only(series.stroke)).then_some(style.line),
                marker: has_markers(series.stroke).then_some((style.marker, color)),
                patch: (series.stroke == Stroke::Filled).then_some(patch),
            };
            LegendEntry { name, handle }
        };
        named.map(entry).collect()
    }
}

/// The points of a series in pixels; none where a scale cannot show one.
fn points_in_px(frame: &PlotFrame, series: &Series) -> impl Iterator<Item = Option<[f64; 2]>> {
    let points = series.points.iter();
    points.map(|p| frame.point_to_px(*p, series.right_axis))
}

fn polylines(frame: &PlotFrame, series: &Series) -> Vec<Vec<[f64; 2]>> {
    // Half a line beyond the frame, so that a curve along the edge keeps its width.
    let room = frame.plot.grown(0.5 * CURVE_WIDTH);
    clipped(points_in_px(frame, series), &room)
}

fn visible_points(frame: &PlotFrame, series: &Series) -> impl Iterator<Item = [f64; 2]> {
    let room = frame.plot.grown(1.0);
    let points = points_in_px(frame, series).flatten();
    points.filter(move |p| room.contains(*p))
}

/// Whether anything of a series is in the plot.
fn is_visible(frame: &PlotFrame, series: &Series) -> bool {
    visible_points(frame, series).next().is_some() || !polylines(frame, series).is_empty()
}

/// Fills the area between a series and zero, and draws the line of zero.
fn draw_area(canvas: &mut Canvas<'_>, frame: &PlotFrame, series: &Series, style: &SeriesStyle) {
    let zero = frame.y_to_px(0.0, series.right_axis);
    let Some(zero) = zero.filter(|_| series.stroke == Stroke::Filled) else {
        return;
    };
    let places: Vec<_> = points_in_px(frame, series).collect();
    for run in places.split(Option::is_none) {
        let mut area: Vec<[f64; 2]> = run.iter().flatten().copied().collect();
        let (Some(first), Some(last)) = (area.first(), area.last()) else {
            continue;
        };
        let base = [[last[0], zero], [first[0], zero]];
        area.extend(base);
        let area = clipped_area(&area, &frame.plot);
        if area.len() > 2 {
            canvas.polygon(&area, style.line.color, FILL_OPACITY);
        }
        for line in clipped(base.map(Some), &frame.plot) {
            canvas.line(&line, LineStyle::solid(INK, SPINE_WIDTH));
        }
    }
}

fn draw_series(canvas: &mut Canvas<'_>, frame: &PlotFrame, series: &Series, style: &SeriesStyle) {
    if !has_markers_only(series.stroke) {
        for run in polylines(frame, series) {
            canvas.line(&run, style.line);
        }
    }
    let step = match series.stroke {
        Stroke::Points | Stroke::Hollow | Stroke::Crosses => 2.0,
        Stroke::LineAndPoints => MARKER_STEP,
        Stroke::Solid | Stroke::Dashed | Stroke::Filled => return,
    };
    let mut last: Option<[f64; 2]> = None;
    for p in visible_points(frame, series) {
        if last.is_none_or(|l| (p[0] - l[0]).hypot(p[1] - l[1]) >= step) {
            marks::draw_marker(canvas, style.marker, p, style.line.color);
            last = Some(p);
        }
    }
}
