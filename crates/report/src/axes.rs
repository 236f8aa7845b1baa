//! The frame of a plot: conversion of values to pixels, grid, spines, ticks and labels.

use crate::axis::{Axis, Scale};
use crate::axis_range::AxisRange;
use crate::canvas::{Align, Canvas, LineStyle, TextStyle};
use crate::fonts::{widest, width};
use crate::linear_ticks::Ticks;
use crate::rect::Rect;
use crate::theme::{
    GRID, GRID_WIDTH, INK, MINOR_GRID, PANEL_TITLE_SIZE, Rgb, SPINE_WIDTH, TICK_LENGTH, TICK_SIZE,
};
use crate::ticks::fit;
use crate::wrapped_text::{self, WrappedText};

/// Between a tick and its label.
const TICK_GAP: f64 = 8.0;
/// Between tick labels and the axis label.
const LABEL_GAP: f64 = 12.0;
/// Share of the font size above and below which lines of text touch.
const LEADING: f64 = 1.25;

/// A plot in the page and the spans of its axes.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlotFrame {
    pub(crate) plot: Rect,
    pub(crate) x: AxisRange,
    pub(crate) y: AxisRange,
    pub(crate) y2: Option<AxisRange>,
}

impl PlotFrame {
    /// Pixel of a value on the horizontal axis; `None` if the scale cannot show it.
    pub(crate) fn x_to_px(&self, x: f64) -> Option<f64> {
        let fraction = self.x.fraction(x)?;
        Some(self.plot.x0 + fraction * self.plot.width())
    }

    /// Pixel of a value on the left or right axis; `None` if the scale cannot show it.
    pub(crate) fn y_to_px(&self, y: f64, right: bool) -> Option<f64> {
        let range = self.y2.as_ref().filter(|_| right).unwrap_or(&self.y);
        let fraction = range.fraction(y)?;
        Some(self.plot.y1 - fraction * self.plot.height())
    }

    /// Pixel of a point; `None` if a scale cannot show it.
    pub(crate) fn point_to_px(&self, [x, y]: [f64; 2], right: bool) -> Option<[f64; 2]> {
        Some([self.x_to_px(x)?, self.y_to_px(y, right)?])
    }
}

/// Ticks along a horizontal length, as many as fit without their labels touching.
pub(crate) fn horizontal_ticks(range: &AxisRange, length: f64) -> Ticks {
    let max_count = if range.scale == Scale::Log { 13 } else { 9 };
    fit(range, max_count, |ticks| {
        let ends = |(v, label): (&f64, &String)| {
            let at = range.fraction(*v).unwrap_or(0.0) * length;
            let half = 0.5 * width(label, TICK_SIZE, false);
            (at - half, at + half)
        };
        let extents: Vec<(f64, f64)> = ticks.major.iter().zip(&ticks.labels).map(ends).collect();
        extents
            .windows(2)
            .any(|pair| pair[0].1 + TICK_SIZE > pair[1].0)
    })
}

/// Ticks along a vertical length.
pub(crate) fn vertical_ticks(range: &AxisRange, length: f64) -> Ticks {
    let room = match range.scale {
        Scale::Log => 44.0,
        Scale::Linear | Scale::Degrees => 62.0,
    };
    let max_count = (length / room).clamp(2.0, 11.0) as usize;
    let crowded = |ticks: &Ticks| {
        let place = |v: &f64| range.fraction(*v).unwrap_or(0.0) * length;
        let at: Vec<f64> = ticks.major.iter().map(place).collect();
        at.windows(2)
            .any(|pair| (pair[1] - pair[0]).abs() < LEADING * TICK_SIZE)
    };
    // Fewer than three labels make a poor scale: allow closer ones.
    let closest = ((length / (LEADING * TICK_SIZE)) as usize).max(max_count);
    let mut all = (max_count..=closest).map(|count| fit(range, count, crowded));
    let enough = all.find(|ticks| ticks.major.len() > 2);
    enough.unwrap_or_else(|| fit(range, closest, crowded))
}

/// Width that a vertical axis needs beside a plot of this height.
pub(crate) fn side_room(axis: &Axis, ticks: &Ticks, height: f64) -> f64 {
    ticks_room(ticks) + label_room(&wrapped_text::fitted_label(axis, ticks, height))
}

