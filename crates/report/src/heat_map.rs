//! A matrix of coloured cells, laid out on the page.

use crate::axis_range::AxisRange;
use crate::canvas::{Align, Canvas, LineStyle, TextStyle};
use crate::cell_marks::hatched_cell;
use crate::color_bar::{CellMark, ColorBar};
use crate::colormap;
use crate::fonts::{widest, width, wrapped_anywhere};
use crate::grid::{Cell, Grid, Row};
use crate::header::{Header, LEADING, draw_lines};
use crate::rect::Rect;
use crate::theme::{EDGE, FAILED, GREY, INK, PANEL_TITLE_SIZE, WHITE};
use crate::wrapped_text::{self, WrappedText};

/// What is left free above a heading, as a share of a row.
const HEADING_GAP: f64 = 0.35;
/// Between names and cells.
const NAME_GAP: f64 = 14.0;
/// Largest share of the width that names of rows take.
const MAX_NAMES_SHARE: f64 = 0.36;
/// With more rows the names of the columns stand below them too.
const MAX_STRIPS_FOR_ONE_HEADER: usize = 45;
/// White between cells.
const CELL_GAP: f64 = 2.0;

/// Sizes of a grid.
#[derive(Clone, Copy)]
struct Sizes {
    /// Letters, and the size down to which those that do not fit their cells are all set.
    text: f64,
    min_text: f64,
    /// Height of a row whose words need one line.
    row: f64,
    /// Between the edge of a cell and its letters.
    pad: f64,
}

impl Sizes {
    fn of(grid: &Grid) -> Self {
        let [text, min_text, row, pad] = if grid.compact {
            [19.0, 16.0, 20.8, 3.0]
        } else {
            [25.0, 18.0, 40.0, 7.0]
        };
        Self {
            text,
            min_text,
            row,
            pad,
        }
    }
}

/// A heading or a row with its words broken into lines.
struct Strip<'a> {
    lines: Vec<String>,
    /// None for a heading.
    row: Option<&'a Row>,
    height: f64,
}

/// A grid that has been measured for a width.
pub(crate) struct HeatMap<'a> {
    title: WrappedText,
    bar: ColorBar,
    range: AxisRange,
    header: Header,
    strips: Vec<Strip<'a>>,
    /// Width of the names of rows and of each column.
    names_width: f64,
    column_width: f64,
    compact: bool,
    sizes: Sizes,
    /// Size of the letters in cells.
    text_size: f64,
}

impl<'a> HeatMap<'a> {
    pub(crate) fn new(grid: &'a Grid, total_width: f64) -> Self {
        let sizes = Sizes::of(grid);
        let names = names_width(grid, total_width, sizes);
        let columns = grid.columns.len();
        let column = (total_width - names) / columns.max(1) as f64;
        let size = text_size(grid, column - 2.0 * sizes.pad, sizes);
        let values = || cells(grid).flatten().filter_map(|cell| cell.value);
        let range = AxisRange::of(&grid.values, values(), 0.0);
        let bar_range = values()
            .any(|v| range.fraction(v).is_some())
            .then_some(range);
        let not_applicable = cells(grid).any(|cell| cell.is_none());
        let failed = cells(grid).flatten().any(|cell| cell.failed);
        let key = not_applicable
            .then_some(CellMark::NotApplicable)
            .into_iter()
            .chain(failed.then_some(CellMark::Failed));
        Self {
            title: wrapped_text::title(&grid.title, &Rect::sized(0.0, 0.0, total_width, 0.0)),
            bar: ColorBar::new(&grid.values, bar_range, key.collect(), total_width),
            range,
            header: Header::new(&grid.columns, column, sizes.text),
            strips: strips(grid, total_width, [names, column, size], sizes),
            names_width: names,
            column_width: column,
            compact: grid.compact,
            sizes,
            text_size: size,
        }
    }

    /// Height of the cell of the page that holds it.
    pub(crate) fn height(&self) -> f64 {
        let strips: f64 = self.strips.iter().map(|strip| strip.height).sum();
        let headers = if self.repeats_header() { 2.0 } else { 1.0 };
        self.height_above_header() + headers * self.header.height + strips
    }

    fn height_above_header(&self) -> f64 {
        let gap = if self.title.lines.is_empty() {
            0.0
        } else {
            0.5 * PANEL_TITLE_SIZE
        };
        self.title.height() + gap + self.bar.height()
    }

