//! Markers, and the reference lines, bands and points of a chart with their words.

use crate::axes::PlotFrame;
use crate::canvas::{Align, Canvas, LineStyle, TextStyle};
use crate::curve::clipped;
use crate::dash::Dash;
use crate::figure::Mark;
use crate::fonts;
use crate::occupancy::Occupancy;
use crate::rect::Rect;
use crate::theme::{BAND, GREY, INK, MARK_WIDTH, MARKER_RADIUS, Rgb, TICK_SIZE, WHITE};
use crate::typeset::typeset;

/// The marker of series in ink, which differs from those of all curves.
pub(crate) const CROSS: usize = usize::MAX;

/// A marker: its shape, and how it is filled.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Marker {
    pub(crate) shape: usize,
    pub(crate) hollow: bool,
}

impl Marker {
    /// A full one.
    pub(crate) fn filled(shape: usize) -> Self {
        let hollow = false;
        Self { shape, hollow }
    }
}

/// The white inside of a hollow marker, as a part of its size.
const HOLLOW_SHARE: f64 = 0.55;

/// Draws the marker of a series; series differ in shape as well as in colour.
pub(crate) fn draw_marker(
    canvas: &mut Canvas<'_>,
    Marker { shape, hollow }: Marker,
    at: [f64; 2],
    color: Rgb,
) {
    filled_marker(canvas, shape, at, MARKER_RADIUS, color);
    if hollow && shape != CROSS {
        filled_marker(canvas, shape, at, HOLLOW_SHARE * MARKER_RADIUS, WHITE);
    }
}

fn filled_marker(canvas: &mut Canvas<'_>, shape: usize, [x, y]: [f64; 2], r: f64, color: Rgb) {
    if shape == CROSS {
        let pen = LineStyle::solid(color, 0.7 * r);
        canvas.line(&[[x - r, y - r], [x + r, y + r]], pen);
        return canvas.line(&[[x - r, y + r], [x + r, y - r]], pen);
    }
    match shape % 4 {
        0 => canvas.disc([x, y], r, color),
        1 => canvas.rect(&Rect::around([x, y], r).grown(-0.1 * r), color),
        2 => {
            let (half, base) = (1.15 * r, y + 0.8 * r);
            let triangle = [[x, y - 1.25 * r], [x + half, base], [x - half, base]];
            canvas.polygon(&triangle, color, 1.0);
        }
        _ => {
            let d = 1.3 * r;
            let diamond = [[x, y - d], [x + d, y], [x, y + d], [x - d, y]];
            canvas.polygon(&diamond, color, 1.0);
        }
    }
}

/// Fills the bands, which lie under the grid.
pub(crate) fn bands(canvas: &mut Canvas<'_>, frame: &PlotFrame, marks: &[Mark]) {
    for mark in marks {
        if let Mark::Band { from, to, .. } = mark
            && let Some(band) = band(frame, *from, *to)
        {
            canvas.rect(&band, BAND);
        }
    }
}

fn band(frame: &PlotFrame, from: f64, to: f64) -> Option<Rect> {
    let (a, b) = (frame.x_to_px(from.min(to))?, frame.x_to_px(from.max(to))?);
    let band = Rect {
        x0: a.max(frame.plot.x0),
        x1: b.min(frame.plot.x1),
        ..frame.plot
    };
    (band.width() > 0.0).then_some(band)
}

/// Notes what the lines and rings of the marks will cover.
pub(crate) fn mark_occupied(frame: &PlotFrame, marks: &[Mark], occupied: &mut Occupancy) {
    for mark in marks {
        path(frame, mark).iter().for_each(|run| occupied.line(run));
        if let Some([x, y]) = ring(frame, mark) {
            occupied.block(&Rect::around([x, y], MARKER_RADIUS + 4.0));
        }
    }
}

/// Draws the lines of the marks, which lie under the curves.
pub(crate) fn lines(canvas: &mut Canvas<'_>, frame: &PlotFrame, marks: &[Mark]) {
    let line = LineStyle {
        color: GREY,
        width: MARK_WIDTH,
        dash: Some(Dash::of_width(MARK_WIDTH)),
    };
    for run in marks.iter().flat_map(|mark| path(frame, mark)) {
        canvas.line(&run, line);
    }
}

fn ring(frame: &PlotFrame, mark: &Mark) -> Option<[f64; 2]> {
    let Mark::Point { at, .. } = mark else {
        return None;
    };
    let at = frame.point_to_px(*at, false);
    at.filter(|p| frame.plot.contains(*p))
}

