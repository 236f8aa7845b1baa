//! Drawing in page pixels with elements of plotters.

use crate::curve::dashes;
use crate::dash::Dash;
use crate::fonts::{self, FAMILY};
use crate::layout_record::{Layout, LayoutRecord};
use crate::rect::Rect;
use crate::svg_backend::{ASCENT, LINE, PagePixels, SvgBackend, UNITS_PER_PIXEL};
use crate::theme::{Rgb, WHITE};
use plotters::drawing::{DrawingArea, IntoDrawingArea as _};
use plotters::element::{Circle, PathElement, Polygon, Rectangle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{
    Color, FontDesc, FontFamily, FontStyle, FontTransform, RGBColor, ShapeStyle,
};

/// Half the height of a digit, which is what looks centred beside a tick.
const HALF_DIGIT_HEIGHT: f64 = 0.365;

/// Width of the white rim around letters that stand on lines.
const HALO_WIDTH: f64 = 2.4;

/// The style of a line.
#[derive(Debug, Clone, Copy)]
pub(crate) struct LineStyle {
    pub(crate) color: Rgb,
    pub(crate) width: f64,
    /// None for a solid line.
    pub(crate) dash: Option<Dash>,
}

impl LineStyle {
    pub(crate) fn solid(color: Rgb, width: f64) -> Self {
        Self {
            color,
            width,
            dash: None,
        }
    }

    /// The style for a sample line of a given length.
    pub(crate) fn sample(self, length: f64) -> Self {
        let dash = self.dash.map(|dash| dash.within(length));
        Self { dash, ..self }
    }
}

/// Which end of the text is at its position.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    Start,
    Middle,
    End,
}

/// The style of a text.
#[derive(Debug, Clone, Copy)]
pub(crate) struct TextStyle {
    pub(crate) size: f64,
    pub(crate) bold: bool,
    pub(crate) color: Rgb,
    pub(crate) align: Align,
}

impl TextStyle {
    pub(crate) fn new(size: f64, color: Rgb, align: Align) -> Self {
        Self {
            size,
            bold: false,
            color,
            align,
        }
    }

    pub(crate) fn bold(self) -> Self {
        Self { bold: true, ..self }
    }
}

/// A page being drawn. The backend writes into a string, which cannot fail, so its results are dropped.
pub(crate) struct Canvas<'a> {
    page: DrawingArea<SvgBackend<'a>, PagePixels>,
    record: Option<&'a mut LayoutRecord>,
}

fn filled([r, g, b]: Rgb, opacity: f64) -> ShapeStyle {
    RGBColor(r, g, b).mix(opacity).filled()
}

/// The box of a text by its baseline, from the tops of tall letters to the feet of those that hang down.
fn text_area(text: &str, [x, y]: [f64; 2], style: TextStyle) -> Rect {
    let width = fonts::width(text, style.size, style.bold);
    let left = match style.align {
        Align::Start => x,
        Align::Middle => x - 0.5 * width,
        Align::End => x - width,
    };
    Rect::sized(left, y - ASCENT * style.size, width, style.size)
}

