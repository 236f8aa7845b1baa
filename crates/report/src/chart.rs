//! A chart in a cell of the page.

use crate::axes::{self, Frame, Side};
use crate::canvas::{Align, Canvas, Drawn, Line, Type};
use crate::curve::{clipped, clipped_area};
use crate::extent::{Extent, marked};
use crate::figure::{Axis, Chart, Paint, Series, Stroke};
use crate::labels::{self, EndLabel};
use crate::legend::{self, Entry, Sample};
use crate::marks;
use crate::occupancy::Occupancy;
use crate::rect::{Insets, Rect};
use crate::span::Span;
use crate::theme::{CURVE, GREY, INK, LABEL, Rgb, SPINE, automatic, lightened, rgb};
use crate::ticks::Ticks;

/// Height of a chart's cell as a share of its width.
pub(crate) const HEIGHT: f64 = 0.68;
/// Markers of a line closer together than this say nothing more.
const MARKER_STEP: f64 = 15.0;
/// Opacity of an area.
const FILL: f64 = 0.22;

/// How a series looks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Look {
    pub(crate) line: Line,
    marker: marks::Marker,
}

fn look(series: &Series, index: usize) -> Look {
    let paint = series.color.unwrap_or(automatic(index));
    let shape = match paint {
        _ if series.stroke == Stroke::Crosses => marks::CROSS,
        Paint::Palette(i) => i,
        Paint::Ink => marks::CROSS,
        Paint::Grey => index,
    };
    let hollow = series.stroke == Stroke::Hollow;
    let marker = marks::Marker { shape, hollow };
    Look {
        line: Line {
            color: rgb(paint),
            width: CURVE,
            dashed: series.stroke == Stroke::Dashed,
        },
        marker,
    }
}

/// Whether the points of a series are shown alone.
fn unjoined(series: &Series) -> bool {
    matches!(
        series.stroke,
        Stroke::Points | Stroke::Hollow | Stroke::Crosses
    )
}

/// A chart with its spans found.
pub(crate) struct Sheet<'a> {
    chart: &'a Chart,
    looks: Vec<Look>,
    x: Span,
    y: Span,
    y2: Option<Span>,
    /// The horizontal axis in words; a chart in a stack leaves them to the lowest.
    x_axis: Option<&'a Axis>,
}

/// Where things go in the cell.
struct Layout {
    frame: Frame,
    ends: Option<Vec<EndLabel>>,
    legend: Option<(legend::Legend, Rect, bool)>,
    taken: Occupancy,
}

/// Room for the words "no data".
fn no_data(frame: &Frame) -> Rect {
    let [x, y] = frame.plot.centre();
    Rect::sized(x, y, 0.0, 0.0).grown(2.5 * LABEL)
}

impl<'a> Sheet<'a> {
    pub(crate) fn new(chart: &'a Chart) -> Self {
        Self::with(chart, Extent::of(chart), Some(&chart.x))
    }

    /// Charts over the horizontal axis of the first.
    pub(crate) fn stacked(charts: &'a [Chart]) -> Vec<Self> {
        let Some(first) = charts.first() else {
            return Vec::new();
        };
        let x = Extent::across(&first.x, charts);
        let lowest = charts.len() - 1;
        let sheet = |(place, chart)| {
            let axis = (place == lowest).then_some(&first.x);
            Self::with(chart, Extent::over(x, chart), axis)
        };
        charts.iter().enumerate().map(sheet).collect()
    }

    fn with(chart: &'a Chart, Extent { x, y, y2 }: Extent, x_axis: Option<&'a Axis>) -> Self {
        let looks = chart.series.iter().enumerate();
        Self {
            chart,
            looks: looks.map(|(i, series)| look(series, i)).collect(),
            x,
            y,
            y2,
            x_axis,
        }
    }

    /// Whether a place is within the horizontal span.
    #[cfg(test)]
    pub(crate) fn shows(&self, x: f64) -> bool {
        (self.x.low..=self.x.high).contains(&x)
    }

    fn frame(&self, plot: Rect) -> Frame {
        Frame {
            plot,
            x: self.x,
            y: self.y,
            y2: self.y2,
        }
    }

