//! The names of a grid's columns, across or turned.

use crate::canvas::{Align, Canvas, Drawn, Type};
use crate::fonts::{broken, width};
use crate::theme::INK;

/// Type of names and cells.
pub(crate) const SIZE: f64 = 25.0;
/// Distance of baselines, in font sizes.
pub(crate) const LEADING: f64 = 1.2;
/// Between names and cells, and between names.
const PAD: f64 = 7.0;
/// Names of columns that need more lines across are turned.
const ACROSS: usize = 3;
/// Least height of turned names that are broken into lines.
const TURNED: f64 = 160.0;

/// Names of columns, broken into lines.
pub(crate) struct Header {
    pub(crate) names: Vec<Vec<String>>,
    turned: bool,
    pub(crate) height: f64,
}

/// Lines of text below `top`.
pub(crate) fn stacked(
    canvas: &mut Canvas<'_>,
    lines: &[String],
    [x, top]: [f64; 2],
    look: Type,
) -> Drawn {
    for (i, line) in lines.iter().enumerate() {
        let middle = top + (i as f64 + 0.5) * LEADING * look.size;
        canvas.text_beside(line, [x, middle], look)?;
    }
    Ok(())
}

/// Turned names have no room for lines of their own choice.
fn one_line(name: &str) -> String {
    name.split_whitespace().collect::<Vec<_>>().join(" ")
}

impl Header {
    pub(crate) fn new(columns: &[String], column: f64) -> Self {
        let columns: Vec<String> = columns.iter().map(|name| one_line(name)).collect();
        let room = column - PAD;
        let across: Vec<Vec<String>> = columns
            .iter()
            .map(|name| broken(name, SIZE, false, room))
            .collect();
        let kept = columns.iter().zip(&across).all(|(name, lines)| {
            lines.len() <= ACROSS
                && name
                    .split_ascii_whitespace()
                    .all(|word| width(word, SIZE, false) <= room)
        });
        if kept {
            let most = across.iter().map(Vec::len).max().unwrap_or(0);
            return Self {
                height: most as f64 * LEADING * SIZE + 2.0 * PAD,
                names: across,
                turned: false,
            };
        }
        // As high as it takes for the lines of each name to lie side by side over its column.
        let most = ((column / (LEADING * SIZE)) as usize).max(1);
        let mut room = TURNED;
        let names = loop {
            let names: Vec<Vec<String>> = columns
                .iter()
                .map(|name| broken(name, SIZE, false, room))
                .collect();
            if names.iter().all(|lines| lines.len() <= most) {
                break names;
            }
            room *= 1.1;
        };
        let longest = names
            .iter()
            .flatten()
            .map(|line| width(line, SIZE, false))
            .fold(0.0, f64::max);
        Self {
            names,
            turned: true,
            height: longest + 2.0 * PAD,
        }
    }

    /// Draws the names from `[left, top]` on, close to the cells below or above them.
    pub(crate) fn draw(
        &self,
        canvas: &mut Canvas<'_>,
        [left, top]: [f64; 2],
        column: f64,
        below: bool,
    ) -> Drawn {
        for (i, lines) in self.names.iter().enumerate() {
            let middle = left + (i as f64 + 0.5) * column;
            let high = LEADING * SIZE * lines.len() as f64;
            if !self.turned {
                let y = if below {
                    top + PAD
                } else {
                    top + self.height - PAD - high
                };
                stacked(
                    canvas,
                    lines,
                    [middle, y],
                    Type::new(SIZE, INK, Align::Middle),
                )?;
                continue;
            }
            let (y, align) = if below {
                (top + PAD, Align::End)
            } else {
                (top + self.height - PAD, Align::Start)
            };
            for (k, line) in lines.iter().enumerate() {
                let baseline = middle - 0.5 * high + ((k as f64 + 0.5) * LEADING + 0.365) * SIZE;
                canvas.text_upwards(line, [baseline, y], Type::new(SIZE, INK, align))?;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fonts;

    #[test]
    fn names_that_do_not_fit_across_are_turned_and_lie_side_by_side() {
        fonts::ready().unwrap();
        let short = Header::new(&["tape".to_owned(), "dense rows".to_owned()], 500.0);
        assert!(!short.turned);
        let long = Header::new(&["a quadrature of the energy over a turn".to_owned()], 70.0);
        assert!(long.turned);
        for lines in &long.names {
            assert!(lines.len() as f64 * LEADING * SIZE <= 70.0);
        }
    }
}