/// A page of the given size in pixels, drawn by `draw`, as an SVG document; with the lengths of its words if they are `measured`, and
/// with notes on its layout, if there is a record.
pub(crate) fn document(
    size: [u32; 2],
    measured: bool,
    record: Option<&mut LayoutRecord>,
    draw: impl FnOnce(&mut Canvas<'_>),
) -> String {
    let mut document = String::new();
    let backend = SvgBackend::new(&mut document, size, measured);
    let page = backend.into_drawing_area().apply_coord_spec(PagePixels);
    let mut canvas = Canvas { page, record };
    draw(&mut canvas);
    let _ = canvas.page.present();
    document
}

/// The layout of such a page.
pub(crate) fn layout(size: [u32; 2], draw: impl FnOnce(&mut Canvas<'_>)) -> Layout {
    let mut record = LayoutRecord::new(size);
    document(size, false, Some(&mut record), draw);
    record.finished()
}

impl Canvas<'_> {
    /// A note on the layout, if it is recorded.
    pub(crate) fn note(&mut self, note: impl FnOnce(&mut LayoutRecord)) {
        if let Some(record) = &mut self.record {
            note(record);
        }
    }

    /// A line through the points.
    pub(crate) fn line(&mut self, points: &[[f64; 2]], line: LineStyle) {
        if points.len() < 2 {
            return;
        }
        if let Some(dash) = line.dash {
            let solid = LineStyle::solid(line.color, line.width);
            let dashes = dashes(points, dash);
            return dashes.iter().for_each(|dash| self.line(dash, solid));
        }
        self.note(|record| record.ink.line(points, line.width));
        let ([r, g, b], width) = (line.color, PagePixels::to_units(line.width).max(1));
        let style = RGBColor(r, g, b).stroke_width(width as u32);
        let _ = self.page.draw(&PathElement::new(points, style));
    }

    /// A filled polygon.
    pub(crate) fn polygon(&mut self, points: &[[f64; 2]], color: Rgb, opacity: f64) {
        // Transparent shapes hide nothing.
        if opacity >= 1.0 {
            self.note(|record| record.ink.polygon(points));
        }
        let _ = self
            .page
            .draw(&Polygon::new(points, filled(color, opacity)));
    }

    /// A filled rectangle.
    pub(crate) fn rect(&mut self, rect: &Rect, color: Rgb) {
        self.note(|record| record.ink.block(rect));
        let corners = [[rect.x0, rect.y0], [rect.x1, rect.y1]];
        let _ = self.page.draw(&Rectangle::new(corners, filled(color, 1.0)));
    }

    /// The edge of a rectangle.
    pub(crate) fn rect_outline(&mut self, rect: &Rect, line: LineStyle) {
        let Rect { x0, y0, x1, y1 } = *rect;
        self.line(&[[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]], line);
    }

    /// A filled disc.
    pub(crate) fn disc(&mut self, centre: [f64; 2], radius: f64, color: Rgb) {
        self.note(|record| record.ink.block(&Rect::around(centre, radius)));
        let (radius, style) = (PagePixels::to_units(radius), filled(color, 1.0));
        let _ = self.page.draw(&Circle::new(centre, radius, style));
    }

    /// Text with its baseline at `y`.
    pub(crate) fn text(&mut self, text: &str, at: [f64; 2], style: TextStyle) {
        self.note(|record| record.label(text, text_area(text, at, style)));
        self.put(text, at, style, false);
    }

    /// Text whose digits are centred on `y`.
    pub(crate) fn text_centred(&mut self, text: &str, [x, y]: [f64; 2], style: TextStyle) {
        self.text(text, [x, y + HALF_DIGIT_HEIGHT * style.size], style);
    }

    /// The same with a white rim, which keeps it legible on lines.
    pub(crate) fn text_with_halo(&mut self, text: &str, [x, y]: [f64; 2], style: TextStyle) {
        let rim = TextStyle {
            color: WHITE,
            ..style
        };
        for dy in [-HALO_WIDTH, HALO_WIDTH] {
            for dx in [-HALO_WIDTH, HALO_WIDTH] {
                let at = [x + dx, y + dy + HALF_DIGIT_HEIGHT * style.size];
                self.put(text, at, rim, false);
            }
        }
        self.text_centred(text, [x, y], style);
    }

    /// Text that reads upwards, with its baseline at `x`.
    pub(crate) fn text_upwards(&mut self, text: &str, [x, y]: [f64; 2], style: TextStyle) {
        self.note(|record| {
            // Turned by a quarter: along the page's y, against its direction.
            let Rect { x0, y0, x1, y1 } = text_area(text, [0.0; 2], style);
            let area = Rect {
                x0: x + y0,
                y0: y - x1,
                x1: x + y1,
                y1: y - x0,
            };
            record.label(text, area);
        });
        self.put(text, [x, y], style, true);
    }

    /// Text with its baseline at `y`, or at `x` if it reads upwards. It hangs from its top.
    fn put(&mut self, text: &str, [x, y]: [f64; 2], style: TextStyle, upwards: bool) {
        // XML allows no control characters, and one in a name must not invalidate the page. Characters missing from the font appear as boxes.
        let text: String = text.chars().map(fonts::drawable).collect();
        if text.trim().is_empty() {
            return;
        }
        let h_pos = match style.align {
            Align::Start => HPos::Left,
            Align::Middle => HPos::Center,
            Align::End => HPos::Right,
        };
        let weight = if style.bold {
            FontStyle::Bold
        } else {
            FontStyle::Normal
        };
        let size = style.size * LINE * UNITS_PER_PIXEL;
        let [r, g, b] = style.color;
        let font = FontDesc::new(FontFamily::Name(FAMILY), size, weight);
        let ascent = ASCENT * style.size;
        let (at, turn) = if upwards {
            ([x - ascent, y], FontTransform::Rotate270)
        } else {
            ([x, y - ascent], FontTransform::None)
        };
        let style = font
            .transform(turn)
            .color(&RGBColor(r, g, b))
            .pos(Pos::new(h_pos, VPos::Top));
        let _ = self.page.draw(&Text::new(text, at, style));
    }
}
