//! The key of a grid: a colour bar with ticks, and the two marks of cells.

use crate::axes::{horizontal_ticks, ticks_below};
use crate::axis::Axis;
use crate::axis_range::AxisRange;
use crate::canvas::{Align, Canvas, LineStyle, TextStyle};
use crate::cell_marks::hatched_cell;
use crate::colormap;
use crate::fonts::width;
use crate::linear_ticks::Ticks;
use crate::rect::Rect;
use crate::theme::{FAILED, INK, TICK_LENGTH, TICK_SIZE, WHITE};
use crate::wrapped_text::{self, WrappedText};

/// Height of the bar, its share of the width, and how many steps of colour it is drawn in.
const BAR_HEIGHT: f64 = 24.0;
const BAR_SHARE: f64 = 0.55;
const STEPS: u32 = 64;
/// Between bar, ticks and words.
const GAP: f64 = 8.0;
/// Height of a line of the key, and a cell in it.
const KEY_HEIGHT: f64 = 40.0;
const CELL_WIDTH: f64 = 56.0;
/// Below everything.
const BOTTOM_GAP: f64 = 18.0;

/// The bar and the key, measured.
pub(crate) struct ColorBar {
    scale: Option<ColorScale>,
    key: Vec<CellMark>,
}

struct ColorScale {
    range: AxisRange,
    ticks: Ticks,
    label: WrappedText,
    /// From the left end of the strip, so that the label of the first tick is not cut.
    left: f64,
    width: f64,
}

/// What a cell may be besides its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum CellMark {
    NotApplicable,
    Failed,
}

impl ColorBar {
    /// A bar for the span, if there are values, and the marks that occur.
    pub(crate) fn new(
        axis: &Axis,
        range: Option<AxisRange>,
        key: Vec<CellMark>,
        width: f64,
    ) -> Self {
        let scale = range.map(|range| ColorScale::new(axis, range, BAR_SHARE * width));
        Self { scale, key }
    }

    pub(crate) fn height(&self) -> f64 {
        let scale = self.scale.as_ref().map_or(0.0, ColorScale::height);
        let strip = scale.max(KEY_HEIGHT * self.key.len() as f64);
        if strip > 0.0 { strip + BOTTOM_GAP } else { 0.0 }
    }

    /// Draws it in a strip of the width it was made for.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>, strip: &Rect) {
        let mut x = strip.x0;
        if let Some(scale) = &self.scale {
            scale.draw(canvas, [strip.x0 + scale.left, strip.y0]);
            x += (BAR_SHARE + 0.05) * strip.width();
        }
        for (i, mark) in self.key.iter().enumerate() {
            let y = strip.y0 + KEY_HEIGHT * i as f64;
            let cell = Rect::sized(x, y, CELL_WIDTH, KEY_HEIGHT).grown(-3.0);
            let text = match mark {
                CellMark::NotApplicable => {
                    hatched_cell(canvas, &cell);
                    "does not apply"
                }
                CellMark::Failed => {
                    canvas.rect(&cell, FAILED);
                    "failed"
                }
            };
            let at = [cell.x1 + 2.0 * GAP, y + 0.5 * KEY_HEIGHT];
            canvas.text_centred(text, at, TextStyle::new(TICK_SIZE, INK, Align::Start));
        }
    }
}

impl ColorScale {
    fn new(axis: &Axis, range: AxisRange, room: f64) -> Self {
        // Half a label at either end; how wide they are depends a little on how many there are.
        let half = |label: Option<&String>| label.map_or(0.0, |l| 0.5 * width(l, TICK_SIZE, false));
        let first = horizontal_ticks(&range, 0.8 * room);
        let (from, to) = (half(first.labels.first()), half(first.labels.last()));
        let width = (room - from - to).max(0.3 * room);
        let ticks = horizontal_ticks(&range, width);
        let axis_label = wrapped_text::fitted_label(axis, &ticks, width);
        Self {
            range,
            ticks,
            label: axis_label,
            left: from,
            width,
        }
    }

    fn height(&self) -> f64 {
        self.label.height() + GAP + BAR_HEIGHT + TICK_LENGTH + GAP + TICK_SIZE
    }

    fn draw(&self, canvas: &mut Canvas<'_>, [x, y]: [f64; 2]) {
        let style = TextStyle::new(self.label.size, INK, Align::Start);
        self.label.draw(canvas, [x, y], style);
        let bar = Rect::sized(x, y + self.label.height() + GAP, self.width, BAR_HEIGHT);
        canvas.rect(&bar, WHITE);
        for i in 0..STEPS {
            let share = |i: u32| f64::from(i) / f64::from(STEPS);
            // Each reaches below the next, so that no seam shows.
            let part = Rect {
                x0: bar.x0 + share(i) * bar.width(),
                ..bar
            };
            canvas.rect(&part, colormap::color(f64::from(i) / f64::from(STEPS - 1)));
        }
        canvas.rect_outline(&bar, LineStyle::solid(INK, 1.2));
        ticks_below(canvas, &bar, &self.range, &self.ticks, true);
    }
}