/// Width that the ticks of a vertical axis need beside the plot.
fn ticks_room(ticks: &Ticks) -> f64 {
    TICK_LENGTH + TICK_GAP + widest(&ticks.labels, TICK_SIZE, false)
}

/// Height that the horizontal axis needs below the plot; without labels that of its ticks and of half a label of the
/// vertical axis.
pub(crate) fn bottom_room(axis: Option<&Axis>, ticks: &Ticks, cell: &Rect) -> f64 {
    let Some(axis) = axis else {
        return TICK_LENGTH.max(0.6 * TICK_SIZE);
    };
    let label = wrapped_text::horizontal_label(axis, ticks, cell);
    TICK_LENGTH + TICK_GAP + TICK_SIZE + label_room(&label)
}

fn label_room(wrapped: &WrappedText) -> f64 {
    if wrapped.lines.is_empty() {
        0.0
    } else {
        LABEL_GAP + wrapped.height()
    }
}

/// Room above the plot.
pub(crate) fn top_room(title: &str, cell: &Rect) -> f64 {
    let wrapped = wrapped_text::title(title, cell);
    if wrapped.lines.is_empty() {
        0.7 * TICK_SIZE
    } else {
        wrapped.height() + 0.5 * PANEL_TITLE_SIZE
    }
}

/// Room on the right that half a tick label at the very end needs.
pub(crate) fn right_room() -> f64 {
    1.3 * TICK_SIZE
}

/// Draws the light lines.
pub(crate) fn grid_lines(canvas: &mut Canvas<'_>, frame: &PlotFrame, x: &Ticks, y: &Ticks) {
    let Rect { x0, y0, x1, y1 } = frame.plot;
    for (minor, color) in [(true, MINOR_GRID), (false, GRID)] {
        let line = LineStyle::solid(color, GRID_WIDTH);
        let [x, y] = [x, y].map(|ticks| if minor { &ticks.minor } else { &ticks.major });
        for at in x.iter().filter_map(|v| frame.x_to_px(*v)) {
            canvas.line(&[[at, y0], [at, y1]], line);
        }
        for at in y.iter().filter_map(|v| frame.y_to_px(*v, false)) {
            canvas.line(&[[x0, at], [x1, at]], line);
        }
    }
}

/// Draws the horizontal axis: spine, ticks, and words if there are any.
pub(crate) fn horizontal_axis(
    canvas: &mut Canvas<'_>,
    frame: &PlotFrame,
    cell: &Rect,
    axis: Option<&Axis>,
    ticks: &Ticks,
) {
    let plot = &frame.plot;
    let spine = LineStyle::solid(INK, SPINE_WIDTH);
    canvas.line(&[[plot.x0, plot.y1], [plot.x1, plot.y1]], spine);
    ticks_below(canvas, plot, &frame.x, ticks, axis.is_some());
    let Some(axis) = axis else { return };
    let top = plot.y1 + TICK_LENGTH + TICK_GAP + TICK_SIZE + LABEL_GAP;
    let wrapped = wrapped_text::horizontal_label(axis, ticks, cell);
    for (line, baseline) in wrapped.baselines() {
        let style = TextStyle::new(wrapped.size, INK, Align::Middle);
        // Between unlike sides the plot is not in the middle of its cell, and another may be beside it.
        let half = 0.5 * width(line, wrapped.size, false);
        let middle = plot.centre()[0].min(cell.x1 - half).max(cell.x0 + half);
        canvas.text(line, [middle, top + baseline], style);
    }
}

/// Draws ticks below a plot or a bar, with their labels or without.
pub(crate) fn ticks_below(
    canvas: &mut Canvas<'_>,
    plot: &Rect,
    range: &AxisRange,
    ticks: &Ticks,
    labelled: bool,
) {
    let baseline = plot.y1 + TICK_LENGTH + TICK_GAP + 0.76 * TICK_SIZE;
    for (value, label) in ticks.major.iter().zip(&ticks.labels) {
        let Some(x) = range.fraction(*value).map(|u| plot.x0 + u * plot.width()) else {
            continue;
        };
        let tick = [[x, plot.y1], [x, plot.y1 + TICK_LENGTH]];
        canvas.line(&tick, LineStyle::solid(INK, SPINE_WIDTH));
        if labelled {
            let style = TextStyle::new(TICK_SIZE, INK, Align::Middle);
            canvas.text(label, [x, baseline], style);
        }
    }
}

