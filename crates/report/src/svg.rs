//! A figure as an SVG document.

use crate::canvas::document;
use crate::error::ReportError;
use crate::figure::Figure;
use crate::png::page_of;

/// Draws the figure and returns it as an SVG document, in the layout of its [`png`](crate::png()).
///
/// Text remains text. The document names the font families and the measured width of each word, so the layout also holds with another
/// font.
///
/// # Errors
///
/// [`ReportError::Size`] if the page is too large.
pub fn svg(figure: &Figure) -> Result<String, ReportError> {
    let page = page_of(figure)?;
    let document = document(page.size(), true, None, |canvas| page.draw(canvas));
    Ok(document)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Chart;
    use crate::fonts;
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
        let root = document.lines().next().unwrap();
        assert!(root.starts_with("<svg ") && root.contains("font-family=\"DejaVu Sans, Verdana,"));
        assert!(document.contains("a &lt; b &amp; &quot;c&quot; `d` | 'e'</text>"));
        let texts = || document.lines().filter(|line| line.starts_with("<text "));
        assert!(texts().count() > 5);
        assert!(texts().all(|line| line.contains(" textLength=\"") && line.ends_with("</text>")));
    }

    #[test]
    fn the_document_is_the_page_of_the_png() {
        let figure = figure("Title");
        let [width, height] = page_of(&figure).unwrap().size();
        let tree = Tree::from_str(&svg(&figure).unwrap(), &fonts::options()).unwrap();
        let size = tree.size();
        assert_eq!([size.width(), size.height()], [width as f32, height as f32]);
        let drawn = tree.root().abs_bounding_box();
        assert!(drawn.right() <= width as f32 && drawn.bottom() <= height as f32);
    }

    #[test]
    fn any_letter_is_drawn_or_is_a_box() {
        // Characters missing from the font, without width, and control characters.
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
