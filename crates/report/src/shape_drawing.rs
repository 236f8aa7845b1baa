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
        Shape::GroundLine { from, to } | Shape::Arrow { from, to, .. } => {
            for run in clipped([place(from), place(to)], &frame.plot) {
                occupied.line(&run);
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

/// Draws a shape; parts outside the plot are cut off, and what is not finite is left out.
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
    let width = match pen.width.is_finite() {
        true => pen.width.clamp(0.5, 400.0),
        false => 1.0,
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
    let (Some([ax, ay]), Some([bx, by])) = (points.first().copied(), points.last().copied()) else {
        return;
    };
    let length = (bx - ax).hypot(by - ay);
    if length < 1.0 {
        return;
    }
    let [tx, ty] = [(bx - ax) / length, (by - ay) / length];
    let [nx, ny] = [-ty, tx];
    let count = (length / HATCH_SPACING).floor().clamp(0.0, 500.0) as u32;
    for i in 0..count {
        let s = (f64::from(i) + 0.5) * length / f64::from(count);
        let base = [ax + s * tx, ay + s * ty];
        let tip = [
            base[0] + HATCH_LENGTH * (nx - 0.75 * tx),
            base[1] + HATCH_LENGTH * (ny - 0.75 * ty),
        ];
        canvas.line(&[base, tip], LineStyle::solid(INK, 0.7 * SPINE_WIDTH));
    }
}

fn arrow(canvas: &mut Canvas<'_>, from: [f64; 2], to: [f64; 2], pen: &Pen) {
    let line = line(pen);
    let length = (to[0] - from[0]).hypot(to[1] - from[1]);
    if length < 1.0 {
        return;
    }
    let head = (HEAD[0] * line.width).max(14.0).min(0.6 * length);
    let half = head * HEAD[1] / HEAD[0];
    let [tx, ty] = [(to[0] - from[0]) / length, (to[1] - from[1]) / length];
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
