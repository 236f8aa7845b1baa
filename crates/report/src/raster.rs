//! Conversion of an SVG document into pixels.

use crate::error::ReportError;
use crate::fonts;
use crate::theme::Rgb;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::Tree;

/// The page of a document stretched over a picture of the given width and height: its colours, row by row.
pub(crate) fn rasterized(
    document: &str,
    name: &str,
    [width, height]: [u32; 2],
) -> Result<Vec<Rgb>, ReportError> {
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
    // The page is opaque.
    let colors = pixels.data().chunks_exact(4).map(|p| [p[0], p[1], p[2]]);
    Ok(colors.collect())
}
