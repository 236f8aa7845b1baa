//! A grid of cells in its place on the page.

use crate::canvas::{Align, Canvas, Drawn, Line, Type};
use crate::color_bar::{ColorBar, Marked};
use crate::curve::clipped;
use crate::figure::Paint;
use crate::fonts::{broken, width};
use crate::grid::{Cell, Grid, Row};
use crate::header::{Header, LEADING, SIZE, stacked};
use crate::heat;
use crate::rect::Rect;
use crate::span::Span;
use crate::theme::{EDGE, GREY, GRID, INK, PANEL_TITLE, WHITE, rgb};
use crate::words::{self, Words};

/// Letters that do not fit their cells are all set smaller, down to this size.
const LEAST: f64 = 18.0;
/// Height of a row whose words need one line.
const ROW: f64 = 40.0;
/// What is left free above a heading.
const HEADING_GAP: f64 = 14.0;
/// Between the edge of a cell and its letters, and between names and cells.
const PAD: f64 = 7.0;
const NAME_GAP: f64 = 14.0;
/// Largest share of the width that names of rows take.
const NAMES: f64 = 0.36;
/// With more rows the names of the columns stand below them too.
const FAR: usize = 45;
/// White between cells, and from hatch to hatch.
const SEAM: f64 = 2.0;
const HATCH: f64 = 11.0;
/// Border of a failed cell.
const BORDER: f64 = 5.0;

/// A heading or a row with its words broken into lines.
struct Strip<'a> {
    words: Vec<String>,
    /// None for a heading.
    row: Option<&'a Row>,
    height: f64,
}

/// A grid that has been measured for a width.
pub(crate) struct Lattice<'a> {
    title: Words,
    bar: ColorBar,
    span: Span,
    header: Header,
    strips: Vec<Strip<'a>>,
    /// Width of the names of rows and of each column.
    names: f64,
    column: f64,
    /// Size of the letters in cells.
    size: f64,
}

impl<'a> Lattice<'a> {
    pub(crate) fn new(grid: &'a Grid, wide: f64) -> Self {
        let names = names_width(grid, wide);
        let columns = grid.columns.len();
        let column = (wide - names) / columns.max(1) as f64;
        let size = size(grid, column - 2.0 * PAD);
        let values = || cells(grid).flatten().filter_map(|cell| cell.value);
        let span = Span::of(&grid.values, values(), 0.0);
        let shown = values().any(|v| span.place(v).is_some()).then_some(span);
        let absent = cells(grid).any(|cell| cell.is_none());
        let failed = cells(grid).flatten().any(|cell| cell.failed);
        let key = absent.then_some(Marked::Absent);
        let key = key.into_iter().chain(failed.then_some(Marked::Failed));
        Self {
            title: words::title(&grid.title, &Rect::sized(0.0, 0.0, wide, 0.0)),
            bar: ColorBar::new(&grid.values, shown, key.collect(), wide),
            span,
            header: Header::new(&grid.columns, column),
            strips: strips(grid, wide, names, column, size),
            names,
            column,
            size,
        }
    }

    /// Height of the cell of the page that holds it.
    pub(crate) fn height(&self) -> f64 {
        let strips: f64 = self.strips.iter().map(|strip| strip.height).sum();
        let headers = if self.far() { 2.0 } else { 1.0 };
        self.top() + headers * self.header.height + strips
    }

    fn top(&self) -> f64 {
        let gap = if self.title.lines.is_empty() {
            0.0
        } else {
            0.5 * PANEL_TITLE
        };
        self.title.height() + gap + self.bar.height()
    }

    fn far(&self) -> bool {
        self.strips.len() > FAR
    }

    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>, place: &Rect) -> Drawn {
        for (line, baseline) in self.title.baselines() {
            let look = Type::new(self.title.size, INK, Align::Start).bold();
            canvas.text(line, [place.x0, place.y0 + baseline], look)?;
        }
        let mut y = place.y0 + self.top();
        let bar = Rect::sized(place.x0, y - self.bar.height(), place.width(), 0.0);
        self.bar.draw(canvas, &bar)?;
        let left = place.x0 + self.names;
        self.header.draw(canvas, [left, y], self.column, false)?;
        y += self.header.height;
        for strip in &self.strips {
            let lines = strip.words.len() as f64;
            let Some(row) = strip.row else {
                let top = y + strip.height - 0.5 * (ROW - SIZE) - LEADING * SIZE * lines;
                let look = Type::new(SIZE, INK, Align::Start).bold();
                stacked(canvas, &strip.words, [place.x0, top], look)?;
                y += strip.height;
                continue;
            };
            let look = Type::new(SIZE, INK, Align::End);
            let top = y + 0.5 * (strip.height - LEADING * SIZE * lines);
            stacked(canvas, &strip.words, [left - NAME_GAP, top], look)?;
            for i in 0..self.header.names.len() {
                let x = left + i as f64 * self.column;
                let cell = Rect::sized(x, y, self.column, strip.height).grown(-0.5 * SEAM);
                let value = row.cells.get(i).and_then(Option::as_ref);
                self.cell(canvas, &cell, value)?;
            }
            y += strip.height;
        }
        if self.far() {
            self.header.draw(canvas, [left, y], self.column, true)?;
        }
        Ok(())
    }

    fn cell(&self, canvas: &mut Canvas<'_>, place: &Rect, cell: Option<&Cell>) -> Drawn {
        let Some(cell) = cell else {
            hatched(canvas, place)?;
            let look = Type::new(SIZE, GREY, Align::Middle);
            return canvas.text_beside("–", place.centre(), look);
        };
        let part = cell.value.and_then(|value| self.span.place(value));
        let ground = part.map_or(WHITE, heat::color);
        if part.is_some() {
            canvas.rect(place, ground)?;
        } else {
            canvas.frame(&place.grown(-0.75), Line::solid(EDGE, 1.5))?;
        }
        if cell.failed {
            failed(canvas, place)?;
        }
        let lines = broken(&cell.text, self.size, cell.failed, self.column - 2.0 * PAD);
        let [x, middle] = place.centre();
        let top = middle - 0.5 * LEADING * self.size * lines.len() as f64;
        let look = Type {
            bold: cell.failed,
            ..Type::new(self.size, heat::letters_on(ground), Align::Middle)
        };
        stacked(canvas, &lines, [x, top], look)
    }
}

