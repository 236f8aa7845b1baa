//! Drawing in page pixels on plotters' SVG backend.

use crate::fonts::{self, SIZE_PER_EM};
use crate::rect::Rect;
use crate::theme::{Rgb, WHITE};
use plotters::backend::{DrawingBackend, SVGBackend};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{Color, FontTransform, RGBColor, ShapeStyle};
use std::fmt::Display;

/// Backend units in a page pixel: the backend rounds to whole units, which at 1 shows as staircases.
pub(crate) const FACTOR: f64 = 8.0;
/// The backend writes `dy="0.76em"` for text hung from its top: subtracting it leaves the baseline.
const TOP_SHIFT: f64 = 0.76;
/// Half the height of a digit, which is what looks centred beside a tick.
const HALF_CAP: f64 = 0.365;

/// Width of the white rim around letters that stand on lines.
const RIM: f64 = 2.4;

/// What a line looks like.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Line {
    pub(crate) color: Rgb,
    pub(crate) width: f64,
    pub(crate) dashed: bool,
}

impl Line {
    pub(crate) fn solid(color: Rgb, width: f64) -> Self {
        Self {
            color,
            width,
            dashed: false,
        }
    }
}

/// Which end of the text its place is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Align {
    Start,
    Middle,
    End,
}

/// What a text looks like.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Type {
    pub(crate) size: f64,
    pub(crate) bold: bool,
    pub(crate) color: Rgb,
    pub(crate) align: Align,
}

impl Type {
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

/// Result of drawing: the message of the backend if it failed.
pub(crate) type Drawn = Result<(), String>;

/// A page being drawn.
pub(crate) struct Canvas<'a> {
    backend: SVGBackend<'a>,
}

fn said(error: impl Display) -> String {
    error.to_string()
}

fn unit(v: f64) -> i32 {
    // Saturates, and takes NaN to 0: callers skip what is not finite, this only keeps a slip from spreading.
    (v * FACTOR).round() as i32
}

fn units([x, y]: [f64; 2]) -> (i32, i32) {
    (unit(x), unit(y))
}

fn style(color: Rgb, width: f64, opacity: f64) -> ShapeStyle {
    let [r, g, b] = color;
    let stroke_width = (width * FACTOR).round().max(1.0) as u32;
    ShapeStyle {
        color: RGBColor(r, g, b).mix(opacity),
        filled: false,
        stroke_width,
    }
}

impl<'a> Canvas<'a> {
    /// A page of the given size in pixels, written into `svg`.
    pub(crate) fn new(svg: &'a mut String, width: u32, height: u32) -> Self {
        let size = (
            width.saturating_mul(FACTOR as u32),
            height.saturating_mul(FACTOR as u32),
        );
        Self {
            backend: SVGBackend::with_string(svg, size),
        }
    }

    /// Ends the document.
    pub(crate) fn finish(mut self) -> Drawn {
        self.backend.present().map_err(said)
    }

    /// A line through the points.
    pub(crate) fn line(&mut self, points: &[[f64; 2]], line: Line) -> Drawn {
        if points.len() < 2 {
            return Ok(());
        }
        if line.dashed {
            for dash in crate::curve::dashes(points, 4.0 * line.width + 2.0, 2.6 * line.width + 2.0)
            {
                self.line(
                    &dash,
                    Line {
                        dashed: false,
                        ..line
                    },
                )?;
            }
            return Ok(());
        }
        let path = points.iter().copied().map(units);
        self.backend
            .draw_path(path, &style(line.color, line.width, 1.0))
            .map_err(said)
    }

    /// A filled polygon.
    pub(crate) fn polygon(&mut self, points: &[[f64; 2]], color: Rgb, opacity: f64) -> Drawn {
        let path = points.iter().copied().map(units);
        self.backend
            .fill_polygon(path, &style(color, 1.0, opacity))
            .map_err(said)
    }

    /// A filled rectangle.
    pub(crate) fn rect(&mut self, rect: &Rect, color: Rgb) -> Drawn {
        let (from, to) = (units([rect.x0, rect.y0]), units([rect.x1, rect.y1]));
        self.backend
            .draw_rect(from, to, &style(color, 1.0, 1.0), true)
            .map_err(said)
    }

    /// The edge of a rectangle.
    pub(crate) fn frame(&mut self, rect: &Rect, line: Line) -> Drawn {
        let Rect { x0, y0, x1, y1 } = *rect;
        self.line(&[[x0, y0], [x1, y0], [x1, y1], [x0, y1], [x0, y0]], line)
    }

    /// A filled disc.
    pub(crate) fn disc(&mut self, centre: [f64; 2], radius: f64, color: Rgb) -> Drawn {
        let radius = (radius * FACTOR).round().max(0.0) as u32;
        self.backend
            .draw_circle(units(centre), radius, &style(color, 1.0, 1.0), true)
            .map_err(said)
    }

    /// Text with its baseline at `y`.
    pub(crate) fn text(&mut self, text: &str, [x, y]: [f64; 2], look: Type) -> Drawn {
        self.put(
            text,
            [x, y - TOP_SHIFT * look.size],
            look,
            FontTransform::None,
        )
    }

    /// Text whose digits are centred on `y`.
    pub(crate) fn text_beside(&mut self, text: &str, [x, y]: [f64; 2], look: Type) -> Drawn {
        self.text(text, [x, y + HALF_CAP * look.size], look)
    }

    /// The same with a white rim, which keeps it legible on lines.
    pub(crate) fn text_with_rim(&mut self, text: &str, [x, y]: [f64; 2], look: Type) -> Drawn {
        for [dx, dy] in [[-RIM, -RIM], [RIM, -RIM], [-RIM, RIM], [RIM, RIM]] {
            self.text_beside(
                text,
                [x + dx, y + dy],
                Type {
                    color: WHITE,
                    ..look
                },
            )?;
        }
        self.text_beside(text, [x, y], look)
    }

    /// Text that reads upwards, with its baseline at `x`.
    pub(crate) fn text_upwards(&mut self, text: &str, [x, y]: [f64; 2], look: Type) -> Drawn {
        self.put(
            text,
            [x - TOP_SHIFT * look.size, y],
            look,
            FontTransform::Rotate270,
        )
    }

    fn put(&mut self, text: &str, at: [f64; 2], look: Type, turn: FontTransform) -> Drawn {
        // XML has no control characters; one in a name must not cost the whole page.
        let text: String = text
            .chars()
            .map(|c| if c.is_control() { ' ' } else { c })
            .collect();
        if text.trim().is_empty() {
            return Ok(());
        }
        let h_pos = match look.align {
            Align::Start => HPos::Left,
            Align::Middle => HPos::Center,
            Align::End => HPos::Right,
        };
        let [r, g, b] = look.color;
        let font = fonts::font(look.size * SIZE_PER_EM * FACTOR, look.bold).transform(turn);
        let mut style = font.color(&RGBColor(r, g, b));
        style.pos = Pos::new(h_pos, VPos::Top);
        self.backend
            .draw_text(&text, &style, units(at))
            .map_err(said)
    }
}
