//! Single shapes of a drawing: their points, what they cover, how they are drawn.

use crate::axes::PlotFrame;
use crate::canvas::{Canvas, LineStyle};
use crate::curve::clipped;
use crate::dash::Dash;
use crate::fonts;
use crate::occupancy::Occupancy;
use crate::rect::Rect;
use crate::shape::{Pen, Shape, TextPlacement};
use crate::theme::{INK, Rgb, SPINE_WIDTH, TICK_SIZE, WHITE, lightened, rgb};

/// Bearing on ground: radius of the pin, half width and height of the support, half length of its base.
const PIN_RADIUS: f64 = 9.0;
const SUPPORT: [f64; 2] = [19.0, 30.0];
const BASE_HALF_LENGTH: f64 = 31.0;
/// Hatching: distance and reach of the strokes.
const HATCH_SPACING: f64 = 11.0;
const HATCH_LENGTH: f64 = 11.0;
/// Length and half width of an arrow's head, in widths of its line.
const HEAD: [f64; 2] = [5.0, 2.1];

/// The points of a shape in the drawing's own units.
pub(crate) fn points(shape: &Shape) -> Vec<[f64; 2]> {
    match shape {
        Shape::Polyline { points, .. } => points.clone(),
        Shape::Disc { at, .. } | Shape::GroundPin { at } | Shape::Text { at, .. } => vec![*at],
        Shape::GroundLine { from, to } | Shape::Arrow { from, to, .. } => vec![*from, *to],
    }
}

/// Notes what a shape will cover.
pub(crate) fn mark_occupied(frame: &PlotFrame, shape: &Shape, occupied: &mut Occupancy) {
    let place = |p: &[f64; 2]| frame.point_to_px(*p, false);
    match shape {
        Shape::Polyline {
            points,
            closed,
            pen,
            ..
        } => {
            for run in outline(frame, points, *closed) {
                occupied.line(&run);
                // A thick bar covers more than its middle line.
                let half = 0.5 * pen.width;
                run.iter()
                    .for_each(|p| occupied.block(&Rect::around(*p, half)));
            }
        }
        Shape::GroundLine { from, to } => {
            for run in clipped([place(from), place(to)], &frame.plot) {
                occupied.line(&run);
                for stroke in hatching(&run) {
                    occupied.line(&stroke);
                }
            }
        }
        Shape::Arrow { from, to, pen, .. } => {
            for run in clipped([place(from), place(to)], &frame.plot) {
                occupied.line(&run);
            }
            if let Some((from, to)) = place(from).zip(place(to)) {
                occupied.block(&head_block(from, to, line(pen).width));
            }
        }
        Shape::Disc { at, radius_px, .. } => {
            if let Some(at) = place(at) {
                occupied.block(&Rect::around(at, *radius_px));
            }
        }
        Shape::GroundPin { at } => {
            if let Some([x, y]) = place(at) {
                occupied.block(&Rect {
                    x0: x - BASE_HALF_LENGTH,
                    y0: y - PIN_RADIUS,
                    x1: x + BASE_HALF_LENGTH,
                    y1: y + SUPPORT[1] + HATCH_LENGTH,
                });
            }
        }
        Shape::Text {
            at,
            text,
            placement,
            ..
        } => {
            if let Some(at) = place(at) {
                occupied.block(&text_box(at, text, *placement, 1.0));
            }
        }
    }
}

/// Draws a shape; parts outside the plot are cut off, and points that are not finite are omitted.
//
// Long: a few lines for each kind of shape.
pub(crate) fn draw(canvas: &mut Canvas<'_>, frame: &PlotFrame, shape: &Shape) {
    let plot = frame.plot.grown(1.0);
    let place = |p: &[f64; 2]| frame.point_to_px(*p, false).filter(|p| plot.contains(*p));
    match shape {
        Shape::Polyline {
            points,
            pen,
            closed,
            fill,
            ..
        } => {
            let color = lightened(rgb(pen.color), pen.lightness);
            if let Some(opacity) = fill {
                fill_area(canvas, frame, points, color, *opacity);
            }
            for run in outline(frame, points, *closed) {
                canvas.line(&run, line(pen));
            }
        }
        Shape::Disc {
            at,
            radius_px,
            pen,
            filled,
            ..
        } => {
            let Some(at) = place(at) else { return };
            let color = lightened(rgb(pen.color), pen.lightness);
            canvas.disc(at, radius_px + 0.5 * pen.width, color);
            if !*filled {
                canvas.disc(at, (radius_px - 0.5 * pen.width).max(0.0), WHITE);
            }
        }
        Shape::GroundPin { at } => {
            if let Some(at) = place(at) {
                ground_pin(canvas, at);
            }
        }
        Shape::GroundLine { from, to } => {
            let ends = [from, to].map(|p| frame.point_to_px(*p, false));
            for run in clipped(ends, &frame.plot) {
                ground_line(canvas, &run);
            }
        }
        Shape::Arrow { from, to, pen, .. } => {
            if let Some((from, to)) = place(from).zip(place(to)) {
                arrow(canvas, from, to, pen);
            }
        }
        // Words are placed when everything else is.
        Shape::Text { .. } => {}
    }
}

