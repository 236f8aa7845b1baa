//! The page: title, cells in rows, caption.

use crate::canvas::{Align, Canvas, TextStyle};
use crate::chart::{self, PreparedChart};
use crate::drawing::{self, DrawingLayout};
use crate::figure::{Figure, Panel};
use crate::fonts::wrapped;
use crate::heat_map::HeatMap;
use crate::rect::{Insets, Rect};
use crate::shape::Drawing;
use crate::stack::Stack;
use crate::theme::{CAPTION_GREY, CAPTION_SIZE, INK, PROVENANCE_SIZE, TITLE_SIZE, WHITE};
use crate::tile_rows::TileRows;
use crate::typeset::typeset;
use std::slice::from_ref;

/// Around the page.
const MARGIN: f64 = 44.0;
/// Between columns and between rows.
const COLUMN_GAP: f64 = 48.0;
const ROW_GAP: f64 = 40.0;
/// Width of a cell; two columns make a page of 2000 pixels.
const CELL: f64 = 932.0;
/// Width of the only cell of a row.
const LONE_CELL: f64 = 1312.0;
/// Height of a lone chart as a share of its width, which is larger than in company.
const LONE_HEIGHT: f64 = 0.56;
/// Height of a chart in a stretched row, as a share of its width.
const STRETCHED_HEIGHT: f64 = 0.36;
const TITLE_LEADING: f64 = 1.25;
const CAPTION_LEADING: f64 = 1.4;
/// Between the caption and the line with the provenance of the figure.
const FOOTER_GAP: f64 = 10.0;

