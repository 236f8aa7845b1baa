//! A figure as an SVG document: lines as lines, words as words.

use crate::error::ReportError;
use crate::figure::Figure;
use crate::fonts::{self, FAMILY};
use crate::png::svg_picture;
use crate::raster::SvgPicture;

/// What readers without the font use instead: letters of nearly the same widths.
const FALLBACK: &str = "Verdana, sans-serif";

/// Draws the figure and returns it as an SVG document, in the layout of its [`png`](crate::png()).
///
/// Words stay words. Each names its font family and the length it was measured at, which a reader with another font keeps to.
///
/// # Errors
///
/// [`ReportError::Size`] if the page is too large.
pub fn svg(figure: &Figure) -> Result<String, ReportError> {
    let SvgPicture { svg, width, height } = svg_picture(figure)?;
    let mut document = String::with_capacity(svg.len() + svg.len() / 8);
    let mut lines = svg.lines();
    while let Some(line) = lines.next() {
        if let Some((head, tail)) = line.split_once("viewBox=").filter(|_| document.is_empty()) {
            // The backend counts in fractions of a pixel; the page has its size in pixels.
            let rounded = head.split_once("width=").map_or(head, |(before, _)| before);
            document += &format!("{rounded}width=\"{width}\" height=\"{height}\" viewBox={tail}");
        } else if let Some(tag) = line.strip_prefix("<text ") {
            let words = lines.next().unwrap_or_default();
            document += &text(tag, words);
            // Its closing tag.
            document += lines.next().unwrap_or_default();
        } else {
            document += line;
        }
        document.push('\n');
    }
    Ok(document)
}

/// The opening tag with the length of the words, and the words.
fn text(tag: &str, words: &str) -> String {
    let attribute = |name: &str| {
        let (_, value) = tag.split_once(&format!("{name}=\""))?;
        value.split('"').next()
    };
    let size = attribute("font-size").and_then(|size| size.parse().ok());
    let bold = attribute("font-weight").is_some();
    let length = fonts::width(&unescaped(words), size.unwrap_or(0.0), bold);
    let family = format!("font-family=\"{FAMILY}\"");
    let families = format!("font-family=\"{FAMILY}, {FALLBACK}\" textLength=\"{length:.1}\"");
    format!("<text {}{words}", tag.replace(&family, &families))
}

/// The words that an XML text stands for.
fn unescaped(text: &str) -> String {
    const ENTITIES: [(&str, &str); 5] = [
        ("&lt;", "<"),
        ("&gt;", ">"),
        ("&quot;", "\""),
        ("&apos;", "'"),
        ("&amp;", "&"),
    ];
    let replace = |text: String, (entity, letter): (&str, &str)| text.replace(entity, letter);
    ENTITIES.into_iter().fold(text.to_owned(), replace)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Chart;
    use resvg::usvg::Tree;

    fn figure(title: &str) -> Figure {
        Figure {
            title: title.to_owned(),
            panels: vec![Chart::default().into()],
            ..Figure::default()
        }
    }

    #[test]
    fn words_are_words_with_a_family_and_their_measured_length() {
        let title = "a < b & \"c\" `d` | 'e'";
        let document = svg(&figure(title)).unwrap();
        assert!(document.starts_with("<svg "));
        assert!(document.contains("a &lt; b &amp; &quot;c&quot; `d` | &apos;e&apos;</text>"));
        let texts = || document.lines().filter(|line| line.starts_with("<text "));
        assert!(texts().count() > 5);
        let complete = |line: &str| {
            line.contains("font-family=\"DejaVu Sans, Verdana, sans-serif\" textLength=\"")
                && line.ends_with("</text>")
        };
        assert!(texts().all(complete));
    }

    #[test]
    fn the_document_is_the_page_of_the_png() {
        let SvgPicture { width, height, .. } = svg_picture(&figure("Title")).unwrap();
        let tree = Tree::from_str(&svg(&figure("Title")).unwrap(), &fonts::options()).unwrap();
        let size = tree.size();
        assert_eq!([size.width(), size.height()], [width as f32, height as f32]);
        let drawn = tree.root().abs_bounding_box();
        assert!(drawn.right() <= width as f32 && drawn.bottom() <= height as f32);
    }

    #[test]
    fn any_letter_is_drawn_or_is_a_box() {
        // What the font lacks, what has no width, what is no letter at all.
        for title in [
            "漢字 🚀",
            "e\u{301}\u{200b}\u{fe0f}",
            "\u{0}\u{1b}[0m\u{fffe}\n\t",
            "שלום",
            "𝔸\u{10ffff}",
        ] {
            let document = svg(&figure(title)).unwrap();
            Tree::from_str(&document, &fonts::options()).unwrap();
            crate::png(&figure(title)).unwrap();
        }
        let document = svg(&figure("漢字 🚀 ok")).unwrap();
        assert!(document.contains(">□□ □ ok</text>"), "{document}");
    }
}
