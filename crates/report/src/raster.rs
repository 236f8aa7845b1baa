//! From what is drawn on a canvas to pixels.

use crate::canvas::{Canvas, UNITS_PER_PIXEL};
use crate::error::ReportError;
use crate::fonts;
use crate::layout_record::LayoutRecord;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::Tree;

/// What a page notes on its layout while it is drawn.
pub(crate) fn recorded(size: [u32; 2], draw: impl FnOnce(&mut Canvas<'_>)) -> LayoutRecord {
    let mut svg = String::new();
    let mut canvas = Canvas::recording(&mut svg, size);
    draw(&mut canvas);
    canvas
        .into_record()
        .unwrap_or_else(|| LayoutRecord::new(size))
}

/// A page as SVG in fractions of a pixel, and its size in page pixels.
pub(crate) struct SvgPicture {
    pub(crate) svg: String,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl SvgPicture {
    /// A page of the given width and height in pixels, drawn by `draw`.
    pub(crate) fn new([width, height]: [u32; 2], draw: impl FnOnce(&mut Canvas<'_>)) -> Self {
        let mut svg = String::new();
        let mut canvas = Canvas::new(&mut svg, [width, height]);
        draw(&mut canvas);
        canvas.finish();
        // The backend sets neither, and mitred joins make spikes of sharp turns.
        let round = "<svg stroke-linejoin=\"round\" stroke-linecap=\"round\" ";
        let svg = svg.replacen("<svg ", round, 1);
        Self { svg, width, height }
    }

    /// The page stretched over a picture of the given width and height.
    pub(crate) fn rasterize(
        &self,
        name: &str,
        [width, height]: [u32; 2],
    ) -> Result<Pixmap, ReportError> {
        let tree = Tree::from_str(&self.svg, &fonts::options()).map_err(|e| ReportError::Draw {
            figure: name.to_owned(),
            reason: e.to_string(),
        })?;
        let mut pixels = Pixmap::new(width, height).ok_or_else(|| ReportError::Size {
            figure: name.to_owned(),
            width,
            height,
        })?;
        let scale = |to: u32, from: u32| (f64::from(to) / f64::from(from) / UNITS_PER_PIXEL) as f32;
        let stretch = Transform::from_scale(scale(width, self.width), scale(height, self.height));
        resvg::render(&tree, stretch, &mut pixels.as_mut());
        Ok(pixels)
    }
}