/// Draws the ringed points, which lie over the curves.
pub(crate) fn rings(canvas: &mut Canvas<'_>, frame: &PlotFrame, marks: &[Mark]) {
    for mark in marks {
        if let Some(centre) = ring(frame, mark) {
            canvas.disc(centre, MARKER_RADIUS + 3.5, INK);
            canvas.disc(centre, MARKER_RADIUS, WHITE);
        }
    }
}

/// The line of a mark inside the plot.
fn path(frame: &PlotFrame, mark: &Mark) -> Vec<Vec<[f64; 2]>> {
    let Rect { x0, y0, x1, y1 } = frame.plot;
    let line = match mark {
        Mark::Vertical { at, .. } => {
            let x = frame.x_to_px(*at);
            x.map(|x| vec![Some([x, y0]), Some([x, y1])])
        }
        Mark::Horizontal { at, .. } => {
            let y = frame.y_to_px(*at, false);
            y.map(|y| vec![Some([x0, y]), Some([x1, y])])
        }
        Mark::Slope { order, through, .. } => {
            // Between other axes than logarithmic ones a power law is a curve, so it is followed in steps.
            let at = |i: i32| {
                let x = frame.x.value(f64::from(i) / 200.0);
                frame.point_to_px([x, through[1] * (x / through[0]).powf(*order)], false)
            };
            Some((0..=200).map(at).collect())
        }
        Mark::Band { .. } | Mark::Point { .. } | Mark::Text { .. } => None,
    };
    clipped(line.unwrap_or_default(), &frame.plot)
}

/// Writes the labels of the marks where they hide the least of the data, and never on other
/// text; labels without such a position are omitted.
pub(crate) fn draw_labels(
    canvas: &mut Canvas<'_>,
    frame: &PlotFrame,
    marks: &[Mark],
    occupied: &Occupancy,
    mut written: Vec<Rect>,
) {
    for mark in marks {
        let (Mark::Vertical { label, .. }
        | Mark::Horizontal { label, .. }
        | Mark::Band { label, .. }
        | Mark::Slope { label, .. }
        | Mark::Point { label, .. }
        | Mark::Text { label, .. }) = mark;
        let typeset_label = typeset(label.trim());
        let label = typeset_label.as_str();
        if label.is_empty() {
            continue;
        }
        let size = [fonts::width(label, TICK_SIZE, false), TICK_SIZE];
        let free = |area: &Rect| {
            let leads_through = |other: &Rect| leader_meets(frame, mark, area, other);
            let area = area.grown(5.0);
            let is_met = |other: &Rect| other.intersects(&area) || leads_through(other);
            frame.plot.contains_rect(&area) && !written.iter().any(is_met)
        };
        // The first of the best: the positions are given in the order of preference.
        let hidden = |area: &Rect| occupied.count(&area.grown(3.0));
        let candidates = label_candidates(frame, mark, size).into_iter();
        let best = candidates.filter(free).min_by_key(hidden);
        // The name of a point that is one of many may be missing; that of a line that is drawn for its name may not.
        let is_optional = matches!(mark, Mark::Text { .. });
        let Some(area) = best.filter(|area| !is_optional || hidden(area) == 0) else {
            if !is_optional && has_place(frame, mark) {
                canvas.note(|record| record.left_out(label));
            }
            continue;
        };
        if let Mark::Point { at, .. } | Mark::Text { at, .. } = mark
            && let Some(at) = frame.point_to_px(*at, false)
        {
            leader(canvas, at, &area, MARKER_RADIUS + 2.0);
        }
        let middle = [area.x0, area.centre()[1]];
        let style = TextStyle::new(TICK_SIZE, GREY, Align::Start);
        // On a band a rim would show, so it has to be needed.
        if matches!(mark, Mark::Band { .. }) && hidden(&area) == 0 {
            canvas.text_centred(label, middle, style);
        } else {
            canvas.text_with_halo(label, middle, style);
        }
        written.push(area);
    }
}

/// Whether anything of a mark is in the plot.
fn has_place(frame: &PlotFrame, mark: &Mark) -> bool {
    match mark {
        Mark::Band { from, to, .. } => band(frame, *from, *to).is_some(),
        Mark::Point { at, .. } | Mark::Text { at, .. } => {
            let at = frame.point_to_px(*at, false);
            at.is_some_and(|at| frame.plot.contains(at))
        }
        Mark::Vertical { .. } | Mark::Horizontal { .. } | Mark::Slope { .. } => {
            !path(frame, mark).is_empty()
        }
    }
}

/// Beyond this distance words need a line to what they name.
const MAX_GAP: f64 = 34.0;