fn line(pen: &Pen) -> LineStyle {
    let width = if pen.width.is_finite() {
        pen.width.clamp(0.5, 400.0)
    } else {
        1.0
    };
    LineStyle {
        color: lightened(rgb(pen.color), pen.lightness),
        width,
        dash: pen.dashed.then(|| Dash::of_width(width)),
    }
}

fn outline(frame: &PlotFrame, points: &[[f64; 2]], closed: bool) -> Vec<Vec<[f64; 2]>> {
    let back = points.first().filter(|_| closed);
    let all = points.iter().chain(back);
    clipped(all.map(|p| frame.point_to_px(*p, false)), &frame.plot)
}

fn fill_area(
    canvas: &mut Canvas<'_>,
    frame: &PlotFrame,
    points: &[[f64; 2]],
    color: Rgb,
    opacity: f64,
) {
    let inside = points.iter().filter_map(|p| frame.point_to_px(*p, false));
    let area = crate::curve::clipped_area(&inside.collect::<Vec<_>>(), &frame.plot);
    if area.len() < 3 || !opacity.is_finite() || opacity <= 0.0 {
        return;
    }
    canvas.polygon(&area, color, opacity.min(1.0));
}

fn ground_pin(canvas: &mut Canvas<'_>, [x, y]: [f64; 2]) {
    let [half, height] = SUPPORT;
    let triangle = [[x, y], [x + half, y + height], [x - half, y + height]];
    canvas.polygon(&triangle, WHITE, 1.0);
    let [a, b, c] = triangle;
    canvas.line(&[a, b, c, a], LineStyle::solid(INK, SPINE_WIDTH));
    let base = [x - BASE_HALF_LENGTH, x + BASE_HALF_LENGTH].map(|x| [x, y + height]);
    ground_line(canvas, &base);
    canvas.disc([x, y], PIN_RADIUS + 1.3, INK);
    canvas.disc([x, y], PIN_RADIUS - 1.6, WHITE);
}

/// A line hatched on its left in the page, where y grows downwards: on its right for the reader's coordinates.
fn ground_line(canvas: &mut Canvas<'_>, points: &[[f64; 2]]) {
    canvas.line(points, LineStyle::solid(INK, SPINE_WIDTH + 0.6));
    for stroke in hatching(points) {
        canvas.line(&stroke, LineStyle::solid(INK, 0.7 * SPINE_WIDTH));
    }
}

/// Its strokes.
fn hatching(points: &[[f64; 2]]) -> Vec<[[f64; 2]; 2]> {
    let (Some(&from), Some(&to)) = (points.first(), points.last()) else {
        return Vec::new();
    };
    let length = distance(from, to);
    if length < 1.0 {
        return Vec::new();
    }
    let [tx, ty] = unit(from, to);
    let [nx, ny] = [-ty, tx];
    let count = (length / HATCH_SPACING).floor().clamp(0.0, 500.0) as u32;
    let stroke = |i: u32| {
        let s = (f64::from(i) + 0.5) * length / f64::from(count);
        let base = [from[0] + s * tx, from[1] + s * ty];
        let tip = [
            base[0] + HATCH_LENGTH * (nx - 0.75 * tx),
            base[1] + HATCH_LENGTH * (ny - 0.75 * ty),
        ];
        [base, tip]
    };
    (0..count).map(stroke).collect()
}

fn distance(from: [f64; 2], to: [f64; 2]) -> f64 {
    (to[0] - from[0]).hypot(to[1] - from[1])
}

/// The direction from one point to another.
fn unit(from: [f64; 2], to: [f64; 2]) -> [f64; 2] {
    let length = distance(from, to).max(f64::MIN_POSITIVE);
    [0, 1].map(|k| (to[k] - from[k]) / length)
}