/// A cell that does not apply.
pub(crate) fn hatched(canvas: &mut Canvas<'_>, place: &Rect) -> Drawn {
    let mut x = place.x0 + 0.5 * HATCH;
    while x < place.x1 + place.height() {
        let line = [[x, place.y0], [x - place.height(), place.y1]];
        for part in clipped(line.map(Some), place) {
            canvas.line(&part, Line::solid(GRID, 1.6))?;
        }
        x += HATCH;
    }
    canvas.frame(&place.grown(-0.75), Line::solid(GRID, 1.5))
}

/// The border of a cell that failed.
pub(crate) fn failed(canvas: &mut Canvas<'_>, place: &Rect) -> Drawn {
    let border = Line::solid(rgb(Paint::Palette(1)), BORDER);
    canvas.frame(&place.grown(-0.5 * BORDER), border)
}

/// All cells in sight, absent ones included.
fn cells(grid: &Grid) -> impl Iterator<Item = Option<&Cell>> {
    let rows = grid.groups.iter().flat_map(|group| &group.rows);
    rows.flat_map(|row| (0..grid.columns.len()).map(|i| row.cells.get(i).and_then(Option::as_ref)))
}

/// Width of the names of rows, with the gap to the cells.
fn names_width(grid: &Grid, wide: f64) -> f64 {
    let rows = grid.groups.iter().flat_map(|group| &group.rows);
    let widest = rows
        .map(|row| width(row.name.trim(), SIZE, false))
        .fold(0.0, f64::max);
    if widest > 0.0 {
        (widest + NAME_GAP + 1.0).min(NAMES * wide)
    } else {
        0.0
    }
}

/// Size at which the letters of every cell fit a width, or else the least.
fn size(grid: &Grid, room: f64) -> f64 {
    let widths = cells(grid)
        .flatten()
        .map(|cell| width(&cell.text, SIZE, cell.failed));
    let widest = widths.fold(0.0, f64::max);
    if widest > room {
        (SIZE * room / widest).max(LEAST)
    } else {
        SIZE
    }
}

/// Headings and rows from above.
fn strips(grid: &Grid, wide: f64, names: f64, column: f64, size: f64) -> Vec<Strip<'_>> {
    let mut strips = Vec::new();
    for group in &grid.groups {
        let words = broken(&group.heading, SIZE, true, wide);
        if !words.is_empty() {
            let height = HEADING_GAP + ROW + (words.len() as f64 - 1.0) * LEADING * SIZE;
            strips.push(Strip {
                words,
                row: None,
                height,
            });
        }
        for row in &group.rows {
            let words = broken(&row.name, SIZE, false, names - NAME_GAP);
            let cells = row.cells.iter().take(grid.columns.len()).flatten();
            let lines = cells.map(|c| broken(&c.text, size, c.failed, column - 2.0 * PAD).len());
            let tallest = lines.max().unwrap_or(0) as f64 * LEADING * size;
            let height = tallest.max(words.len() as f64 * LEADING * SIZE) + ROW - LEADING * SIZE;
            strips.push(Strip {
                words,
                row: Some(row),
                height: height.max(ROW),
            });
        }
    }
    strips
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fonts;
    use crate::grid::Group;

    fn grid(rows: usize, columns: &[&str]) -> Grid {
        let row = |i: usize| {
            Row::new(
                format!("row {i}"),
                vec![Some(Cell::new(i as f64, "12")); columns.len()],
            )
        };
        Grid {
            columns: columns.iter().map(|name| (*name).to_owned()).collect(),
            groups: vec![Group {
                rows: (0..rows).map(row).collect(),
                ..Group::default()
            }],
            ..Grid::default()
        }
    }

    #[test]
    fn the_panel_grows_by_its_rows_and_repeats_far_names() {
        fonts::ready().unwrap();
        let height = |rows| Lattice::new(&grid(rows, &["m", "a"]), 1312.0).height();
        // Sums of whole numbers and of measured text: rounding only.
        assert!((height(40) - height(30) - 10.0 * ROW).abs() < 1e-9);
        let names = Lattice::new(&grid(120, &["m", "a"]), 1312.0).header.height;
        assert!((height(120) - height(40) - 80.0 * ROW - names).abs() < 1e-9);
        // As PNG, a hundred rows still are a page.
        assert!(height(120) < 5200.0);
    }

    #[test]
    fn letters_shrink_to_the_least_size_and_break_then() {
        fonts::ready().unwrap();
        let mut wide = grid(1, &["a"; 12]);
        wide.groups[0].rows[0].cells[0] = Some(Cell::words("1.234567e−12"));
        let lattice = Lattice::new(&wide, 1312.0);
        assert_eq!(lattice.size, LEAST);
        assert!(lattice.strips[0].height > ROW);
        assert_eq!(Lattice::new(&grid(1, &["a"; 12]), 1312.0).size, SIZE);
    }
}
