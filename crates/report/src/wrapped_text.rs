//! The text around a plot: panel title and axis labels, on as many lines as they need.

use crate::axis::Axis;
use crate::canvas::{Canvas, TextStyle};
use crate::fonts::{widest, width, wrapped};
use crate::linear_ticks::Ticks;
use crate::number::power_of_ten;
use crate::rect::Rect;
use crate::theme::{LABEL_SIZE, PANEL_TITLE_SIZE};
use crate::typeset::typeset;

/// Distance of baselines, in font sizes.
const LEADING: f64 = 1.25;
/// Words a little too long are set smaller, down to this share; longer ones are broken.
const MIN_SHRINK: f64 = 0.85;
/// Words that still do not fit are set as small as they must, but not below this share of that.
const MIN_FIT: f64 = 0.3;
/// The part of a cell that tick labels and margins need.
const MARGINS: f64 = 190.0;

/// Words broken into lines.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct WrappedText {
    pub(crate) lines: Vec<String>,
    pub(crate) size: f64,
}

impl WrappedText {
    fn new(text: &str, size: f64, bold: bool, room: f64) -> Self {
        let needed = width(text, size, bold);
        if text.is_empty() {
            let lines = Vec::new();
            return Self { lines, size };
        }
        if needed * MIN_SHRINK <= room {
            let (lines, size) = (vec![text.to_owned()], size * (room / needed).min(1.0));
            return Self { lines, size };
        }
        let size = MIN_SHRINK * size;
        let lines = wrapped(text, size, bold, room);
        Self { lines, size }.shrunk_to_fit(room, f64::INFINITY, bold)
    }

    /// The same lines, set smaller if they are longer or together higher than there is room. Ticks may turn out wider than
    /// they were measured, and a word cannot be broken: small words are better than words that lie on others.
    pub(crate) fn shrunk_to_fit(self, max_width: f64, max_height: f64, bold: bool) -> Self {
        let widest = widest(&self.lines, self.size, bold);
        let scale = (max_width / widest)
            .min(max_height / self.height())
            .min(1.0);
        Self {
            // Of no lines the shares are no numbers; of no room, one cannot make any.
            size: self.size * scale.max(MIN_FIT),
            ..self
        }
    }

    /// Height of the lines together.
    pub(crate) fn height(&self) -> f64 {
        LEADING * self.size * self.lines.len() as f64
    }

    /// Draws the lines below a place.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>, [x, y]: [f64; 2], style: TextStyle) {
        for (line, baseline) in self.baselines() {
            canvas.text(line, [x, y + baseline], style);
        }
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
pub(crate) fn title(text: &str, cell: &Rect) -> WrappedText {
    let (text, room) = (typeset(text.trim()), cell.width() - MARGINS);
    WrappedText::new(&text, PANEL_TITLE_SIZE, true, room)
}

/// The label of a horizontal axis.
pub(crate) fn horizontal_label(axis: &Axis, ticks: &Ticks, cell: &Rect) -> WrappedText {
    fitted_label(axis, ticks, cell.width() - MARGINS)
}

/// The label of a vertical axis, which is as long as its plot at the most, or of a colour bar.
pub(crate) fn fitted_label(axis: &Axis, ticks: &Ticks, room: f64) -> WrappedText {
    WrappedText::new(&label(axis, ticks), LABEL_SIZE, false, room)
}

/// The label of an axis with the subtracted value, the power of ten and the unit.
fn label(axis: &Axis, ticks: &Ticks) -> String {
    let mut text = typeset(axis.label.trim());
    if let Some(offset) = &ticks.offset {
        let negative = offset.strip_prefix('−');
        let change = negative.map_or(format!("− {offset}"), |positive| format!("+ {positive}"));
        text = format!("{text} {change}");
    }
    let unit = Some(axis.unit.trim().replace(' ', "\u{a0}")).filter(|unit| !unit.is_empty());
    let factor = ticks.factor.map(power_of_ten);
    let inside: Vec<String> = factor.into_iter().chain(unit).collect();
    if !inside.is_empty() {
        // SVG closes up plain blanks; a wider one keeps the unit apart, and whole when the label is broken.
        text = format!("{text}\u{2002}({})", inside.join("\u{a0}"));
    }
    text.trim().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

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
        let cell = Rect::sized(0.0, 0.0, 700.0, 500.0);
        let wrapped = title(
            "A title that is much too long for the panel that it stands above",
            &cell,
        );
        assert!(wrapped.lines.len() > 1 && wrapped.size > 0.8 * PANEL_TITLE_SIZE);
        assert!(
            wrapped
                .lines
                .iter()
                .all(|line| width(line, wrapped.size, true) <= cell.width() - MARGINS)
        );
        assert!(
            wrapped
                .baselines()
                .all(|(_, y)| y > 0.0 && y < wrapped.height())
        );
    }
}
