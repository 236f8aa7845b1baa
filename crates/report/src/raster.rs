//! From what is drawn on a canvas to pixels.

use crate::canvas::{Canvas, Drawn, FACTOR};
use crate::error::ReportError;
use crate::fonts;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg::Tree;

/// A page as SVG in fractions of a pixel, and its size in page pixels.
pub(crate) struct Vector {
    pub(crate) svg: String,
    pub(crate) width: u32,
    pub(crate) height: u32,
}

impl Vector {
    /// A page of the given width and height, drawn by `draw`. The fonts must be ready.
    pub(crate) fn drawn(
        name: &str,
        [width, height]: [u32; 2],
        draw: impl FnOnce(&mut Canvas<'_>) -> Drawn,
    ) -> Result<Self, ReportError> {
        let mut svg = String::new();
        let mut canvas = Canvas::new(&mut svg, width, height);
        let drawn = draw(&mut canvas).and_then(|()| canvas.finish());
        drawn.map_err(|reason| ReportError::Draw {
            figure: name.to_owned(),
            reason,
        })?;
        // The backend sets neither, and mitred joins make spikes of sharp turns.
        let svg = svg.replacen(
            "<svg ",
            "<svg stroke-linejoin=\"round\" stroke-linecap=\"round\" ",
            1,
        );
        Ok(Self { svg, width, height })
    }

    /// The page stretched over a picture of the given width and height.
    pub(crate) fn pixels(
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
        let scale = |to: u32, from: u32| (f64::from(to) / f64::from(from) / FACTOR) as f32;
        let stretch = Transform::from_scale(scale(width, self.width), scale(height, self.height));
        resvg::render(&tree, stretch, &mut pixels.as_mut());
        Ok(pixels)
    }
}