    fn repeats_header(&self) -> bool {
        // Compact rows are all in sight of it.
        !self.compact && self.strips.len() > MAX_STRIPS_FOR_ONE_HEADER
    }

    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>, area: &Rect) {
        let style = TextStyle::new(self.title.size, INK, Align::Start).bold();
        self.title.draw(canvas, [area.x0, area.y0], style);
        let mut y = area.y0 + self.height_above_header();
        let bar = Rect::sized(area.x0, y - self.bar.height(), area.width(), 0.0);
        self.bar.draw(canvas, &bar);
        let left = area.x0 + self.names_width;
        self.header
            .draw(canvas, [left, y], self.column_width, false);
        y += self.header.height;
        for strip in &self.strips {
            let lines = strip.lines.len() as f64;
            let Some(row) = strip.row else {
                let top = y + strip.height
                    - 0.5 * (self.sizes.row - self.sizes.text)
                    - LEADING * self.sizes.text * lines;
                let style = TextStyle::new(self.sizes.text, INK, Align::Start).bold();
                draw_lines(canvas, &strip.lines, [area.x0, top], style);
                y += strip.height;
                continue;
            };
            let style = TextStyle::new(self.sizes.text, INK, Align::End);
            let top = y + 0.5 * (strip.height - LEADING * self.sizes.text * lines);
            draw_lines(canvas, &strip.lines, [left - NAME_GAP, top], style);
            for i in 0..self.header.names.len() {
                let x = left + i as f64 * self.column_width;
                let cell =
                    Rect::sized(x, y, self.column_width, strip.height).grown(-0.5 * CELL_GAP);
                let value = row.cells.get(i).and_then(Option::as_ref);
                self.draw_cell(canvas, &cell, value);
            }
            y += strip.height;
        }
        if self.repeats_header() {
            self.header.draw(canvas, [left, y], self.column_width, true);
        }
    }

    fn draw_cell(&self, canvas: &mut Canvas<'_>, area: &Rect, cell: Option<&Cell>) {
        let Some(cell) = cell else {
            hatched_cell(canvas, area);
            let style = TextStyle::new(self.sizes.text, GREY, Align::Middle);
            return canvas.text_centred("–", area.centre(), style);
        };
        let fraction = cell.value.and_then(|value| self.range.fraction(value));
        let background = match fraction {
            _ if cell.failed => FAILED,
            None => WHITE,
            Some(fraction) => colormap::color(fraction),
        };
        canvas.rect(area, background);
        if background == WHITE {
            canvas.rect_outline(&area.grown(-0.75), LineStyle::solid(EDGE, 1.5));
        }
        let (size, room) = (self.text_size, self.column_width - 2.0 * self.sizes.pad);
        let lines = wrapped_anywhere(&cell.text, size, cell.failed, room);
        let [x, middle] = area.centre();
        let top = middle - 0.5 * LEADING * size * lines.len() as f64;
        let color = colormap::text_color_on(background);
        let style = TextStyle {
            bold: cell.failed,
            ..TextStyle::new(size, color, Align::Middle)
        };
        draw_lines(canvas, &lines, [x, top], style);
    }
}

/// All cells in sight, absent ones included.
fn cells(grid: &Grid) -> impl Iterator<Item = Option<&Cell>> {
    let rows = grid.groups.iter().flat_map(|group| &group.rows);
    rows.flat_map(|row| (0..grid.columns.len()).map(|i| row.cells.get(i).and_then(Option::as_ref)))
}

/// Width of the names of rows, with the gap to the cells.
fn names_width(grid: &Grid, total_width: f64, sizes: Sizes) -> f64 {
    let rows = grid.groups.iter().flat_map(|group| &group.rows);
    let widest = widest(rows.map(|row| row.name.trim()), sizes.text, false);
    if widest > 0.0 {
        (widest + NAME_GAP + 1.0).min(MAX_NAMES_SHARE * total_width)
    } else {
        0.0
    }
}

/// Size at which the letters of every cell fit a width, or else the least.
fn text_size(grid: &Grid, room: f64, sizes: Sizes) -> f64 {
    let widths = cells(grid)
        .flatten()
        .map(|cell| width(&cell.text, sizes.text, cell.failed));
    let widest = widths.fold(0.0, f64::max);
    if widest > room {
        (sizes.text * room / widest).max(sizes.min_text)
    } else {
        sizes.text
    }
}

/// Headings and rows from above.
/// `widths`: of the names and of a column, and the size of the letters in cells.
fn strips(
    grid: &Grid,
    total_width: f64,
    [names, column, size]: [f64; 3],
    sizes: Sizes,
) -> Vec<Strip<'_>> {
    let mut strips = Vec::new();
    for group in &grid.groups {
        let text_lines = wrapped_anywhere(&group.heading, sizes.text, true, total_width);
        if !text_lines.is_empty() {
            let height = HEADING_GAP * sizes.row
                + sizes.row
                + (text_lines.len() as f64 - 1.0) * LEADING * sizes.text;
            strips.push(Strip {
                lines: text_lines,
                row: None,
                height,
            });
        }
        for row in &group.rows {
            let text_lines = wrapped_anywhere(&row.name, sizes.text, false, names - NAME_GAP);
            let cells = row.cells.iter().take(grid.columns.len()).flatten();
            let lines = cells
                .map(|c| wrapped_anywhere(&c.text, size, c.failed, column - 2.0 * sizes.pad).len());
            let tallest = lines.max().unwrap_or(0) as f64 * LEADING * size;
            let height = tallest.max(text_lines.len() as f64 * LEADING * sizes.text) + sizes.row
                - LEADING * sizes.text;
            strips.push(Strip {
                lines: text_lines,
                row: Some(row),
                height: height.max(sizes.row),
            });
        }
    }
    strips
}

#[cfg(test)]
mod tests {
    use super::*;
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
        let height = |rows| HeatMap::new(&grid(rows, &["m", "a"]), 1312.0).height();
        // Sums of whole numbers and of measured text: rounding only.
        assert!((height(40) - height(30) - 10.0 * 40.0).abs() < 1e-9);
        let names = HeatMap::new(&grid(120, &["m", "a"]), 1312.0).header.height;
        assert!((height(120) - height(40) - 80.0 * 40.0 - names).abs() < 1e-9);
        // As PNG, a hundred rows still are a page.
        assert!(height(120) < 5200.0);
    }

    #[test]
    fn letters_shrink_to_the_least_size_and_break_then() {
        let mut wide = grid(1, &["a"; 12]);
        wide.groups[0].rows[0].cells[0] = Some(Cell::text_only("1.234567e−12"));
        let heat_map = HeatMap::new(&wide, 1312.0);
        assert_eq!(heat_map.text_size, 18.0);
        assert!(heat_map.strips[0].height > 40.0);
        assert_eq!(HeatMap::new(&grid(1, &["a"; 12]), 1312.0).text_size, 25.0);
    }
}
