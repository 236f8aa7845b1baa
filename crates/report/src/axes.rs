//! The frame of a plot: values to pixels, grid, spines, ticks and their words.

use crate::canvas::{Align, Canvas, Drawn, Line, Type};
use crate::figure::{Axis, Scale};
use crate::fonts::width;
use crate::rect::Rect;
use crate::span::Span;
use crate::theme::{GRID, GRID_WIDTH, INK, MINOR_GRID, PANEL_TITLE, Rgb, SPINE, TICK, TICK_LENGTH};
use crate::ticks::{Ticks, fit};
use crate::words::{self, Words};

/// Between a tick and its label.
const TICK_GAP: f64 = 8.0;
/// Between tick labels and the axis label.
const LABEL_GAP: f64 = 12.0;
/// Share of the font size above and below which lines of text touch.
const LEADING: f64 = 1.25;

/// A plot in the page and the spans of its axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Frame {
    pub(crate) plot: Rect,
    pub(crate) x: Span,
    pub(crate) y: Span,
    pub(crate) y2: Option<Span>,
}

impl Frame {
    /// Pixel of a value on the horizontal axis; none if it has no place there.
    pub(crate) fn across(&self, x: f64) -> Option<f64> {
        self.x
            .place(x)
            .map(|u| self.plot.x0 + u * self.plot.width())
    }

    /// Pixel of a value on the left or right axis; none if it has no place there.
    pub(crate) fn up(&self, y: f64, right: bool) -> Option<f64> {
        let span = if right {
            self.y2.as_ref().unwrap_or(&self.y)
        } else {
            &self.y
        };
        span.place(y).map(|v| self.plot.y1 - v * self.plot.height())
    }

    /// Pixel of a point; none if it has no place.
    pub(crate) fn point(&self, [x, y]: [f64; 2], right: bool) -> Option<[f64; 2]> {
        Some([self.across(x)?, self.up(y, right)?])
    }
}

/// Ticks along a horizontal length, as many as fit without their labels touching.
pub(crate) fn ticks_across(span: &Span, length: f64) -> Ticks {
    let most = if span.scale == Scale::Log { 13 } else { 9 };
    fit(span, most, |ticks| {
        let ends = |(v, label): (&f64, &String)| {
            let (at, half) = (
                span.place(*v).unwrap_or(0.0) * length,
                0.5 * width(label, TICK, false),
            );
            (at - half, at + half)
        };
        let extents: Vec<(f64, f64)> = ticks.major.iter().zip(&ticks.labels).map(ends).collect();
        extents.windows(2).any(|pair| pair[0].1 + TICK > pair[1].0)
    })
}

/// Ticks along a vertical length.
pub(crate) fn ticks_up(span: &Span, length: f64) -> Ticks {
    let room = if span.scale == Scale::Log { 44.0 } else { 62.0 };
    let most = (length / room).clamp(2.0, 11.0) as usize;
    let crowded = |ticks: &Ticks| {
        let at: Vec<f64> = ticks
            .major
            .iter()
            .map(|v| span.place(*v).unwrap_or(0.0) * length)
            .collect();
        at.windows(2)
            .any(|pair| (pair[1] - pair[0]).abs() < LEADING * TICK)
    };
    let ticks = fit(span, most, crowded);
    if ticks.major.len() > 1 {
        return ticks;
    }
    // One value is no scale: closer together, then.
    fit(span, (length / (LEADING * TICK)) as usize, crowded)
}

/// Room a vertical axis needs beside a plot of this height.
pub(crate) fn side_room(axis: &Axis, ticks: &Ticks, height: f64) -> f64 {
    ticks_room(ticks) + label_room(&words::label_within(axis, ticks, height))
}

/// Room the ticks of a vertical axis need beside the plot.
fn ticks_room(ticks: &Ticks) -> f64 {
    let wide = ticks.labels.iter().map(|label| width(label, TICK, false));
    TICK_LENGTH + TICK_GAP + wide.fold(0.0, f64::max)
}

/// Room the horizontal axis needs below the plot; without words only that for its ticks, and for half a label of the
/// vertical axis.
pub(crate) fn bottom_room(axis: Option<&Axis>, ticks: &Ticks, cell: &Rect) -> f64 {
    let Some(axis) = axis else {
        return TICK_LENGTH.max(0.6 * TICK);
    };
    TICK_LENGTH + TICK_GAP + TICK + label_room(&words::across(axis, ticks, cell))
}

fn label_room(words: &Words) -> f64 {
    if words.lines.is_empty() {
        0.0
    } else {
        LABEL_GAP + words.height()
    }
}

/// Room above the plot.
pub(crate) fn top_room(title: &str, cell: &Rect) -> f64 {
    let words = words::title(title, cell);
    if words.lines.is_empty() {
        0.7 * TICK
    } else {
        words.height() + 0.5 * PANEL_TITLE
    }
}

/// Room on the right that half a tick label at the very end needs.
pub(crate) fn right_room() -> f64 {
    1.3 * TICK
}

/// Draws the light lines.
pub(crate) fn grid(canvas: &mut Canvas<'_>, frame: &Frame, x: &Ticks, y: &Ticks) -> Drawn {
    let Rect { x0, y0, x1, y1 } = frame.plot;
    for (minor, color) in [(true, MINOR_GRID), (false, GRID)] {
        let line = Line::solid(color, GRID_WIDTH);
        let values = |ticks: &Ticks| {
            if minor {
                ticks.minor.clone()
            } else {
                ticks.major.clone()
            }
        };
        for at in values(x).into_iter().filter_map(|v| frame.across(v)) {
            canvas.line(&[[at, y0], [at, y1]], line)?;
        }
        for at in values(y).into_iter().filter_map(|v| frame.up(v, false)) {
            canvas.line(&[[x0, at], [x1, at]], line)?;
        }
    }
    Ok(())
}

