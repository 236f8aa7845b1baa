//! A scaled drawing in a cell of the page: fitted, with equal axes.

use crate::axes::{self, PlotFrame};
use crate::axis::{Axis, Scale};
use crate::axis_range::AxisRange;
use crate::canvas::{Canvas, LineStyle};
use crate::dash::Dash;
use crate::drawn_words;
use crate::layout_record::LayoutRecord;
use crate::legend::{self, LegendEntry, LegendHandle, PlacedLegend};
use crate::marks::Marker;
use crate::occupancy::Occupancy;
use crate::rect::{Insets, Rect};
use crate::shape::{Drawing, Shape};
use crate::shape_drawing;
use crate::theme::{INK, lightened, rgb};

/// Pixels between the shapes and the frame: the room a bearing and its hatching take.
const PAD: f64 = 54.0;
/// Least and largest height of a plot as a share of its width.
const ASPECT: (f64, f64) = (0.42, 0.95);
/// First estimate of the width that labels need.
const SIDES: f64 = 170.0;

/// The layout of one drawing, or of several that are shown one after another in one cell: only the shapes move.
pub(crate) struct DrawingLayout {
    pub(crate) frame: PlotFrame,
    legend: Option<PlacedLegend>,
    /// Between which heights the plot was before the legend.
    heights: (f64, f64),
}

/// Height of the cell that suits the drawings at this width.
pub(crate) fn height(drawings: &[Drawing], width: f64) -> f64 {
    let plot = (width - SIDES).max(100.0);
    let [[x0, x1], [y0, y1]] = bounds(drawings);
    let wanted = (plot - 2.0 * PAD).max(1.0) * (y1 - y0) / (x1 - x0) + 2.0 * PAD;
    let plot_height = wanted.clamp(ASPECT.0 * plot, ASPECT.1 * plot);
    let Insets { top, bottom, .. } = insets(drawings, &Rect::sized(0.0, 0.0, width, plot_height));
    top + plot_height + bottom
}

/// Widths of the strips that the labels need in a cell of this size.
pub(crate) fn insets(drawings: &[Drawing], cell: &Rect) -> Insets {
    let title = drawings.iter().map(|d| axes::top_room(&d.title, cell));
    // A first guess: ticks depend on the plot, and the plot on their labels.
    let guess = Insets {
        left: 0.7 * SIDES,
        top: title.fold(0.0, f64::max),
        right: axes::right_room(),
        bottom: 0.6 * SIDES,
    };
    let first = labels_room(drawings, cell, guess);
    // In a plot of that size there may be more ticks, with wider labels.
    first.max(labels_room(drawings, cell, first))
}

/// Widths of the strips that the labels need beside a plot that is so far from the sides of the cell.
fn labels_room(drawings: &[Drawing], cell: &Rect, insets: Insets) -> Insets {
    let frame = fitted(bounds(drawings), cell.inset(insets));
    let x_ticks = axes::horizontal_ticks(&frame.x, frame.plot.width());
    let y_ticks = axes::vertical_ticks(&frame.y, frame.plot.height());
    let needed = |drawing: &Drawing| {
        if drawing.without_axes {
            Insets {
                left: 0.0,
                bottom: 0.0,
                ..insets
            }
        } else {
            Insets {
                left: axes::side_room(&drawing.y, &y_ticks, frame.plot.height()),
                bottom: axes::bottom_room(Some(&drawing.x), &x_ticks, cell),
                ..insets
            }
        }
    };
    let all = drawings.iter().map(needed).reduce(Insets::max);
    all.unwrap_or(insets)
}

impl DrawingLayout {
    /// One frame and one legend for all.
    pub(crate) fn new(drawings: &[Drawing], cell: &Rect, insets: Insets) -> Self {
        let mut frame = fitted(bounds(drawings), cell.inset(insets));
        let heights = (frame.plot.y0, frame.plot.y1);
        let entries = entries(drawings);
        let legend = (!entries.is_empty()).then(|| arrange_legend(drawings, &entries, &mut frame));
        Self {
            frame,
            legend,
            heights,
        }
    }

    /// Height that the legend took from the plot.
    pub(crate) fn legend_above(&self) -> f64 {
        self.legend.as_ref().map_or(0.0, PlacedLegend::height_above)
    }

    /// Draws one of the drawings.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>, drawing: &Drawing, cell: &Rect) {
        let frame = &self.frame;
        let x = axes::horizontal_ticks(&frame.x, frame.plot.width());
        let y = axes::vertical_ticks(&frame.y, frame.plot.height());
        if !drawing.without_axes {
            axes::grid_lines(canvas, frame, &x, &y);
        }
        canvas.note(LayoutRecord::begin_plot);
        for shape in &drawing.shapes {
            canvas.note(|record| record.begin_curve(shape.name()));
            shape_drawing::draw(canvas, frame, shape);
        }
        canvas.note(|record| record.begin_curve(None));
        let legend = self.legend.as_ref().map(|legend| legend.area);
        drawn_words::draw(canvas, frame, &drawing.shapes, legend);
        if !drawing.without_axes {
            axes::horizontal_axis(canvas, frame, cell, Some(&drawing.x), &x);
            let style = axes::VerticalAxisStyle {
                ticks: &y,
                color: INK,
                right: false,
                heights: self.heights,
            };
            axes::vertical_axis(canvas, frame, cell, &drawing.y, &style);
        }
        axes::title(canvas, &drawing.title, &frame.plot, cell);
        if let Some(legend) = &self.legend {
            legend.draw(canvas);
        }
    }
}