/// Length and half width of the head of an arrow of this width.
fn head_of(from: [f64; 2], to: [f64; 2], width: f64) -> [f64; 2] {
    let head = (HEAD[0] * width).max(14.0).min(0.6 * distance(from, to));
    [head, head * HEAD[1] / HEAD[0]]
}

/// What it covers, about.
fn head_block(from: [f64; 2], to: [f64; 2], width: f64) -> Rect {
    let [head, half] = head_of(from, to, width);
    let along = unit(from, to);
    Rect::around([0, 1].map(|k| to[k] - 0.5 * head * along[k]), half)
}

fn arrow(canvas: &mut Canvas<'_>, from: [f64; 2], to: [f64; 2], pen: &Pen) {
    let line = line(pen);
    if distance(from, to) < 1.0 {
        return;
    }
    let [head, half] = head_of(from, to, line.width);
    let [tx, ty] = unit(from, to);
    let neck = [to[0] - head * tx, to[1] - head * ty];
    let end = [neck[0] + 0.2 * head * tx, neck[1] + 0.2 * head * ty];
    canvas.line(&[from, end], line);
    let barbs = [
        [neck[0] - half * ty, neck[1] + half * tx],
        [neck[0] + half * ty, neck[1] - half * tx],
    ];
    canvas.polygon(&[to, barbs[0], barbs[1]], line.color, 1.0);
}

/// Where the words stand: so many gaps from their point.
pub(crate) fn text_box([x, y]: [f64; 2], text: &str, placement: TextPlacement, gaps: f64) -> Rect {
    const GAP: f64 = 15.0;
    let gap = GAP * gaps;
    let (width, height) = (fonts::width(text, TICK_SIZE, false), TICK_SIZE);
    let (left, right, middle) = (x - gap - width, x + gap, x - 0.5 * width);
    let (above, below, level) = (y - gap - height, y + gap, y - 0.5 * height);
    // Corners are nearer than sides, or they would look further away.
    let corner_shift = 0.35 * gap;
    let [x0, y0] = match placement {
        TextPlacement::Centre => [middle, level],
        TextPlacement::Left => [left, level],
        TextPlacement::Right => [right, level],
        TextPlacement::Above => [middle, above],
        TextPlacement::Below => [middle, below],
        TextPlacement::AboveLeft => [left + corner_shift, above + corner_shift],
        TextPlacement::AboveRight => [right - corner_shift, above + corner_shift],
        TextPlacement::BelowLeft => [left + corner_shift, below - corner_shift],
        TextPlacement::BelowRight => [right - corner_shift, below - corner_shift],
    };
    Rect::sized(x0, y0, width, height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::{Paint, Scale};
    use crate::axis_range::AxisRange;

    /// A plot of 200 by 100 pixels whose units are pixels.
    fn occupied_by(shape: &Shape) -> Occupancy {
        let plot = Rect::sized(0.0, 0.0, 200.0, 100.0);
        let frame = PlotFrame {
            plot,
            x: AxisRange::new(Scale::Linear, 0.0, 200.0),
            y: AxisRange::new(Scale::Linear, 0.0, 100.0),
            y2: None,
        };
        let mut occupied = Occupancy::new(plot);
        mark_occupied(&frame, shape, &mut occupied);
        occupied
    }

    /// Words beside a guide or a bearing stand on none of the strokes, and those at the tip of an arrow not on its head.
    #[test]
    fn hatching_and_heads_of_arrows_take_room() {
        let wall = occupied_by(&Shape::GroundLine {
            from: [50.0, 50.0],
            to: [150.0, 50.0],
        });
        // On the page y grows downwards.
        assert!(wall.count(&Rect::sized(60.0, 56.0, 80.0, 3.0)) > 8);
        assert_eq!(wall.count(&Rect::sized(60.0, 35.0, 80.0, 9.0)), 0);
        let arrow = occupied_by(&Shape::Arrow {
            from: [20.0, 50.0],
            to: [120.0, 50.0],
            pen: Pen::new(Paint::Ink, 4.0),
            name: None,
        });
        for y in [43.0, 56.0] {
            assert!(arrow.count(&Rect::sized(104.0, y, 12.0, 1.0)) > 0);
            assert_eq!(arrow.count(&Rect::sized(30.0, y, 40.0, 1.0)), 0);
        }
    }
}
