//! The words of a drawing: each stands near its point, off the shapes and off other words.

use crate::axes::PlotFrame;
use crate::canvas::{Align, Canvas, TextStyle};
use crate::marks::leader;
use crate::occupancy::Occupancy;
use crate::rect::Rect;
use crate::shape::{Shape, TextPlacement};
use crate::shape_drawing::{mark_occupied, text_box};
use crate::theme::{TICK_SIZE, rgb};

/// Distances that are tried, in gaps.
const DISTANCES: [f64; 8] = [1.0, 1.5, 2.2, 3.0, 4.5, 6.5, 9.0, 13.0];
/// Placements that are tried after the wanted one.
const PLACEMENTS: [TextPlacement; 8] = [
    TextPlacement::AboveRight,
    TextPlacement::AboveLeft,
    TextPlacement::BelowRight,
    TextPlacement::BelowLeft,
    TextPlacement::Right,
    TextPlacement::Left,
    TextPlacement::Above,
    TextPlacement::Below,
];
/// Shapes lighter than this are ghosts, which words may cover if they must.
const GHOST: f64 = 0.3;
/// What a covered cell of a shape and of a ghost costs, and a gap more of distance.
const SHAPE_COST: f64 = 4.0;
const GHOST_COST: f64 = 1.0;
const DISTANCE_COST: f64 = 12.0;
/// Between words.
const CLEARANCE: f64 = 4.0;

/// Draws the words among some shapes, whose other members have been drawn.
pub(crate) fn draw(
    canvas: &mut Canvas<'_>,
    frame: &PlotFrame,
    shapes: &[Shape],
    legend: Option<Rect>,
) {
    let mut solid = Occupancy::new(frame.plot);
    let mut ghosts = solid.clone();
    for shape in shapes.iter().filter(|s| !matches!(s, Shape::Text { .. })) {
        let occupied = if is_ghost(shape) {
            &mut ghosts
        } else {
            &mut solid
        };
        mark_occupied(frame, shape, occupied);
    }
    let mut written: Vec<Rect> = legend.into_iter().collect();
    let cost = |area: &Rect| {
        let area = area.grown(-2.0);
        SHAPE_COST * solid.count(&area) as f64 + GHOST_COST * ghosts.count(&area) as f64
    };
    for shape in shapes {
        let Shape::Text {
            at,
            text,
            placement,
            color,
        } = shape
        else {
            continue;
        };
        let place = frame.point_to_px(*at, false);
        let Some(at) = place.filter(|p| frame.plot.grown(1.0).contains(*p)) else {
            continue;
        };
        let is_free = |area: &Rect| {
            let area = area.grown(CLEARANCE);
            frame.plot.contains_rect(&area) && !written.iter().any(|other| other.intersects(&area))
        };
        let candidates = candidates(at, text, *placement).into_iter();
        let best = candidates
            .filter(|(_, area)| is_free(area))
            .map(|(effort, area)| (effort + cost(&area), area))
            .min_by(|a, b| a.0.total_cmp(&b.0));
        let Some((_, area)) = best else {
            canvas.note(|record| record.left_out(text));
            continue;
        };
        leader(canvas, at, &area, 0.5 * TICK_SIZE);
        let style = TextStyle::new(TICK_SIZE, rgb(*color), Align::Start);
        canvas.text_with_halo(text, [area.x0, area.centre()[1]], style);
        written.push(area);
    }
}

fn is_ghost(shape: &Shape) -> bool {
    match shape {
        Shape::Polyline { pen, .. } | Shape::Disc { pen, .. } | Shape::Arrow { pen, .. } => {
            pen.lightness > GHOST
        }
        Shape::GroundPin { .. } | Shape::GroundLine { .. } | Shape::Text { .. } => false,
    }
}

/// Places with what they cost, the wanted one first.
fn candidates(at: [f64; 2], text: &str, wanted: TextPlacement) -> Vec<(f64, Rect)> {
    let others = PLACEMENTS.into_iter().filter(|p| *p != wanted);
    let placements: Vec<TextPlacement> = std::iter::once(wanted).chain(others).collect();
    let around = |gaps: f64| {
        let place = |(k, placement): (usize, &TextPlacement)| {
            let effort = DISTANCE_COST * (gaps - 1.0) + 0.5 * k as f64;
            (effort, text_box(at, text, *placement, gaps))
        };
        placements.iter().enumerate().map(place).collect::<Vec<_>>()
    };
    DISTANCES.into_iter().flat_map(around).collect()
}
