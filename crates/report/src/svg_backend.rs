//! The backend of plotters that writes an SVG document.

use crate::fonts::{self, FAMILY};
use crate::html::escaped;
use plotters::coord::CoordTranslate;
use plotters_backend::text_anchor::HPos;
use plotters_backend::{
    BackendColor, BackendCoord, BackendStyle, BackendTextStyle, DrawingBackend, DrawingErrorKind,
    FontStyle, FontTransform,
};
use std::convert::Infallible;
use std::fmt::{Arguments, Write as _};

/// Units of the document in a page pixel: plotters counts in whole units, which at 1 would show as staircases.
pub(crate) const UNITS_PER_PIXEL: f64 = 8.0;
/// Em from the top of tall letters, which is where plotters puts a text, down to the baseline.
pub(crate) const ASCENT: f64 = 0.76;
/// Height of a line in em: what plotters calls the size of a font.
pub(crate) const LINE: f64 = 1.24;
/// The fallback font, with letters of nearly equal widths.
const FALLBACK: &str = "Verdana, sans-serif";

/// The coordinates of a page: pixels from its upper left corner.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PagePixels;

impl PagePixels {
    /// A length in units. Saturates, and takes NaN to 0: callers skip what is not finite, this only limits the effect of a mistake.
    pub(crate) fn to_units(length: f64) -> i32 {
        (length * UNITS_PER_PIXEL).round() as i32
    }
}

impl CoordTranslate for PagePixels {
    type From = [f64; 2];

    fn translate(&self, [x, y]: &[f64; 2]) -> BackendCoord {
        (Self::to_units(*x), Self::to_units(*y))
    }
}

/// Writes a page into a string, which cannot fail.
pub(crate) struct SvgBackend<'a> {
    document: &'a mut String,
    size: (u32, u32),
    /// Whether the document contains the widths of its words, for readers with another font.
    measured: bool,
}

type Written = Result<(), DrawingErrorKind<Infallible>>;

/// The paint of a shape: filled, or its outline.
fn paint(style: &impl BackendStyle, fill: bool) -> String {
    let (BackendColor { alpha, rgb }, width) = (style.color(), style.stroke_width());
    let color = format!("#{:02X}{:02X}{:02X}", rgb.0, rgb.1, rgb.2);
    let paint = if fill {
        format!("fill=\"{color}\"")
    } else {
        format!("fill=\"none\" stroke=\"{color}\" stroke-width=\"{width}\"")
    };
    if alpha < 1.0 {
        paint + &format!(" opacity=\"{alpha}\"")
    } else {
        paint
    }
}

impl<'a> SvgBackend<'a> {
    /// A page of the given size in pixels.
    pub(crate) fn new(document: &'a mut String, [width, height]: [u32; 2], measured: bool) -> Self {
        let units = |side: u32| side.saturating_mul(UNITS_PER_PIXEL as u32);
        let size = (units(width), units(height));
        // Mitred joins make spikes of sharp turns.
        let _ = writeln!(
            document,
            "<svg stroke-linejoin=\"round\" stroke-linecap=\"round\" font-family=\"{FAMILY}, {FALLBACK}\" width=\"{width}\" \
             height=\"{height}\" viewBox=\"0 0 {} {}\" xmlns=\"http://www.w3.org/2000/svg\">",
            size.0, size.1
        );
        Self {
            document,
            size,
            measured,
        }
    }

    fn write(&mut self, text: Arguments<'_>) -> Written {
        let _ = self.document.write_fmt(text);
        Ok(())
    }

    /// An element with a list of points.
    fn points(
        &mut self,
        element: Arguments<'_>,
        points: impl IntoIterator<Item = BackendCoord>,
    ) -> Written {
        self.write(format_args!("<{element} points=\""))?;
        for (x, y) in points {
            self.write(format_args!("{x},{y} "))?;
        }
        self.write(format_args!("\"/>\n"))
    }
}

impl DrawingBackend for SvgBackend<'_> {
    type ErrorType = Infallible;

    fn get_size(&self) -> (u32, u32) {
        self.size
    }

    fn ensure_prepared(&mut self) -> Written {
        Ok(())
    }

    fn present(&mut self) -> Written {
        self.write(format_args!("</svg>\n"))
    }

    fn draw_pixel(&mut self, (x, y): BackendCoord, color: BackendColor) -> Written {
        self.draw_rect((x, y), (x + 1, y + 1), &color, true)
    }

    fn draw_rect<S: BackendStyle>(
        &mut self,
        (x0, y0): BackendCoord,
        (x1, y1): BackendCoord,
        style: &S,
        fill: bool,
    ) -> Written {
        let (width, height, paint) = (x1 - x0, y1 - y0, paint(style, fill));
        self.write(format_args!(
            "<rect x=\"{x0}\" y=\"{y0}\" width=\"{width}\" height=\"{height}\" {paint}/>\n"
        ))
    }

    fn draw_path<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        path: I,
        style: &S,
    ) -> Written {
        self.points(format_args!("polyline {}", paint(style, false)), path)
    }

    fn draw_circle<S: BackendStyle>(
        &mut self,
        (x, y): BackendCoord,
        radius: u32,
        style: &S,
        fill: bool,
    ) -> Written {
        let paint = paint(style, fill);
        self.write(format_args!(
            "<circle cx=\"{x}\" cy=\"{y}\" r=\"{radius}\" {paint}/>\n"
        ))
    }

    fn fill_polygon<S: BackendStyle, I: IntoIterator<Item = BackendCoord>>(
        &mut self,
        corners: I,
        style: &S,
    ) -> Written {
        self.points(format_args!("polygon {}", paint(style, true)), corners)
    }

    /// Every text hangs from its top.
    fn draw_text<S: BackendTextStyle>(
        &mut self,
        text: &str,
        style: &S,
        (x, y): BackendCoord,
    ) -> Written {
        let (size, weight) = (style.size() / LINE, style.style());
        let anchor = match style.anchor().h_pos {
            HPos::Left => "start",
            HPos::Center => "middle",
            HPos::Right => "end",
        };
        self.write(format_args!(
            "<text x=\"{x}\" y=\"{y}\" dy=\"{ASCENT}em\" text-anchor=\"{anchor}\" font-size=\"{}\" font-weight=\"{}\" {}",
            size as f32,
            weight.as_str(),
            paint(&style.color(), true)
        ))?;
        if self.measured {
            let length = fonts::width(text, size, matches!(weight, FontStyle::Bold));
            self.write(format_args!(" textLength=\"{length:.1}\""))?;
        }
        if matches!(style.transform(), FontTransform::Rotate270) {
            self.write(format_args!(" transform=\"rotate(270, {x}, {y})\""))?;
        }
        self.write(format_args!(">{}</text>\n", escaped(text)))
    }
}
