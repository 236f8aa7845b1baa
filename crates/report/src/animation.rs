//! Drawings as an animated GIF.

use crate::canvas::{Align, Canvas, TextStyle, document, layout};
use crate::drawing::{self, DrawingLayout};
use crate::error::ReportError;
use crate::fonts;
use crate::layout_record::Layout;
use crate::palette::{Palette, counts};
use crate::raster::rasterized;
use crate::rect::Rect;
use crate::shape::Drawing;
use crate::theme::{CAPTION_GREY, Rgb, WHITE};
use crate::typeset::typeset;
use gif::{DisposalMethod, Encoder, EncodingError, Frame, Repeat};
use std::borrow::Cow;

/// Width of the drawn page, independent of the size of the picture, so that the height of letters is
/// always a thirtieth of it.
const PAGE_WIDTH: f64 = 800.0;
/// Around the drawing.
const MARGIN: f64 = 18.0;
/// Size of the letters at the foot, and the distance of their baselines in sizes.
const FOOTER_SIZE: f64 = 15.0;
const LEADING: f64 = 1.3;
/// Maximum number of pixels of all frames, which are in memory at three bytes each.
const MAX_PIXELS: u64 = 1 << 27;
/// Maximum number of colours, without the one for unchanged pixels.
const MAX_COLORS: usize = 255;
/// Smallest delay in hundredths of a second: browsers replace shorter ones by a tenth of a second.
const MIN_DELAY: u32 = 2;

/// Drawings at successive times, such as a mechanism over one revolution.
///
/// All frames have one extent, that of all their shapes and ranges, and share one legend, so that
/// only the shapes move. The title of a frame may state its time or angle. The animation repeats
/// forever; for a whole revolution omit the last position, which equals the first.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Animation {
    /// File stem, without folder and extension.
    pub name: String,
    /// The frames in their order.
    pub frames: Vec<Drawing>,
    /// Display time of a frame, ms; a GIF has steps of 10 ms, and not all viewers show less than 20 ms.
    pub delay_ms: u32,
    /// Width of the picture in pixels; the height follows from the drawings.
    pub width_px: u32,
    /// Provenance, as in [`Figure::provenance`](crate::Figure::provenance).
    pub provenance: String,
}

impl Animation {
    /// Draws the frames and returns them as a GIF: one palette of at most 255 colours, and of each frame only the pixels that change.
    ///
    /// # Errors
    ///
    /// [`ReportError::NoFrames`]; [`ReportError::AnimationSize`] if the frames have no area, a side of more than 65 535 pixels or
    /// more than 134 million pixels together; [`ReportError::Draw`] and [`ReportError::Encode`] if
    /// a library fails, which no data should cause.
    pub fn gif(&self) -> Result<Vec<u8>, ReportError> {
        let pictures = self.pictures()?;
        let frames = pictures.frames.iter().map(Vec::as_slice);
        let palette = Palette::of(&counts(frames), MAX_COLORS);
        encoded(&pictures, &palette, self.delay()).map_err(|e| ReportError::Encode {
            figure: self.name.clone(),
            reason: e.to_string(),
        })
    }

    /// Hundredths of a second.
    fn delay(&self) -> u16 {
        let hundredths = self.delay_ms.saturating_add(5) / 10;
        u16::try_from(hundredths.max(MIN_DELAY)).unwrap_or(u16::MAX)
    }

    fn pictures(&self) -> Result<Pictures, ReportError> {
        let page = self.page()?;
        let size = self.size(page.size)?;
        let picture = |drawing: &Drawing| {
            let document = document(page.size, false, None, |canvas| page.draw(canvas, drawing));
            rasterized(&document, &self.name, size.map(u32::from))
        };
        let frames = self
            .frames
            .iter()
            .map(picture)
            .collect::<Result<_, ReportError>>()?;
        Ok(Pictures { size, frames })
    }

    /// The layout of every frame.
    pub(crate) fn layouts(&self) -> Result<Vec<Layout>, ReportError> {
        let page = self.page()?;
        let layout = |drawing| layout(page.size, |canvas| page.draw(canvas, drawing));
        Ok(self.frames.iter().map(layout).collect())
    }

    fn page(&self) -> Result<FramePage, ReportError> {
        if self.frames.is_empty() {
            return Err(ReportError::NoFrames {
                animation: self.name.clone(),
            });
        }
        let (cell, layout) = self.layout();
        let footer = fonts::wrapped(&typeset(&self.provenance), FOOTER_SIZE, false, cell.width());
        let lowest = cell.y1 + LEADING * FOOTER_SIZE * footer.len() as f64;
        Ok(FramePage {
            size: [PAGE_WIDTH, (lowest + MARGIN).ceil()].map(|side| side as u32),
            cell,
            layout,
            footer,
        })
    }

