//! The names of a grid's columns, across or turned.

use crate::canvas::{Align, Canvas, TextStyle};
use crate::fonts::{widest, width, wrapped_anywhere};
use crate::number::one_line;
use crate::theme::INK;

/// Distance of baselines, in font sizes.
pub(crate) const LEADING: f64 = 1.2;
/// Between names and cells, and between names.
const PAD: f64 = 7.0;
/// Names of columns that need more lines across are turned.
const MAX_LINES: usize = 3;
/// Least height of turned names that are broken into lines.
const MIN_ROTATED_HEIGHT: f64 = 160.0;

/// Names of columns, broken into lines.
pub(crate) struct Header {
    pub(crate) names: Vec<Vec<String>>,
    size: f64,
    rotated: bool,
    pub(crate) height: f64,
}

/// Lines of text below `top`.
pub(crate) fn draw_lines(
    canvas: &mut Canvas<'_>,
    lines: &[String],
    [x, top]: [f64; 2],
    style: TextStyle,
) {
    for (i, line) in lines.iter().enumerate() {
        let middle = top + (i as f64 + 0.5) * LEADING * style.size;
        canvas.text_centred(line, [x, middle], style);
    }
}

impl Header {
    /// Names in letters of a size over columns of a width.
    pub(crate) fn new(columns: &[String], column: f64, size: f64) -> Self {
        // Names that read upwards have no room for line breaks.
        let columns: Vec<String> = columns.iter().map(|name| one_line(name)).collect();
        let room = column - PAD;
        let broken = |room: f64| -> Vec<Vec<String>> {
            let names = columns.iter();
            let lines = names.map(|name| wrapped_anywhere(name, size, false, room));
            lines.collect()
        };
        let horizontal = broken(room);
        let lines = horizontal.iter().map(Vec::len).max().unwrap_or(0);
        let mut words = columns
            .iter()
            .flat_map(|name| name.split_ascii_whitespace());
        if lines <= MAX_LINES && words.all(|word| width(word, size, false) <= room) {
            return Self {
                height: lines as f64 * LEADING * size + 2.0 * PAD,
                names: horizontal,
                size,
                rotated: false,
            };
        }
        // As high as it takes for the lines of each name to lie side by side over its column.
        let max_lines = ((column / (LEADING * size)) as usize).max(1);
        let mut room = MIN_ROTATED_HEIGHT;
        let names = loop {
            let names = broken(room);
            if names.iter().all(|lines| lines.len() <= max_lines) {
                break names;
            }
            room *= 1.1;
        };
        let max_width = widest(names.iter().flatten(), size, false);
        Self {
            names,
            size,
            rotated: true,
            height: max_width + 2.0 * PAD,
        }
    }

    /// Draws the names from `[left, top]` on, close to the cells below or above them.
    pub(crate) fn draw(
        &self,
        canvas: &mut Canvas<'_>,
        [left, top]: [f64; 2],
        column: f64,
        below: bool,
    ) {
        for (i, lines) in self.names.iter().enumerate() {
            let middle = left + (i as f64 + 0.5) * column;
            let high = LEADING * self.size * lines.len() as f64;
            if !self.rotated {
                let y = if below {
                    top + PAD
                } else {
                    top + self.height - PAD - high
                };
                let style = TextStyle::new(self.size, INK, Align::Middle);
                draw_lines(canvas, lines, [middle, y], style);
                continue;
            }
            let (y, align) = if below {
                (top + PAD, Align::End)
            } else {
                (top + self.height - PAD, Align::Start)
            };
            for (k, line) in lines.iter().enumerate() {
                let baseline =
                    middle - 0.5 * high + ((k as f64 + 0.5) * LEADING + 0.365) * self.size;
                canvas.text_upwards(line, [baseline, y], TextStyle::new(self.size, INK, align));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_that_do_not_fit_across_are_turned_and_lie_side_by_side() {
        let short = Header::new(&["tape".to_owned(), "dense rows".to_owned()], 500.0, 25.0);
        assert!(!short.rotated);
        let long = Header::new(
            &["a quadrature of the energy over a turn".to_owned()],
            70.0,
            25.0,
        );
        assert!(long.rotated);
        for lines in &long.names {
            assert!(lines.len() as f64 * LEADING * 25.0 <= 70.0);
        }
    }
}