/// Whether the line from a mark's point to its words goes through what is written elsewhere, as the legend.
fn leader_meets(frame: &PlotFrame, mark: &Mark, words: &Rect, other: &Rect) -> bool {
    let (Mark::Point { at, .. } | Mark::Text { at, .. }) = mark else {
        return false;
    };
    let Some([x, y]) = frame.point_to_px(*at, false) else {
        return false;
    };
    let end = [x.clamp(words.x0, words.x1), y.clamp(words.y0, words.y1)];
    let step = |t: f64| [x + t * (end[0] - x), y + t * (end[1] - y)];
    (0..=40).any(|i| other.contains(step(f64::from(i) / 40.0)))
}

/// A thin line from a point to the words that name it, where they stand away from it.
pub(crate) fn leader(canvas: &mut Canvas<'_>, [x, y]: [f64; 2], words: &Rect, clearance: f64) {
    let words = words.grown(4.0);
    let end = [x.clamp(words.x0, words.x1), y.clamp(words.y0, words.y1)];
    let [dx, dy] = [end[0] - x, end[1] - y];
    let length = dx.hypot(dy);
    if length > MAX_GAP {
        let start = [x + dx / length * clearance, y + dy / length * clearance];
        canvas.line(&[start, end], LineStyle::solid(GREY, LEADER_WIDTH));
    }
}

/// Width of the line from words to what they name.
const LEADER_WIDTH: f64 = 1.4;

/// Places for the words of a mark, the best first.
//
// Long: the candidates of each kind of mark.
fn label_candidates(frame: &PlotFrame, mark: &Mark, [width, height]: [f64; 2]) -> Vec<Rect> {
    const GAP: f64 = 12.0;
    let plot = frame.plot;
    let parts = || (0..=10).map(|i| f64::from(i) / 10.0);
    let y_at = |t: f64| plot.y0 + GAP + t * (plot.height() - height - 2.0 * GAP);
    let x_at = |t: f64| plot.x1 - GAP - width - t * (plot.width() - width - 2.0 * GAP);
    let corners: Vec<[f64; 2]> = match mark {
        Mark::Vertical { at, .. } => {
            let sides = frame.x_to_px(*at).map(|x| [x + GAP, x - GAP - width]);
            let along = |x: [f64; 2]| parts().flat_map(move |t| x.map(|x| (x, t)));
            let places = sides.into_iter().flat_map(along);
            places.map(|(x, t)| [x, y_at(t)]).collect()
        }
        Mark::Horizontal { at, .. } => {
            let sides = frame
                .y_to_px(*at, false)
                .map(|y| [y - GAP - height, y + GAP]);
            let along = |y: [f64; 2]| parts().flat_map(move |t| y.map(|y| (t, y)));
            let places = sides.into_iter().flat_map(along);
            places.map(|(t, y)| [x_at(t), y]).collect()
        }
        Mark::Band { from, to, .. } => {
            let Some(band) = band(frame, *from, *to) else {
                return Vec::new();
            };
            let x = (band.centre()[0] - 0.5 * width)
                .clamp(plot.x0 + GAP, (plot.x1 - GAP - width).max(plot.x0 + GAP));
            parts().map(|t| [x, y_at(t)]).collect()
        }
        Mark::Point { at, .. } | Mark::Text { at, .. } => {
            let Some([x, y]) = frame.point_to_px(*at, false) else {
                return Vec::new();
            };
            let around = |factor: f64| {
                let d = (MARKER_RADIUS + GAP) * factor;
                [
                    [x + d, y - 0.5 * height],
                    [x - d - width, y - 0.5 * height],
                    [x - 0.5 * width, y - d - height],
                    [x - 0.5 * width, y + d],
                    // Near the left or the right edge only this position fits.
                    [x - MARKER_RADIUS, y - d - height],
                    [x - MARKER_RADIUS, y + d],
                    [x + MARKER_RADIUS - width, y - d - height],
                    [x + MARKER_RADIUS - width, y + d],
                    [x + 0.7 * d, y - 0.7 * d - height],
                    [x - 0.7 * d - width, y - 0.7 * d - height],
                    [x + 0.7 * d, y + 0.7 * d],
                    [x - 0.7 * d - width, y + 0.7 * d],
                ]
            };
            [1.0, 2.0, 3.5, 5.0, 7.0, 9.0, 12.0, 15.0]
                .into_iter()
                .flat_map(around)
                .collect()
        }
        Mark::Slope { .. } => {
            let runs = path(frame, mark);
            let beside = |[x, y]: &[f64; 2]| {
                let (right, left) = (x + GAP, x - GAP - width);
                let (above, below) = (y - 1.3 * height, y + 0.3 * height);
                [[right, below], [left, above], [right, above], [left, below]]
            };
            runs.iter().flatten().step_by(8).flat_map(beside).collect()
        }
    };
    let area = |[x, y]: [f64; 2]| Rect::sized(x, y, width, height);
    corners.into_iter().map(area).collect()
}