    /// The cell of all frames, and what they share.
    fn layout(&self) -> (Rect, DrawingLayout) {
        let inner = PAGE_WIDTH - 2.0 * MARGIN;
        let in_cell = |height: f64| {
            let cell = Rect::sized(MARGIN, MARGIN, inner, height);
            let insets = drawing::insets(&self.frames, &cell);
            (cell, DrawingLayout::new(&self.frames, &cell, insets))
        };
        let height = drawing::height(&self.frames, inner);
        let (cell, layout) = in_cell(height);
        // The page grows with its legend, because there are no neighbours to align with.
        match layout.legend_above() {
            0.0 => (cell, layout),
            more => in_cell(height + more),
        }
    }

    /// Width and height of the picture of a page.
    fn size(&self, [width, height]: [u32; 2]) -> Result<[u16; 2], ReportError> {
        let high = u64::from(self.width_px) * u64::from(height) / u64::from(width.max(1));
        let all = high
            .saturating_mul(u64::from(self.width_px))
            .saturating_mul(self.frames.len() as u64);
        let sides = u16::try_from(self.width_px)
            .ok()
            .zip(u16::try_from(high).ok());
        match sides {
            Some((wide, high)) if wide > 0 && high > 0 && all <= MAX_PIXELS => Ok([wide, high]),
            _ => Err(ReportError::AnimationSize {
                animation: self.name.clone(),
                frames: self.frames.len(),
                width: self.width_px.into(),
                height: high,
            }),
        }
    }
}

/// The page of every frame.
struct FramePage {
    size: [u32; 2],
    cell: Rect,
    layout: DrawingLayout,
    footer: Vec<String>,
}

impl FramePage {
    fn draw(&self, canvas: &mut Canvas<'_>, drawing: &Drawing) {
        let (cell, [width, height]) = (&self.cell, self.size.map(f64::from));
        canvas.rect(&Rect::sized(0.0, 0.0, width, height), WHITE);
        self.layout.draw(canvas, drawing, cell);
        let style = TextStyle::new(FOOTER_SIZE, CAPTION_GREY, Align::Start);
        for (i, line) in self.footer.iter().enumerate() {
            let baseline = cell.y1 + LEADING * FOOTER_SIZE * (i as f64 + 1.0);
            canvas.text(line, [cell.x0, baseline], style);
        }
    }
}

/// Frames in full colour, row by row.
struct Pictures {
    size: [u16; 2],
    frames: Vec<Vec<Rgb>>,
}

fn encoded(pictures: &Pictures, palette: &Palette, delay: u16) -> Result<Vec<u8>, EncodingError> {
    let [width, height] = pictures.size;
    // The index behind the last colour marks a pixel that does not change.
    let unchanged = palette.colors.len() as u8;
    let mut table = palette.colors.concat();
    table.extend(WHITE);
    let mut encoder = Encoder::new(Vec::new(), width, height, &table)?;
    encoder.set_repeat(Repeat::Infinite)?;
    let mut previous: Option<Vec<u8>> = None;
    for picture in &pictures.frames {
        let indices = palette.indices(picture);
        let new_part = match &previous {
            Some(before) => changes(before, &indices, usize::from(width), unchanged),
            None => Frame {
                width,
                height,
                buffer: Cow::Borrowed(&indices),
                ..Frame::default()
            },
        };
        encoder.write_frame(&Frame {
            delay,
            dispose: DisposalMethod::Keep,
            ..new_part
        })?;
        previous = Some(indices);
    }
    encoder.into_inner()
}