/// Draws a vertical axis, with its words at the edge of the cell.
pub(crate) fn vertical_axis(
    canvas: &mut Canvas<'_>,
    frame: &PlotFrame,
    cell: &Rect,
    axis: &Axis,
    style: &VerticalAxisStyle<'_>,
) {
    let plot = &frame.plot;
    let (at, out, align) = if style.right {
        (plot.x1, 1.0, Align::Start)
    } else {
        (plot.x0, -1.0, Align::End)
    };
    let spine = LineStyle::solid(style.color, SPINE_WIDTH);
    canvas.line(&[[at, plot.y0], [at, plot.y1]], spine);
    for (value, label) in style.ticks.major.iter().zip(&style.ticks.labels) {
        if let Some(y) = frame.y_to_px(*value, style.right) {
            canvas.line(&[[at, y], [at + out * TICK_LENGTH, y]], spine);
            let position = [at + out * (TICK_LENGTH + TICK_GAP), y];
            let text_style = TextStyle::new(TICK_SIZE, style.color, align);
            canvas.text_centred(label, position, text_style);
        }
    }
    // The words keep to the heights of the plot, as it was before it gave way to a legend: what is above and below them is a
    // title, the words of the horizontal axis, or the next chart of a stack.
    let (top, bottom) = style.heights;
    let strip = if style.right {
        cell.x1 - plot.x1
    } else {
        plot.x0 - cell.x0
    };
    let room = strip - ticks_room(style.ticks) - 0.5 * LABEL_GAP;
    let wrapped = wrapped_text::fitted_label(axis, style.ticks, bottom - top).shrunk_to_fit(
        bottom - top,
        room,
        false,
    );
    // Lines that read upwards follow each other to the right.
    let left = if style.right {
        cell.x1 - wrapped.height()
    } else {
        cell.x0
    };
    for (line, baseline) in wrapped.baselines() {
        let text_style = TextStyle::new(wrapped.size, style.color, Align::Middle);
        let half = 0.5 * width(line, wrapped.size, false);
        let middle = plot.centre()[1].min(bottom - half).max(top + half);
        canvas.text_upwards(line, [left + baseline, middle], text_style);
    }
}

/// How a vertical axis is drawn.
pub(crate) struct VerticalAxisStyle<'a> {
    pub(crate) ticks: &'a Ticks,
    pub(crate) color: Rgb,
    pub(crate) right: bool,
    /// Between which heights the label may stand.
    pub(crate) heights: (f64, f64),
}

/// Draws the title of a panel.
pub(crate) fn title(canvas: &mut Canvas<'_>, title: &str, plot: &Rect, cell: &Rect) {
    let wrapped = wrapped_text::title(title, cell);
    for (line, baseline) in wrapped.baselines() {
        let style = TextStyle::new(wrapped.size, INK, Align::Start).bold();
        // Beside a vertical axis with many words a long title has to begin before the plot.
        let x = plot.x0.min(cell.x1 - width(line, wrapped.size, true));
        canvas.text(line, [x, cell.y0 + baseline], style);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn neighbouring_labels_keep_apart() {
        for (scale, low, high) in [
            (Scale::Linear, 0.0, 12_345.0),
            (Scale::Log, 1e-16, 1.0),
            (Scale::Degrees, -720.0, 720.0),
        ] {
            for length in [200.0, 500.0, 800.0] {
                let range = AxisRange {
                    scale,
                    min: low,
                    max: high,
                };
                let ticks = horizontal_ticks(&range, length);
                let place = |i: usize| range.fraction(ticks.major[i]).unwrap() * length;
                for i in 1..ticks.major.len() {
                    let half = |i: usize| 0.5 * width(&ticks.labels[i], TICK_SIZE, false);
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
        // Three ticks at the most would leave but the zero.
        let range = AxisRange {
            scale: Scale::Linear,
            min: -4900.0,
            max: 4400.0,
        };
        assert!(vertical_ticks(&range, 240.0).major.len() > 1);
    }
}