    /// Strips the labels need in a cell of this size.
    pub(crate) fn insets(&self, cell: &Rect) -> Insets {
        let chart = self.chart;
        // A first guess at the sides: ticks depend on the plot, and the plot on their labels.
        let sides = 0.13 * cell.width();
        let x_ticks = axes::ticks_across(&self.x, cell.width() - sides);
        let mut insets = Insets {
            left: sides,
            top: axes::top_room(&chart.title, cell),
            right: axes::right_room(),
            bottom: axes::bottom_room(self.x_axis, &x_ticks, cell),
        };
        let height = cell.inside(insets).height();
        let side = |axis, span| axes::side_room(axis, &axes::ticks_up(span, height), height);
        insets.left = side(&chart.y, &self.y);
        if let (Some(axis), Some(span)) = (&chart.y2, &self.y2) {
            insets.right = side(axis, span);
        }
        if let Some(ends) = labels::at_ends(chart, &self.looks, &self.frame(cell.inside(insets))) {
            insets.right = insets.right.max(labels::room(&ends));
        }
        insets
    }

    /// Draws the chart.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>, cell: &Rect, insets: Insets) -> Drawn {
        let chart = self.chart;
        let Layout {
            frame,
            ends,
            legend,
            taken,
        } = self.layout(cell, insets);
        let x_ticks = axes::ticks_across(&self.x, frame.plot.width());
        let y_ticks = axes::ticks_up(&self.y, frame.plot.height());
        marks::bands(canvas, &frame, &chart.marks)?;
        axes::grid(canvas, &frame, &x_ticks, &y_ticks)?;
        marks::lines(canvas, &frame, &chart.marks)?;
        // Under the curves: a marker at the very edge is a datum, the spine is not.
        axes::bottom(canvas, &frame, cell, self.x_axis, &x_ticks)?;
        let Rect { y0, y1, .. } = cell.inside(insets);
        self.sides(canvas, &frame, cell, (y0, y1), &y_ticks)?;
        for (series, look) in chart.series.iter().zip(&self.looks) {
            self.area(canvas, &frame, series, look)?;
        }
        for (series, look) in chart.series.iter().zip(&self.looks) {
            self.series(canvas, &frame, series, look)?;
        }
        marks::rings(canvas, &frame, &chart.marks)?;
        axes::title(canvas, &chart.title, &frame.plot, cell)?;
        if let Some(ends) = &ends {
            labels::draw(canvas, ends, &frame.plot)?;
        }
        if let Some((legend, place, inside)) = &legend {
            legend.draw(canvas, place, *inside)?;
        }
        let mut written: Vec<Rect> = legend.map(|(_, place, _)| place).into_iter().collect();
        if !self.has_data(&frame) {
            let [x, y] = frame.plot.centre();
            let look = Type::new(LABEL, GREY, Align::Middle);
            canvas.text_beside("no data", [x, y], look)?;
            written.push(no_data(&frame));
        }
        marks::words(canvas, &frame, &chart.marks, &taken, written)
    }

    fn sides(
        &self,
        canvas: &mut Canvas<'_>,
        frame: &Frame,
        cell: &Rect,
        heights: (f64, f64),
        ticks: &Ticks,
    ) -> Drawn {
        let chart = self.chart;
        let second = chart.y2.as_ref().zip(self.y2.as_ref());
        // With two axes, colour says which curve belongs to which.
        let side = |ticks, right| Side {
            ticks,
            color: self
                .axis_color(right)
                .filter(|_| second.is_some())
                .unwrap_or(INK),
            right,
            heights,
        };
        axes::side(canvas, frame, cell, &chart.y, &side(ticks, false))?;
        let Some((axis, span)) = second else {
            return Ok(());
        };
        let ticks = &axes::ticks_up(span, frame.plot.height());
        axes::side(canvas, frame, cell, axis, &side(ticks, true))
    }

    /// The one colour of all the series on a side.
    fn axis_color(&self, right: bool) -> Option<Rgb> {
        let mut colors = self
            .chart
            .series
            .iter()
            .zip(&self.looks)
            .filter(|(s, _)| s.right_axis == right)
            .map(|(_, l)| l.line.color);
        let first = colors.next()?;
        colors.all(|color| color == first).then_some(first)
    }

    fn layout(&self, cell: &Rect, insets: Insets) -> Layout {
        let mut frame = self.frame(cell.inside(insets));
        let mut taken = self.taken(&frame);
        let ends = labels::at_ends(self.chart, &self.looks, &frame)
            .filter(|ends| labels::room(ends) <= insets.right + 0.5);
        let entries = self.entries(&frame);
        if ends.is_some() || entries.is_empty() {
            return Layout {
                frame,
                ends,
                legend: None,
                taken,
            };
        }
        if let Some((legend, place)) = legend::inside(&entries, &frame.plot, &taken) {
            return Layout {
                frame,
                ends,
                legend: Some((legend, place, true)),
                taken,
            };
        }
        // No free place among the data: above them, then, and the plot gives way.
        let (legend, place) = legend::above(&entries, &mut frame.plot);
        taken = self.taken(&frame);
        Layout {
            frame,
            ends,
            legend: Some((legend, place, false)),
            taken,
        }
    }

    fn runs(&self, frame: &Frame, series: &Series) -> Vec<Vec<[f64; 2]>> {
        // Half a line beyond the frame, so that a curve along the edge keeps its width.
        let room = frame.plot.grown(0.5 * CURVE);
        clipped(
            series
                .points
                .iter()
                .map(|p| frame.point(*p, series.right_axis)),
            &room,
        )
    }

    fn visible(&self, frame: &Frame, series: &Series) -> Vec<[f64; 2]> {
        let place = |p: &[f64; 2]| {
            frame
                .point(*p, series.right_axis)
                .filter(|p| frame.plot.grown(1.0).contains(*p))
        };
        series.points.iter().filter_map(place).collect()
    }

    /// Fills the area between a series and zero, and draws the line of zero.
    fn area(&self, canvas: &mut Canvas<'_>, frame: &Frame, series: &Series, look: &Look) -> Drawn {
        let zero = frame.up(0.0, series.right_axis);
        let Some(zero) = zero.filter(|_| series.stroke == Stroke::Filled) else {
            return Ok(());
        };
        let places: Vec<Option<[f64; 2]>> = series
            .points
            .iter()
            .map(|p| frame.point(*p, series.right_axis))
            .collect();
        for run in places.split(Option::is_none) {
            let mut area: Vec<[f64; 2]> = run.iter().flatten().copied().collect();
            let (Some(first), Some(last)) = (area.first(), area.last()) else {
                continue;
            };
            let base = [[last[0], zero], [first[0], zero]];
            area.extend(base);
            let area = clipped_area(&area, &frame.plot);
            if area.len() > 2 {
                canvas.polygon(&area, look.line.color, FILL)?;
            }
            for line in clipped(base.map(Some), &frame.plot) {
                canvas.line(&line, Line::solid(INK, SPINE))?;
            }
        }
        Ok(())
    }

    fn has_data(&self, frame: &Frame) -> bool {
        self.chart
            .series
            .iter()
            .any(|s| !self.visible(frame, s).is_empty() || !self.runs(frame, s).is_empty())
    }

    /// What the data and the reference lines cover.
    fn taken(&self, frame: &Frame) -> Occupancy {
        let mut taken = Occupancy::new(frame.plot);
        for series in &self.chart.series {
            if !unjoined(series) {
                self.runs(frame, series)
                    .iter()
                    .for_each(|run| taken.line(run));
            }
            self.visible(frame, series)
                .into_iter()
                .for_each(|p| taken.point(p));
        }
        marks::note(frame, &self.chart.marks, &mut taken);
        if !self.has_data(frame) {
            taken.block(&no_data(frame));
        }
        taken
    }

    fn entries(&self, frame: &Frame) -> Vec<Entry> {
        let ambiguous = self.y2.is_some()
            && (self.axis_color(false).is_none() || self.axis_color(true).is_none());
        let named = self
            .chart
            .series
            .iter()
            .zip(&self.looks)
            .filter(|(s, _)| !s.name.trim().is_empty());
        let entry = |(series, look): (&Series, &Look)| {
            let mut name = series.name.trim().to_owned();
            if ambiguous {
                name.push_str(if series.right_axis { " →" } else { " ←" });
            }
            if self.visible(frame, series).is_empty() && self.runs(frame, series).is_empty() {
                name.push_str(" (no points)");
            }
            let line = (!unjoined(series)).then_some(look.line);
            let marker = marked(series.stroke).then_some((look.marker, look.line.color));
            Entry {
                name,
                sample: Sample {
                    line,
                    marker,
                    patch: (series.stroke == Stroke::Filled)
                        .then(|| lightened(look.line.color, 1.0 - FILL)),
                },
            }
        };
        named.map(entry).collect()
    }

    fn series(
        &self,
        canvas: &mut Canvas<'_>,
        frame: &Frame,
        series: &Series,
        look: &Look,
    ) -> Drawn {
        if !unjoined(series) {
            for run in self.runs(frame, series) {
                canvas.line(&run, look.line)?;
            }
        }
        let step = match series.stroke {
            Stroke::Points | Stroke::Hollow | Stroke::Crosses => 2.0,
            Stroke::LineAndPoints => MARKER_STEP,
            Stroke::Solid | Stroke::Dashed | Stroke::Filled => return Ok(()),
        };
        let mut last: Option<[f64; 2]> = None;
        for p in self.visible(frame, series) {
            if last.is_none_or(|l| (p[0] - l[0]).hypot(p[1] - l[1]) >= step) {
                marks::marker(canvas, look.marker, p, look.line.color)?;
                last = Some(p);
            }
        }
        Ok(())
    }
}