/// The rectangle of a frame that contains all changed pixels.
fn changes(before: &[u8], now: &[u8], width: usize, unchanged: u8) -> Frame<'static> {
    // Columns and rows of the changed pixels; a frame without changes is stored as one pixel.
    let new = || (0..now.len()).filter(|&i| now[i] != before[i]);
    let (left, right) = new().fold((width, 0), |(l, r), i| (l.min(i % width), r.max(i % width)));
    let (left, right) = if left > right { (0, 0) } else { (left, right) };
    let top = new().next().unwrap_or(0) / width;
    let bottom = new().next_back().unwrap_or(0) / width;
    let index = |i: usize| {
        if now[i] == before[i] {
            unchanged
        } else {
            now[i]
        }
    };
    let row = |y: usize| (y * width + left..=y * width + right).map(index);
    Frame {
        transparent: Some(unchanged),
        left: left as u16,
        top: top as u16,
        width: (right - left + 1) as u16,
        height: (bottom - top + 1) as u16,
        buffer: (top..=bottom).flat_map(row).collect(),
        ..Frame::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::{Axis, Paint};
    use crate::shape::{Pen, Shape};
    use gif::{ColorOutput, DecodeOptions};
    use std::f64::consts::TAU;

    fn crank(count: u32) -> Animation {
        let frame = |i: u32| {
            let (s, c) = (TAU * f64::from(i) / f64::from(count)).sin_cos();
            let bar = Shape::line(vec![[0.0, 0.0], [c, s]], Pen::new(Paint::Palette(0), 9.0));
            Drawing {
                title: "Crank".to_owned(),
                x: Axis::new("x", "m"),
                y: Axis::new("y", "m"),
                shapes: vec![
                    bar.named("crank"),
                    Shape::GroundPin { at: [0.0, 0.0] },
                    Shape::pin([c, s], Paint::Ink, 0.0),
                ],
                ..Drawing::default()
            }
        };
        Animation {
            name: "crank".to_owned(),
            frames: (0..count).map(frame).collect(),
            delay_ms: 40,
            width_px: 240,
            ..Animation::default()
        }
    }

    /// A frame as it is stored, and the picture a reader then shows.
    struct DecodedFrame {
        frame: Frame<'static>,
        picture: Vec<Rgb>,
    }

    fn decoded(bytes: &[u8]) -> ([u16; 2], Repeat, Vec<DecodedFrame>) {
        let mut options = DecodeOptions::new();
        options.set_color_output(ColorOutput::Indexed);
        options.check_frame_consistency(true);
        let mut decoder = options.read_info(bytes).unwrap();
        let size = [decoder.width(), decoder.height()];
        let table: Vec<Rgb> = decoder.global_palette().unwrap().as_chunks().0.to_vec();
        let mut picture = vec![[0; 3]; usize::from(size[0]) * usize::from(size[1])];
        let mut all = Vec::new();
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            let wide = usize::from(frame.width);
            for (i, index) in frame.buffer.iter().enumerate() {
                let x = usize::from(frame.left) + i % wide;
                let y = usize::from(frame.top) + i / wide;
                if frame.transparent != Some(*index) {
                    picture[y * usize::from(size[0]) + x] = table[usize::from(*index)];
                }
            }
            all.push(DecodedFrame {
                frame: frame.clone(),
                picture: picture.clone(),
            });
        }
        (size, decoder.repeat(), all)
    }

    #[test]
    fn a_reader_gets_every_frame_for_ever_at_its_pace() {
        let animation = crank(12);
        let drawn = animation.pictures().unwrap();
        let (size, repeat, decoded_frames) = decoded(&animation.gif().unwrap());
        assert_eq!((size, size[0], repeat), (drawn.size, 240, Repeat::Infinite));
        assert_eq!(decoded_frames.len(), 12);
        assert!(decoded_frames.iter().all(|s| s.frame.delay == 4));
        assert!(decoded_frames[0].picture != decoded_frames[6].picture);
        for (decoded_frames, drawn) in decoded_frames.iter().zip(&drawn.frames) {
            let differ =
                |(a, b): (&Rgb, &Rgb)| (0..3).map(|i| a[i].abs_diff(b[i])).fold(0, u8::max);
            let worst = decoded_frames
                .picture
                .iter()
                .zip(drawn)
                .map(differ)
                .fold(0, u8::max);
            // Measured: one level; two are invisible.
            assert!(worst <= 2, "a colour is off by {worst}");
        }
    }

    #[test]
    fn nothing_moves_but_the_shapes() {
        let animation = crank(12);
        let (_, layout) = animation.layout();
        let (size, _, decoded_frames) = decoded(&animation.gif().unwrap());
        let scale = f64::from(size[0]) / PAGE_WIDTH;
        let plot = layout.frame.plot;
        for DecodedFrame { frame, .. } in &decoded_frames[1..] {
            let [x0, y0] = [frame.left, frame.top].map(|v| f64::from(v) / scale);
            let [x1, y1] =
                [frame.left + frame.width, frame.top + frame.height].map(|v| f64::from(v) / scale);
            assert!(plot.grown(-20.0).contains_rect(&Rect { x0, y0, x1, y1 }));
        }
    }

    #[test]
    fn a_film_that_stands_still_keeps_its_frames() {
        let mut animation = crank(1);
        animation.frames = vec![animation.frames[0].clone(); 3];
        animation.delay_ms = 0;
        let (_, _, decoded_frames) = decoded(&animation.gif().unwrap());
        assert_eq!(decoded_frames.len(), 3);
        assert!(
            decoded_frames
                .iter()
                .all(|s| s.picture == decoded_frames[0].picture && s.frame.delay == 2)
        );
    }

    #[test]
    fn drawings_without_shapes_are_frames_too() {
        let animation = Animation {
            frames: vec![Drawing::default()],
            width_px: 100,
            ..Animation::default()
        };
        assert_eq!(decoded(&animation.gif().unwrap()).2.len(), 1);
    }

    #[test]
    fn what_cannot_be_a_film_says_so() {
        let none = Animation::default().gif();
        assert!(matches!(none, Err(ReportError::NoFrames { .. })));
        for width_px in [0, 70_000, u32::MAX] {
            let animation = Animation {
                width_px,
                ..crank(2)
            };
            assert!(matches!(
                animation.gif(),
                Err(ReportError::AnimationSize { frames: 2, .. })
            ));
        }
        // Few large frames are fine, many are not.
        let animation = Animation {
            width_px: 60_000,
            ..crank(1)
        };
        assert!(matches!(
            animation.size([800, 600]),
            Err(ReportError::AnimationSize { .. })
        ));
        let animation = Animation {
            width_px: 480,
            ..crank(60)
        };
        assert_eq!(animation.size([800, 600]).unwrap(), [480, 360]);
    }
}
