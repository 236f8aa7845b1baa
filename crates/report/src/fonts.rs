//! The embedded fonts, for measuring (ttf-parser) and for drawing (resvg).

use resvg::usvg::{Options, fontdb::Database};
use std::sync::{Arc, LazyLock};
use ttf_parser::{Face, GlyphId};

/// The family in the SVG and in the database.
pub(crate) const FAMILY: &str = "DejaVu Sans";

static REGULAR: &[u8] = include_bytes!("../assets/DejaVuSans.ttf");
static BOLD: &[u8] = include_bytes!("../assets/DejaVuSans-Bold.ttf");

/// Regular and bold, for measuring.
static FACES: LazyLock<[Option<Face<'static>>; 2]> =
    LazyLock::new(|| [REGULAR, BOLD].map(|font| Face::parse(font, 0).ok()));

static DATABASE: LazyLock<Arc<Database>> = LazyLock::new(|| {
    let mut database = Database::new();
    database.load_font_data(REGULAR.to_vec());
    database.load_font_data(BOLD.to_vec());
    Arc::new(database)
});

/// What resvg needs to read a page.
pub(crate) fn options() -> Options<'static> {
    Options {
        font_family: FAMILY.to_owned(),
        fontdb: Arc::clone(&DATABASE),
        ..Options::default()
    }
}

/// Replaces characters that the fonts lack.
const MISSING: char = '□';

/// The drawn character: a box for characters missing from the fonts, and a blank for control characters.
pub(crate) fn drawable(c: char) -> char {
    if c.is_control() {
        return ' ';
    }
    let has = |face: &Option<Face<'_>>| {
        let face = face.as_ref();
        face.is_some_and(|face| face.glyph_index(c).is_some())
    };
    if FACES.iter().all(has) { c } else { MISSING }
}

/// Width of the text in pixels, at a size in pixels per em: the advances of its glyphs and the kerning between them.
pub(crate) fn width(text: &str, size: f64, bold: bool) -> f64 {
    // The embedded fonts can be read: a test measures with both.
    let Some(face) = &FACES[usize::from(bold)] else {
        return 0.0;
    };
    let mut units = 0_i64;
    let mut previous = None;
    for c in text.chars().map(drawable) {
        let glyph = face.glyph_index(c).unwrap_or_default();
        units += i64::from(face.glyph_hor_advance(glyph).unwrap_or_default());
        units += previous.map_or(0, |previous| i64::from(kerning(face, previous, glyph)));
        previous = Some(glyph);
    }
    units as f64 * size / f64::from(face.units_per_em())
}

/// Width of the widest text in pixels; 0 if there is none.
pub(crate) fn widest(
    texts: impl IntoIterator<Item = impl AsRef<str>>,
    size: f64,
    bold: bool,
) -> f64 {
    let widths = texts
        .into_iter()
        .map(|text| width(text.as_ref(), size, bold));
    widths.fold(0.0, f64::max)
}

/// Font units by which two neighbouring glyphs move apart.
fn kerning(face: &Face<'_>, left: GlyphId, right: GlyphId) -> i16 {
    let tables = face
        .tables()
        .kern
        .into_iter()
        .flat_map(|kern| kern.subtables);
    let mut horizontal = tables.filter(|table| table.horizontal && !table.variable);
    let found = horizontal.find_map(|table| table.glyphs_kerning(left, right));
    found.unwrap_or_default()
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

/// As [`wrapped`], but words that are too wide are broken, too: after a mark such as a hyphen if there is one, otherwise anywhere.
pub(crate) fn wrapped_anywhere(text: &str, size: f64, bold: bool, room: f64) -> Vec<String> {
    let mut lines = Vec::new();
    for line in wrapped(text, size, bold, room) {
        let mut rest = line.as_str();
        while width(rest, size, bold) > room {
            let ends = rest.char_indices().map(|(at, c)| (at + c.len_utf8(), c));
            let fits = |end: &(usize, char)| width(&rest[..end.0], size, bold) <= room;
            let fitting: Vec<(usize, char)> = ends.take_while(fits).collect();
            let after_mark = fitting.iter().rfind(|(_, c)| "-_/.,:=·".contains(*c));
            // A room too narrow for a letter still gets one.
            let first = rest.chars().next().map_or(rest.len(), char::len_utf8);
            let end = after_mark.or(fitting.last()).map_or(first, |(end, _)| *end);
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
        let text = "One line of words that is certainly longer than the room it has been given\nand a second paragraph";
        let lines = wrapped(text, 27.0, false, 400.0);
        assert!(lines.len() > 2);
        assert!(lines.iter().all(|line| width(line, 27.0, false) <= 400.0));
        assert_eq!(lines.join(" "), text.replace('\n', " "));
    }

    #[test]
    fn long_words_are_broken_after_a_mark_and_lose_no_letter() {
        let text = "reaction-of-the-second-joint φφφφφφφφφφφφφφφφφφφφφφ";
        let lines = wrapped_anywhere(text, 27.0, false, 200.0);
        assert!(lines.iter().all(|line| width(line, 27.0, false) <= 200.0));
        assert!(lines[0].ends_with('-'), "{lines:?}");
        assert_eq!(lines.concat(), text.replace(' ', ""));
        assert_eq!(wrapped_anywhere("abc", 27.0, false, 1.0), ["a", "b", "c"]);
    }
}