/// A panel whose labels have been measured.
enum PreparedPanel<'a> {
    Chart(PreparedChart<'a>),
    Drawing(&'a Drawing),
    Stack(Stack<'a>),
    Grid(Box<HeatMap<'a>>),
    Tiles(TileRows<'a>),
}

impl PreparedPanel<'_> {
    fn insets(&self, cell: &Rect) -> Insets {
        match self {
            Self::Chart(chart) => chart.insets(cell),
            Self::Drawing(drawing) => drawing::insets(from_ref(drawing), cell),
            Self::Stack(stack) => stack.insets(cell),
            // Their cells line up with nothing on the page.
            Self::Grid(_) | Self::Tiles(_) => Insets::default(),
        }
    }

    /// Height of the cell that suits it at this width, alone in its row or with as many panels as there are columns, or stretched.
    fn height(&self, width: f64, lone: bool, stretched: bool) -> f64 {
        match self {
            Self::Chart(_) if stretched => STRETCHED_HEIGHT * width,
            Self::Chart(_) if lone => LONE_HEIGHT * width,
            Self::Chart(_) => chart::HEIGHT * width,
            Self::Drawing(drawing) => drawing::height(from_ref(drawing), width).min(1000.0),
            Self::Stack(stack) => stack.height(width),
            Self::Grid(heat_map) => heat_map.height(),
            Self::Tiles(tiles) => tiles.height(),
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, cell: &Rect, insets: Insets) {
        match self {
            Self::Chart(chart) => chart.draw(canvas, cell, insets),
            Self::Drawing(drawing) => {
                DrawingLayout::new(from_ref(drawing), cell, insets).draw(canvas, drawing, cell);
            }
            Self::Stack(stack) => stack.draw(canvas, cell, insets),
            Self::Grid(heat_map) => heat_map.draw(canvas, cell),
            Self::Tiles(tiles) => tiles.draw(canvas, cell),
        }
    }
}

/// A panel in its cell.
struct PlacedPanel<'a> {
    panel: PreparedPanel<'a>,
    row: usize,
    /// None in a row that is stretched, whose cells lie under no column.
    column: Option<usize>,
    cell: Rect,
}

/// A page laid out, ready to be drawn.
pub(crate) struct Page<'a> {
    pub(crate) width: f64,
    pub(crate) height: f64,
    /// The lines of title, caption and provenance with their baselines.
    lines: Vec<(String, f64, TextStyle)>,
    panels: Vec<PlacedPanel<'a>>,
}

fn prepared(panel: &Panel, width: f64) -> PreparedPanel<'_> {
    match panel {
        Panel::Chart(chart) => PreparedPanel::Chart(PreparedChart::new(chart)),
        Panel::Drawing(drawing) => PreparedPanel::Drawing(drawing),
        Panel::Stack(charts) => PreparedPanel::Stack(Stack::new(charts)),
        Panel::Grid(grid) => PreparedPanel::Grid(Box::new(HeatMap::new(grid, width))),
        Panel::Tiles(tiles) => PreparedPanel::Tiles(TileRows::new(tiles, width)),
    }
}

impl<'a> Page<'a> {
    /// Lays everything out.
    pub(crate) fn new(figure: &'a Figure) -> Self {
        let columns = figure.columns.clamp(1, figure.panels.len().max(1));
        let gaps = COLUMN_GAP * (columns as f64 - 1.0);
        let inner = match columns {
            1 => LONE_CELL,
            _ => CELL * columns as f64 + gaps,
        };
        let mut lines = Vec::new();
        // The lines of a text from `y` on, which goes on below them.
        let mut write = |text: &str, style: TextStyle, leading: f64, y: &mut f64| {
            for line in wrapped(&typeset(text), style.size, style.bold, inner) {
                lines.push((line, *y + 0.8 * style.size, style));
                *y += leading * style.size;
            }
        };
        let mut y = MARGIN;
        let style = TextStyle::new(TITLE_SIZE, INK, Align::Start).bold();
        write(&figure.title, style, TITLE_LEADING, &mut y);
        if y > MARGIN {
            y += 0.55 * TITLE_SIZE;
        }
        let mut panels = Vec::new();
        for (row, chunk) in figure.panels.chunks(columns).enumerate() {
            let count = chunk.len() as f64;
            let width = (inner - COLUMN_GAP * (count - 1.0)) / count;
            let stretched = chunk.len() < columns;
            let chunk: Vec<_> = chunk.iter().map(|panel| prepared(panel, width)).collect();
            let height = |p: &PreparedPanel<'_>| p.height(width, columns == 1, stretched);
            let height = chunk.iter().map(height).fold(0.0, f64::max);
            for (column, panel) in chunk.into_iter().enumerate() {
                let x = MARGIN + column as f64 * (width + COLUMN_GAP);
                panels.push(PlacedPanel {
                    panel,
                    row,
                    column: (!stretched).then_some(column),
                    cell: Rect::sized(x, y, width, height),
                });
            }
            y += height + ROW_GAP;
        }
        let grey = |size| TextStyle::new(size, CAPTION_GREY, Align::Start);
        let foot = y;
        write(&figure.caption, grey(CAPTION_SIZE), CAPTION_LEADING, &mut y);
        let top = if y > foot { y + FOOTER_GAP } else { y };
        let mut end = top;
        let style = grey(PROVENANCE_SIZE);
        write(&figure.provenance, style, CAPTION_LEADING, &mut end);
        y = match (end > top, y > foot) {
            (true, _) => end,
            (false, true) => y,
            (false, false) => y - ROW_GAP,
        };
        Self {
            width: inner + 2.0 * MARGIN,
            height: (y + 0.75 * MARGIN).ceil(),
            lines,
            panels,
        }
    }

    /// Width and height in whole pixels.
    pub(crate) fn size(&self) -> [u32; 2] {
        [self.width, self.height].map(|side| side as u32)
    }

    /// Draws it.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>) {
        canvas.rect(&Rect::sized(0.0, 0.0, self.width, self.height), WHITE);
        for (line, baseline, style) in &self.lines {
            canvas.text(line, [MARGIN, *baseline], *style);
        }
        for (placed, insets) in self.panels.iter().zip(self.aligned()) {
            placed.panel.draw(canvas, &placed.cell, insets);
        }
    }

    /// Insets such that plots of a column line up at the sides, and those of a row above and below.
    fn aligned(&self) -> Vec<Insets> {
        let insets = |p: &PlacedPanel<'_>| p.panel.insets(&p.cell);
        let panels: Vec<_> = self.panels.iter().map(|p| (p, insets(p))).collect();
        let max_insets = |keep: &dyn Fn(&PlacedPanel<'_>) -> bool| {
            let of_group = panels.iter().filter(|(p, _)| keep(p)).map(|(_, i)| *i);
            of_group.fold(Insets::default(), Insets::max)
        };
        let of = |(p, insets): &(&PlacedPanel<'_>, Insets)| {
            let of_column = match p.column {
                Some(_) => max_insets(&|other| other.column == p.column),
                None => *insets,
            };
            let row = max_insets(&|other| other.row == p.row);
            Insets {
                left: of_column.left,
                right: of_column.right,
                ..row
            }
        };
        panels.iter().map(of).collect()
    }
}