/// The legend and its area; the plot becomes smaller if no area in it is free.
fn arrange_legend(
    drawings: &[Drawing],
    entries: &[LegendEntry],
    frame: &mut PlotFrame,
) -> PlacedLegend {
    let mut occupied = Occupancy::new(frame.plot);
    for shape in drawings.iter().flat_map(|d| &d.shapes) {
        shape_drawing::mark_occupied(frame, shape, &mut occupied);
    }
    if let Some(legend) = legend::place_inside(entries, &frame.plot, &occupied) {
        return legend;
    }
    let mut plot = frame.plot;
    let legend = legend::place_above(entries, &mut plot);
    *frame = fitted(bounds(drawings), plot);
    legend
}

/// Extent of the shapes and of the axes' own ranges: never empty.
fn bounds(drawings: &[Drawing]) -> [[f64; 2]; 2] {
    let points = || {
        drawings
            .iter()
            .flat_map(|d| &d.shapes)
            .flat_map(shape_drawing::points)
            .filter(|p| p.iter().all(|v| v.is_finite()))
    };
    let side = |axis: fn(&Drawing) -> &Axis, i: usize| {
        let given = drawings.iter().filter_map(|d| axis(d).range).flatten();
        let all = points()
            .map(|p| p[i])
            .chain(given)
            .filter(|v| v.abs() < 1e150);
        let AxisRange { min, max, .. } = AxisRange::of(&Axis::default(), all, 0.0);
        [min, max]
    };
    [side(|d| &d.x, 0), side(|d| &d.y, 1)]
}

/// The frame in which the shapes keep their proportions and fill the plot.
fn fitted([[x0, x1], [y0, y1]]: [[f64; 2]; 2], plot: Rect) -> PlotFrame {
    let pad = PAD.min(0.2 * plot.width()).min(0.2 * plot.height());
    // Units in a pixel: the larger of the two fits both ways.
    let unit =
        ((x1 - x0) / (plot.width() - 2.0 * pad)).max((y1 - y0) / (plot.height() - 2.0 * pad));
    let range = |low: f64, high: f64, pixels: f64| {
        let (middle, half) = (0.5 * (low + high), 0.5 * pixels * unit);
        AxisRange::new(Scale::Linear, middle - half, middle + half)
    };
    PlotFrame {
        plot,
        x: range(x0, x1, plot.width()),
        y: range(y0, y1, plot.height()),
        y2: None,
    }
}

fn entries(drawings: &[Drawing]) -> Vec<LegendEntry> {
    let mut entries: Vec<LegendEntry> = Vec::new();
    for shape in drawings.iter().flat_map(|d| &d.shapes) {
        let (Shape::Polyline { pen, .. } | Shape::Disc { pen, .. } | Shape::Arrow { pen, .. }) =
            shape
        else {
            continue;
        };
        let name = shape.name().unwrap_or_default();
        if name.trim().is_empty() || entries.iter().any(|entry| entry.name == name) {
            continue;
        }
        let color = lightened(rgb(pen.color), pen.lightness);
        let line = LineStyle {
            color,
            width: pen.width.clamp(1.0, 12.0),
            dash: pen.dashed.then(|| Dash::of_width(pen.width)),
        };
        let is_disc = matches!(shape, Shape::Disc { .. });
        let fill = match shape {
            Shape::Polyline { fill, .. } => *fill,
            _ => None,
        };
        let handle = LegendHandle {
            line: (!is_disc).then_some(line),
            marker: is_disc.then_some((Marker::filled(0), color)),
            patch: fill.map(|opacity| lightened(color, 1.0 - opacity)),
        };
        let name = name.to_owned();
        entries.push(LegendEntry { name, handle });
    }
    entries
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Paint;
    use crate::shape::Pen;

    fn square(side: f64) -> Drawing {
        let points = vec![
            [0.0, 0.0],
            [side, 0.0],
            [side, side],
            [0.0, side],
            [f64::NAN, 3.0],
        ];
        Drawing {
            shapes: vec![Shape::line(points, Pen::new(Paint::Ink, 4.0))],
            ..Drawing::default()
        }
    }

    #[test]
    fn a_square_stays_square_and_inside() {
        for plot in [
            Rect::sized(0.0, 0.0, 800.0, 400.0),
            Rect::sized(0.0, 0.0, 300.0, 900.0),
        ] {
            for side in [1e-6, 0.3, 1e6] {
                let frame = fitted(bounds(&[square(side)]), plot);
                let [a, b] = [
                    frame.point_to_px([0.0, 0.0], false).unwrap(),
                    frame.point_to_px([side, side], false).unwrap(),
                ];
                assert!(((b[0] - a[0]) / (a[1] - b[1]) - 1.0).abs() < 1e-9);
                assert!(plot.contains(a) && plot.contains(b));
            }
        }
    }

    #[test]
    fn empty_and_degenerate_drawings_have_a_frame() {
        let dot = Drawing {
            shapes: vec![Shape::pin([5.0, 5.0], Paint::Ink, 0.0)],
            ..Drawing::default()
        };
        for drawing in [Drawing::default(), dot] {
            let frame = fitted(
                bounds(std::slice::from_ref(&drawing)),
                Rect::sized(0.0, 0.0, 500.0, 300.0),
            );
            assert!(frame.x.min < frame.x.max && frame.y.min < frame.y.max);
            assert!(height(&[drawing], 900.0) > 100.0);
        }
    }

    #[test]
    fn ghosts_of_one_name_share_an_entry() {
        let link = |lightness| {
            Shape::line(
                vec![[0.0, 0.0], [1.0, 1.0]],
                Pen::new(Paint::Ink, 8.0).lightness(lightness),
            )
        };
        let shapes = vec![
            link(0.0).named("crank"),
            link(0.7).named("crank"),
            link(0.0),
        ];
        assert_eq!(
            entries(&[Drawing {
                shapes,
                ..Drawing::default()
            }])
            .len(),
            1
        );
    }
}
