//! The embedded fonts: one pair of files for measuring (plotters) and for drawing (resvg).

use crate::error::ReportError;
use plotters::style::{FontDesc, FontFamily, FontStyle, register_font};
use resvg::usvg::{Options, fontdb::Database};
use std::sync::{Arc, LazyLock};

/// The family both sides know the fonts by.
pub(crate) const FAMILY: &str = "DejaVu Sans";

static REGULAR: &[u8] = include_bytes!("../assets/DejaVuSans.ttf");
static BOLD: &[u8] = include_bytes!("../assets/DejaVuSans-Bold.ttf");

/// plotters writes `font-size = size / 1.24` into SVG …
pub(crate) const SIZE_PER_EM: f64 = 1.24;
/// … but measures advances at `size / (ascent − descent)`, which is 2384/2048 of an em in DejaVu Sans.
const HEIGHT_PER_EM: f64 = 2384.0 / 2048.0;
/// Text is measured large because plotters rounds the width to whole pixels.
const MEASURING: f64 = 1000.0;

static REGISTERED: LazyLock<bool> = LazyLock::new(|| {
    register_font(FAMILY, FontStyle::Normal, REGULAR).is_ok()
        && register_font(FAMILY, FontStyle::Bold, BOLD).is_ok()
});

static DATABASE: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut database = Database::new();
    database.load_font_data(REGULAR.to_vec());
    database.load_font_data(BOLD.to_vec());
    Arc::new(database)
});

/// Makes the fonts known to plotters, once.
pub(crate) fn ready() -> Result<(), ReportError> {
    if *REGISTERED {
        Ok(())
    } else {
        Err(ReportError::Font { face: FAMILY })
    }
}

/// What resvg needs to read a page.
pub(crate) fn options() -> Options<'static> {
    Options {
        font_family: FAMILY.to_owned(),
        fontdb: Arc::clone(&DATABASE),
        ..Options::default()
    }
}

/// Regular or bold face at a size in pixels per em.
pub(crate) fn font(size: f64, bold: bool) -> FontDesc<'static> {
    let style = if bold {
        FontStyle::Bold
    } else {
        FontStyle::Normal
    };
    FontDesc::new(FontFamily::Name(FAMILY), size, style)
}

/// Width of the text in pixels, at a size in pixels per em.
pub(crate) fn width(text: &str, size: f64, bold: bool) -> f64 {
    // The error is a font that is not registered: the caller has been told by `ready`.
    let (wide, _) = font(MEASURING * HEIGHT_PER_EM, bold)
        .box_size(text)
        .unwrap_or_default();
    f64::from(wide) * size / MEASURING
}

/// The text broken at plain blanks into lines no wider than `room`; `\n` always breaks, a no-break space never.
pub(crate) fn wrapped(text: &str, size: f64, bold: bool, room: f64) -> Vec<String> {
    let mut lines = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split_ascii_whitespace() {
            let longer = if line.is_empty() {
                word.to_owned()
            } else {
                format!("{line} {word}")
            };
            if line.is_empty() || width(&longer, size, bold) <= room {
                line = longer;
            } else {
                lines.push(std::mem::replace(&mut line, word.to_owned()));
            }
        }
        if !line.is_empty() {
            lines.push(line);
        }
    }
    lines
}

/// The same, but a word that is too wide is broken too: after a mark such as a hyphen if there is one, else anywhere.
pub(crate) fn broken(text: &str, size: f64, bold: bool, room: f64) -> Vec<String> {
    let mut lines = Vec::new();
    for line in wrapped(text, size, bold, room) {
        let mut rest = line.as_str();
        while width(rest, size, bold) > room {
            let ends = rest.char_indices().map(|(at, c)| (at + c.len_utf8(), c));
            let fits = |end: &(usize, char)| width(&rest[..end.0], size, bold) <= room;
            let fitting: Vec<(usize, char)> = ends.take_while(fits).collect();
            let marked = fitting.iter().rfind(|(_, c)| "-_/.,:=·".contains(*c));
            // A room too narrow for a letter still gets one.
            let first = rest.chars().next().map_or(rest.len(), char::len_utf8);
            let end = marked.or(fitting.last()).map_or(first, |(end, _)| *end);
            if end >= rest.len() {
                break;
            }
            lines.push(rest[..end].to_owned());
            rest = &rest[end..];
        }
        lines.push(rest.to_owned());
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use resvg::usvg::Tree;

    #[test]
    fn text_measures_as_it_is_drawn() {
        ready().unwrap();
        for (text, bold) in [
            ("crank angle φ\u{2002}(°)", false),
            ("10⁻¹² kg·m²", false),
            ("Work and precision", true),
        ] {
            let weight = if bold { "bold" } else { "normal" };
            let svg = format!(
                "<svg width=\"2000\" height=\"200\" xmlns=\"http://www.w3.org/2000/svg\"><text x=\"0\" y=\"100\" \
                 font-family=\"{FAMILY}\" font-size=\"100\" font-weight=\"{weight}\">{text}</text></svg>"
            );
            let tree = Tree::from_str(&svg, &options()).unwrap();
            let drawn = f64::from(tree.root().bounding_box().width());
            let measured = width(text, 100.0, bold);
            assert!(
                (drawn - measured).abs() < 0.02 * drawn,
                "{text}: drawn {drawn}, measured {measured}"
            );
        }
    }

    #[test]
    fn wrapped_lines_fit_and_lose_no_word() {
        ready().unwrap();
        let text = "One line of words that is certainly longer than the room it has been given\nand a second paragraph";
        let lines = wrapped(text, 27.0, false, 400.0);
        assert!(lines.len() > 2);
        assert!(lines.iter().all(|line| width(line, 27.0, false) <= 400.0));
        assert_eq!(lines.join(" "), text.replace('\n', " "));
    }

    #[test]
    fn long_words_are_broken_after_a_mark_and_lose_no_letter() {
        ready().unwrap();
        let text = "reaction-of-the-second-joint φφφφφφφφφφφφφφφφφφφφφφ";
        let lines = broken(text, 27.0, false, 200.0);
        assert!(lines.iter().all(|line| width(line, 27.0, false) <= 200.0));
        assert!(lines[0].ends_with('-'), "{lines:?}");
        assert_eq!(lines.concat(), text.replace(' ', ""));
        assert_eq!(broken("abc", 27.0, false, 1.0), ["a", "b", "c"]);
    }
}
