//! What the colours of a grid mean: a bar with ticks, and the two marks a cell may have.

use crate::axes::ticks_across;
use crate::canvas::{Align, Canvas, Drawn, Line, Type};
use crate::figure::Axis;
use crate::fonts::width;
use crate::heat;
use crate::lattice::{failed, hatched};
use crate::rect::Rect;
use crate::span::Span;
use crate::theme::{EDGE, INK, SPINE, TICK, TICK_LENGTH, WHITE};
use crate::ticks::Ticks;
use crate::words::{self, Words};

/// Height of the bar, its share of the width, and how many steps of colour it is drawn in.
const BAR: f64 = 24.0;
const SHARE: f64 = 0.55;
const STEPS: u32 = 64;
/// Between bar, ticks and words.
const GAP: f64 = 8.0;
/// Height of a line of the key, and a cell in it.
const KEY: f64 = 40.0;
const SAMPLE: f64 = 56.0;
/// Below everything.
const BELOW: f64 = 18.0;

/// The bar and the key, measured.
pub(crate) struct ColorBar {
    scale: Option<Scale>,
    key: Vec<Marked>,
}

struct Scale {
    span: Span,
    ticks: Ticks,
    words: Words,
    /// From the left end of the strip, so that the label of the first tick is not cut.
    from: f64,
    width: f64,
}

/// What a cell may be besides its value.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Marked {
    Absent,
    Failed,
}

impl ColorBar {
    /// A bar for the span, if there are values, and the marks that occur.
    pub(crate) fn new(axis: &Axis, span: Option<Span>, key: Vec<Marked>, width: f64) -> Self {
        let scale = span.map(|span| Scale::new(axis, span, SHARE * width));
        Self { scale, key }
    }

    pub(crate) fn height(&self) -> f64 {
        let scale = self.scale.as_ref().map_or(0.0, Scale::height);
        let strip = scale.max(KEY * self.key.len() as f64);
        if strip > 0.0 { strip + BELOW } else { 0.0 }
    }

    /// Draws it in a strip of the width it was made for.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>, strip: &Rect) -> Drawn {
        let mut x = strip.x0;
        if let Some(scale) = &self.scale {
            scale.draw(canvas, [strip.x0 + scale.from, strip.y0])?;
            x += (SHARE + 0.05) * strip.width();
        }
        for (i, marked) in self.key.iter().enumerate() {
            let y = strip.y0 + KEY * i as f64;
            let cell = Rect::sized(x, y, SAMPLE, KEY).grown(-3.0);
            let words = match marked {
                Marked::Absent => {
                    hatched(canvas, &cell)?;
                    "does not apply"
                }
                Marked::Failed => {
                    canvas.frame(&cell, Line::solid(EDGE, 1.5))?;
                    failed(canvas, &cell)?;
                    "failed"
                }
            };
            let at = [cell.x1 + 2.0 * GAP, y + 0.5 * KEY];
            canvas.text_beside(words, at, Type::new(TICK, INK, Align::Start))?;
        }
        Ok(())
    }
}

impl Scale {
    fn new(axis: &Axis, span: Span, room: f64) -> Self {
        // Half a label at either end; how wide they are depends a little on how many there are.
        let half = |label: Option<&String>| label.map_or(0.0, |l| 0.5 * width(l, TICK, false));
        let first = ticks_across(&span, 0.8 * room);
        let (from, to) = (half(first.labels.first()), half(first.labels.last()));
        let width = (room - from - to).max(0.3 * room);
        let ticks = ticks_across(&span, width);
        let words = words::label_within(axis, &ticks, width);
        Self {
            span,
            ticks,
            words,
            from,
            width,
        }
    }

    fn height(&self) -> f64 {
        self.words.height() + GAP + BAR + TICK_LENGTH + GAP + TICK
    }

    fn draw(&self, canvas: &mut Canvas<'_>, [x, y]: [f64; 2]) -> Drawn {
        for (line, baseline) in self.words.baselines() {
            let look = Type::new(self.words.size, INK, Align::Start);
            canvas.text(line, [x, y + baseline], look)?;
        }
        let bar = Rect::sized(x, y + self.words.height() + GAP, self.width, BAR);
        canvas.rect(&bar, WHITE)?;
        for i in 0..STEPS {
            let share = |i: u32| f64::from(i) / f64::from(STEPS);
            // Each reaches below the next, so that no seam shows.
            let part = Rect {
                x0: bar.x0 + share(i) * bar.width(),
                ..bar
            };
            canvas.rect(&part, heat::color(f64::from(i) / f64::from(STEPS - 1)))?;
        }
        canvas.frame(&bar, Line::solid(INK, 1.2))?;
        for (value, label) in self.ticks.major.iter().zip(&self.ticks.labels) {
            let Some(place) = self.span.place(*value) else {
                continue;
            };
            let at = bar.x0 + place * bar.width();
            let tick = [[at, bar.y1], [at, bar.y1 + TICK_LENGTH]];
            canvas.line(&tick, Line::solid(INK, SPINE))?;
            let baseline = bar.y1 + TICK_LENGTH + GAP + 0.76 * TICK;
            canvas.text(label, [at, baseline], Type::new(TICK, INK, Align::Middle))?;
        }
        Ok(())
    }
}
