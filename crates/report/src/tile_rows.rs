//! Tiles, laid out on the page.

use crate::canvas::{Align, Canvas, TextStyle};
use crate::fonts::{width, wrapped_anywhere};
use crate::grid::{Tile, Tiles};
use crate::rect::Rect;
use crate::theme::{BAND, CAPTION_GREY, FAILED, INK, PASSED};
use crate::typeset::typeset;

const NAME_SIZE: f64 = 22.0;
const VALUE_SIZE: f64 = 38.0;
const NOTE_SIZE: f64 = 20.0;
/// Distance of baselines, in font sizes.
const LEADING: f64 = 1.3;
/// Between tiles; and between the edge of a tile and its words.
const GAP: f64 = 12.0;
const PAD: f64 = 14.0;
/// The coloured edge of a verdict.
const EDGE_WIDTH: f64 = 8.0;

/// A tile with its words broken into lines.
struct Measured<'a> {
    tile: &'a Tile,
    name: (String, f64),
    value: (String, f64),
    note: Vec<String>,
}

/// Tiles measured for a width, row by row with their heights.
pub(crate) struct TileRows<'a> {
    rows: Vec<(Vec<Measured<'a>>, f64)>,
    tile_width: f64,
}

impl<'a> TileRows<'a> {
    pub(crate) fn new(of: &'a Tiles, total_width: f64) -> Self {
        let columns = of.columns.max(1);
        let tile_width = (total_width - GAP * (columns - 1) as f64) / columns as f64;
        let room = tile_width - 2.0 * PAD - EDGE_WIDTH;
        let measured = |tile: &'a Tile| {
            // Smaller where it would be wider than the tile.
            let fitted = |text: &str, size: f64, bold: bool| {
                let text = typeset(text);
                let shrunk = room / width(&text, size, bold).max(1.0);
                (text, size * shrunk.min(1.0))
            };
            Measured {
                tile,
                name: fitted(&tile.name, NAME_SIZE, false),
                value: fitted(&tile.value, VALUE_SIZE, true),
                note: wrapped_anywhere(&typeset(&tile.note), NOTE_SIZE, false, room),
            }
        };
        let row = |tiles: &'a [Tile]| {
            let tiles: Vec<Measured<'a>> = tiles.iter().map(measured).collect();
            let lines = tiles.iter().map(|tile| tile.note.len()).max();
            let notes = LEADING * NOTE_SIZE * lines.unwrap_or(0) as f64;
            let height = 2.0 * PAD + LEADING * (NAME_SIZE + VALUE_SIZE) + notes;
            (tiles, height)
        };
        Self {
            rows: of.tiles.chunks(columns).map(row).collect(),
            tile_width,
        }
    }

    pub(crate) fn height(&self) -> f64 {
        let gaps = GAP * self.rows.len().saturating_sub(1) as f64;
        self.rows.iter().map(|(_, height)| height).sum::<f64>() + gaps
    }

    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>, area: &Rect) {
        let mut y = area.y0;
        for (tiles, height) in &self.rows {
            for (k, tile) in tiles.iter().enumerate() {
                let x = area.x0 + k as f64 * (self.tile_width + GAP);
                tile.draw(canvas, &Rect::sized(x, y, self.tile_width, *height));
            }
            y += height + GAP;
        }
    }
}

impl Measured<'_> {
    fn draw(&self, canvas: &mut Canvas<'_>, area: &Rect) {
        canvas.rect(area, BAND);
        let edge = Rect {
            x1: area.x0 + EDGE_WIDTH,
            ..*area
        };
        let color = match self.tile.passed {
            Some(true) => PASSED,
            Some(false) => FAILED,
            None => CAPTION_GREY,
        };
        canvas.rect(&edge, color);
        let x = edge.x1 + PAD;
        let mut y = area.y0 + PAD;
        let mut line = |text: &str, room: f64, style: TextStyle| {
            canvas.text(text, [x, y + 0.8 * room], style);
            y += LEADING * room;
        };
        let small = |size| TextStyle::new(size, CAPTION_GREY, Align::Start);
        let (name, size) = &self.name;
        line(name, NAME_SIZE, small(*size));
        let (value, size) = &self.value;
        let color = match self.tile.passed {
            Some(false) => FAILED,
            _ => INK,
        };
        line(
            value,
            VALUE_SIZE,
            TextStyle::new(*size, color, Align::Start).bold(),
        );
        for text in &self.note {
            line(text, NOTE_SIZE, small(NOTE_SIZE));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_shrink_to_their_tiles_and_notes_are_wrapped() {
        let tiles = Tiles {
            columns: 4,
            tiles: vec![
                Tile::new("period", "5.42 s", ""),
                Tile::new(
                    "closest",
                    "a name that is wider than a tile by far",
                    "by a check ".repeat(9),
                ),
            ],
        };
        let rows = TileRows::new(&tiles, 1312.0);
        let [(row, height)] = &rows.rows[..] else {
            panic!("one row");
        };
        assert_eq!(row[0].value.1, VALUE_SIZE);
        let (text, size) = &row[1].value;
        assert!(width(text, *size, true) <= rows.tile_width - PAD && row[1].note.len() > 2);
        assert!(*height > 5.0 * NAME_SIZE && rows.height() == *height);
    }
}
