//! The words around a plot: panel title and axis labels, on as many lines as they need.

use crate::figure::Axis;
use crate::fonts::{width, wrapped};
use crate::number::power_of_ten;
use crate::rect::Rect;
use crate::theme::{LABEL, PANEL_TITLE};
use crate::ticks::Ticks;

/// Distance of baselines, in font sizes.
const LEADING: f64 = 1.25;
/// Words a little too long are set smaller, down to this share; longer ones are broken.
const SMALLER: f64 = 0.85;
/// Words that still do not fit are set as small as they must, but not below this share of that.
const LEAST: f64 = 0.3;
/// What tick labels and margins take from a cell: words have the rest.
const BESIDE: f64 = 190.0;

/// Words broken into lines.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Words {
    pub(crate) lines: Vec<String>,
    pub(crate) size: f64,
}

impl Words {
    fn new(text: &str, size: f64, bold: bool, room: f64) -> Self {
        let needed = width(text, size, bold);
        if text.is_empty() {
            return Self {
                lines: Vec::new(),
                size,
            };
        }
        if needed * SMALLER <= room {
            return Self {
                lines: vec![text.to_owned()],
                size: size * (room / needed).min(1.0),
            };
        }
        Self {
            lines: wrapped(text, SMALLER * size, bold, room),
            size: SMALLER * size,
        }
        .within(room, f64::INFINITY, bold)
    }

    /// The same lines, set smaller if they are longer or together higher than there is room. Ticks may turn out wider than
    /// they were measured, and a word cannot be broken: small words are better than words that lie on others.
    pub(crate) fn within(self, long: f64, high: f64, bold: bool) -> Self {
        let widths = self.lines.iter().map(|line| width(line, self.size, bold));
        let longest = widths.fold(0.0, f64::max);
        let share = (long / longest).min(high / self.height()).min(1.0);
        Self {
            // Of no lines the shares are no numbers; of no room, one cannot make any.
            size: self.size * share.max(LEAST),
            ..self
        }
    }

    /// Height of the lines together.
    pub(crate) fn height(&self) -> f64 {
        LEADING * self.size * self.lines.len() as f64
    }

    /// The lines with their baselines, counted from the top of the first.
    pub(crate) fn baselines(&self) -> impl Iterator<Item = (&str, f64)> {
        let baseline = |i: usize| (LEADING * i as f64 + 0.5 * (LEADING - 1.0) + 0.8) * self.size;
        self.lines
            .iter()
            .enumerate()
            .map(move |(i, line)| (line.as_str(), baseline(i)))
    }
}

/// The title of a panel.
pub(crate) fn title(text: &str, cell: &Rect) -> Words {
    Words::new(text.trim(), PANEL_TITLE, true, cell.width() - BESIDE)
}

/// The label of a horizontal axis.
pub(crate) fn across(axis: &Axis, ticks: &Ticks, cell: &Rect) -> Words {
    Words::new(&label(axis, ticks), LABEL, false, cell.width() - BESIDE)
}

/// The label of a vertical axis, which is as long as its plot at the most, or of a colour bar.
pub(crate) fn label_within(axis: &Axis, ticks: &Ticks, room: f64) -> Words {
    Words::new(&label(axis, ticks), LABEL, false, room)
}

/// What an axis shows: its label, what has been subtracted, power of ten and unit.
fn label(axis: &Axis, ticks: &Ticks) -> String {
    let mut text = axis.label.trim().to_owned();
    if let Some(offset) = &ticks.offset {
        let negative = offset.strip_prefix('−');
        let change = negative.map_or(format!("− {offset}"), |positive| format!("+ {positive}"));
        text = format!("{text} {change}");
    }
    let unit = Some(axis.unit.trim().replace(' ', "\u{a0}")).filter(|unit| !unit.is_empty());
    let inside: Vec<String> = ticks
        .factor
        .map(power_of_ten)
        .into_iter()
        .chain(unit)
        .collect();
    if !inside.is_empty() {
        // SVG closes up plain blanks; a wider one keeps the unit apart, and whole when the label is broken.
        text = format!("{text}\u{2002}({})", inside.join("\u{a0}"));
    }
    text.trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fonts;

    #[test]
    fn an_axis_says_what_was_subtracted_and_by_what_its_labels_are_multiplied() {
        let both = Ticks {
            factor: Some(-7),
            offset: Some("12.3".to_owned()),
            ..Ticks::default()
        };
        assert_eq!(
            label(&Axis::new("energy E", "J"), &both),
            "energy E − 12.3\u{2002}(10⁻⁷\u{a0}J)"
        );
        let below = Ticks {
            offset: Some("−2".to_owned()),
            ..Ticks::default()
        };
        assert_eq!(label(&Axis::new("a", ""), &below), "a + 2");
        assert_eq!(
            label(&Axis::degrees("φ"), &Ticks::default()),
            "φ\u{2002}(°)"
        );
        assert_eq!(label(&Axis::default(), &Ticks::default()), "");
    }

    #[test]
    fn long_words_are_broken_and_stay_legible() {
        fonts::ready().unwrap();
        let cell = Rect::sized(0.0, 0.0, 700.0, 500.0);
        let words = title(
            "A title that is much too long for the panel that it stands above",
            &cell,
        );
        assert!(words.lines.len() > 1 && words.size > 0.8 * PANEL_TITLE);
        assert!(
            words
                .lines
                .iter()
                .all(|line| width(line, words.size, true) <= cell.width() - BESIDE)
        );
        assert!(
            words
                .baselines()
                .all(|(_, y)| y > 0.0 && y < words.height())
        );
    }
}
