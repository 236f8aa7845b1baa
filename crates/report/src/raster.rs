//! From an SVG document to pixels.

use crate::error::ReportError;
use crate::fonts;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::Tree;

/// The page of a document stretched over a picture of the given width and height.
pub(crate) fn rasterized(
    document: &str,
    name: &str,
    [width, height]: [u32; 2],
) -> Result<Pixmap, ReportError> {
    let tree = Tree::from_str(document, &fonts::options()).map_err(|e| ReportError::Draw {
        figure: name.to_owned(),
        reason: e.to_string(),
    })?;
    let mut pixels = Pixmap::new(width, height).ok_or_else(|| ReportError::Size {
        figure: name.to_owned(),
        width,
        height,
    })?;
    let (x, y) = (tree.size().width(), tree.size().height());
    let stretch = Transform::from_scale(width as f32 / x, height as f32 / y);
    resvg::render(&tree, stretch, &mut pixels.as_mut());
    Ok(pixels)
}