/// Draws the horizontal axis: spine, ticks, and words if there are any.
pub(crate) fn bottom(
    canvas: &mut Canvas<'_>,
    frame: &Frame,
    cell: &Rect,
    axis: Option<&Axis>,
    ticks: &Ticks,
) -> Drawn {
    let plot = &frame.plot;
    let spine = Line::solid(INK, SPINE);
    canvas.line(&[[plot.x0, plot.y1], [plot.x1, plot.y1]], spine)?;
    let baseline = plot.y1 + TICK_LENGTH + TICK_GAP + 0.76 * TICK;
    for (value, label) in ticks.major.iter().zip(&ticks.labels) {
        if let Some(x) = frame.across(*value) {
            canvas.line(&[[x, plot.y1], [x, plot.y1 + TICK_LENGTH]], spine)?;
            if axis.is_some() {
                canvas.text(label, [x, baseline], Type::new(TICK, INK, Align::Middle))?;
            }
        }
    }
    let Some(axis) = axis else { return Ok(()) };
    let top = plot.y1 + TICK_LENGTH + TICK_GAP + TICK + LABEL_GAP;
    let words = words::across(axis, ticks, cell);
    for (line, baseline) in words.baselines() {
        let look = Type::new(words.size, INK, Align::Middle);
        // Between unlike sides the plot is not in the middle of its cell, and another may be beside it.
        let half = 0.5 * width(line, words.size, false);
        let middle = plot.centre()[0].min(cell.x1 - half).max(cell.x0 + half);
        canvas.text(line, [middle, top + baseline], look)?;
    }
    Ok(())
}

/// Draws a vertical axis, with its words at the edge of the cell.
pub(crate) fn side(
    canvas: &mut Canvas<'_>,
    frame: &Frame,
    cell: &Rect,
    axis: &Axis,
    look: &Side<'_>,
) -> Drawn {
    let plot = &frame.plot;
    let (at, out, align) = if look.right {
        (plot.x1, 1.0, Align::Start)
    } else {
        (plot.x0, -1.0, Align::End)
    };
    let spine = Line::solid(look.color, SPINE);
    canvas.line(&[[at, plot.y0], [at, plot.y1]], spine)?;
    for (value, label) in look.ticks.major.iter().zip(&look.ticks.labels) {
        if let Some(y) = frame.up(*value, look.right) {
            canvas.line(&[[at, y], [at + out * TICK_LENGTH, y]], spine)?;
            let place = [at + out * (TICK_LENGTH + TICK_GAP), y];
            canvas.text_beside(label, place, Type::new(TICK, look.color, align))?;
        }
    }
    // The words keep to the heights of the plot, as it was before it gave way to a legend: what is above and below them is a
    // title, the words of the horizontal axis, or the next chart of a stack.
    let (top, bottom) = look.heights;
    let beside = if look.right {
        cell.x1 - plot.x1
    } else {
        plot.x0 - cell.x0
    };
    let words = words::label_within(axis, look.ticks, bottom - top).within(
        bottom - top,
        beside - ticks_room(look.ticks) - 0.5 * LABEL_GAP,
        false,
    );
    // Lines that read upwards follow each other to the right.
    let left = if look.right {
        cell.x1 - words.height()
    } else {
        cell.x0
    };
    for (line, baseline) in words.baselines() {
        let text = Type::new(words.size, look.color, Align::Middle);
        let half = 0.5 * width(line, words.size, false);
        let middle = plot.centre()[1].min(bottom - half).max(top + half);
        canvas.text_upwards(line, [left + baseline, middle], text)?;
    }
    Ok(())
}

/// How a vertical axis is drawn.
pub(crate) struct Side<'a> {
    pub(crate) ticks: &'a Ticks,
    pub(crate) color: Rgb,
    pub(crate) right: bool,
    /// Between which heights the label may stand.
    pub(crate) heights: (f64, f64),
}

/// Draws the title of a panel.
pub(crate) fn title(canvas: &mut Canvas<'_>, title: &str, plot: &Rect, cell: &Rect) -> Drawn {
    let words = words::title(title, cell);
    for (line, baseline) in words.baselines() {
        let look = Type::new(words.size, INK, Align::Start).bold();
        // Beside a vertical axis with many words a long title has to begin before the plot.
        let x = plot.x0.min(cell.x1 - width(line, words.size, true));
        canvas.text(line, [x, cell.y0 + baseline], look)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fonts;

    #[test]
    fn neighbouring_labels_keep_apart() {
        fonts::ready().unwrap();
        for (scale, low, high) in [
            (Scale::Linear, 0.0, 12_345.0),
            (Scale::Log, 1e-16, 1.0),
            (Scale::Degrees, -720.0, 720.0),
        ] {
            for length in [200.0, 500.0, 800.0] {
                let span = Span { scale, low, high };
                let ticks = ticks_across(&span, length);
                let place = |i: usize| span.place(ticks.major[i]).unwrap() * length;
                for i in 1..ticks.major.len() {
                    let half = |i: usize| 0.5 * width(&ticks.labels[i], TICK, false);
                    let free = place(i) - half(i) - place(i - 1) - half(i - 1);
                    assert!(
                        free > 0.0 || ticks.major.len() <= 2,
                        "{:?} on {length}",
                        ticks.labels
                    );
                }
            }
        }
    }

    #[test]
    fn a_low_plot_has_more_than_one_value_on_its_axis() {
        fonts::ready().unwrap();
        // Three ticks at the most would leave but the zero.
        let span = Span {
            scale: Scale::Linear,
            low: -4900.0,
            high: 4400.0,
        };
        assert!(ticks_up(&span, 240.0).major.len() > 1);
    }
}
