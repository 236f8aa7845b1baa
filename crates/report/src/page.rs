//! The page: title, cells in rows, caption.

use crate::canvas::{Align, Canvas, Drawn, Type};
use crate::chart::{self, Sheet};
use crate::drawing::{self, Stage};
use crate::figure::{Figure, Panel};
use crate::fonts::wrapped;
use crate::lattice::Lattice;
use crate::rect::{Insets, Rect};
use crate::shape::Drawing;
use crate::stack::Stack;
use crate::theme::{CAPTION, CAPTION_GREY, INK, PROVENANCE, TITLE, WHITE};
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

/// A panel whose labels have been measured.
enum Ready<'a> {
    Chart(Sheet<'a>),
    Drawing(&'a Drawing),
    Stack(Stack<'a>),
    Grid(Box<Lattice<'a>>),
}

impl Ready<'_> {
    fn insets(&self, cell: &Rect) -> Insets {
        match self {
            Self::Chart(sheet) => sheet.insets(cell),
            Self::Drawing(drawing) => drawing::insets(from_ref(drawing), cell),
            Self::Stack(stack) => stack.insets(cell),
            // Its cells line up with nothing on the page.
            Self::Grid(_) => Insets::default(),
        }
    }

    fn draw(&self, canvas: &mut Canvas<'_>, cell: &Rect, insets: Insets) -> Drawn {
        match self {
            Self::Chart(sheet) => sheet.draw(canvas, cell, insets),
            Self::Drawing(drawing) => {
                Stage::new(from_ref(drawing), cell, insets).draw(canvas, drawing, cell)
            }
            Self::Stack(stack) => stack.draw(canvas, cell, insets),
            Self::Grid(lattice) => lattice.draw(canvas, cell),
        }
    }
}

/// A panel in its cell.
struct Placed<'a> {
    panel: Ready<'a>,
    row: usize,
    /// None in a row that is stretched, whose cells lie under no column.
    column: Option<usize>,
    cell: Rect,
}

/// A page laid out, ready to be drawn.
pub(crate) struct Page<'a> {
    pub(crate) width: f64,
    pub(crate) height: f64,
    title: Vec<String>,
    /// Lines at the foot, with size and baseline.
    foot: Vec<(String, f64, f64)>,
    panels: Vec<Placed<'a>>,
}

impl<'a> Page<'a> {
    /// Finds a place for everything.
    pub(crate) fn new(figure: &'a Figure) -> Self {
        let columns = figure.columns.clamp(1, figure.panels.len().max(1));
        let gaps = COLUMN_GAP * (columns as f64 - 1.0);
        let inner = if columns == 1 {
            LONE_CELL
        } else {
            CELL * columns as f64 + gaps
        };
        let title = wrapped(&figure.title, TITLE, true, inner);
        let mut y = MARGIN;
        if !title.is_empty() {
            y += title.len() as f64 * TITLE_LEADING * TITLE + 0.55 * TITLE;
        }
        let mut panels = Vec::new();
        for (row, chunk) in figure.panels.chunks(columns).enumerate() {
            let count = chunk.len() as f64;
            let width = (inner - COLUMN_GAP * (count - 1.0)) / count;
            let stretched = chunk.len() < columns;
            let height = chunk
                .iter()
                .map(|panel| wanted_height(panel, width, columns == 1, stretched))
                .fold(0.0, f64::max);
            for (column, panel) in chunk.iter().enumerate() {
                let cell = Rect::sized(
                    MARGIN + column as f64 * (width + COLUMN_GAP),
                    y,
                    width,
                    height,
                );
                let panel = match panel {
                    Panel::Chart(chart) => Ready::Chart(Sheet::new(chart)),
                    Panel::Drawing(drawing) => Ready::Drawing(drawing),
                    Panel::Stack(charts) => Ready::Stack(Stack::new(charts)),
                    Panel::Grid(grid) => Ready::Grid(Box::new(Lattice::new(grid, width))),
                };
                panels.push(Placed {
                    panel,
                    row,
                    column: (!stretched).then_some(column),
                    cell,
                });
            }
            y += height + ROW_GAP;
        }
        let mut foot = Vec::new();
        for (words, size) in [(&figure.caption, CAPTION), (&figure.provenance, PROVENANCE)] {
            for line in wrapped(words, size, false, inner) {
                foot.push((line, size, y + 0.8 * size));
                y += CAPTION_LEADING * size;
            }
        }
        if foot.is_empty() {
            y -= ROW_GAP;
        }
        Self {
            width: inner + 2.0 * MARGIN,
            height: (y + 0.75 * MARGIN).ceil(),
            title,
            foot,
            panels,
        }
    }

    /// Draws it.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>) -> Drawn {
        canvas.rect(&Rect::sized(0.0, 0.0, self.width, self.height), WHITE)?;
        let mut baseline = MARGIN + 0.8 * TITLE;
        for line in &self.title {
            canvas.text(
                line,
                [MARGIN, baseline],
                Type::new(TITLE, INK, Align::Start).bold(),
            )?;
            baseline += TITLE_LEADING * TITLE;
        }
        for (placed, insets) in self.panels.iter().zip(self.aligned()) {
            placed.panel.draw(canvas, &placed.cell, insets)?;
        }
        for (line, size, baseline) in &self.foot {
            let look = Type::new(*size, CAPTION_GREY, Align::Start);
            canvas.text(line, [MARGIN, *baseline], look)?;
        }
        Ok(())
    }

    /// Insets such that plots of a column line up at the sides, and those of a row above and below.
    fn aligned(&self) -> Vec<Insets> {
        let own: Vec<Insets> = self
            .panels
            .iter()
            .map(|p| p.panel.insets(&p.cell))
            .collect();
        let most = |keep: &dyn Fn(&Placed<'_>) -> bool| {
            let of_group = self
                .panels
                .iter()
                .zip(&own)
                .filter(|(p, _)| keep(p))
                .map(|(_, i)| *i);
            of_group.fold(Insets::default(), Insets::max)
        };
        let of = |p: &Placed<'_>, own: &Insets| {
            let beside = if p.column.is_some() {
                most(&|other| other.column == p.column)
            } else {
                *own
            };
            let row = most(&|other| other.row == p.row);
            Insets {
                left: beside.left,
                right: beside.right,
                ..row
            }
        };
        self.panels
            .iter()
            .zip(&own)
            .map(|(p, own)| of(p, own))
            .collect()
    }
}

fn wanted_height(panel: &Panel, width: f64, lone: bool, stretched: bool) -> f64 {
    match panel {
        Panel::Chart(_) if stretched => STRETCHED_HEIGHT * width,
        Panel::Chart(_) if lone => LONE_HEIGHT * width,
        Panel::Chart(_) => chart::HEIGHT * width,
        Panel::Drawing(drawing) => drawing::height(from_ref(drawing), width).min(1000.0),
        Panel::Stack(charts) => Stack::new(charts).height(width),
        Panel::Grid(grid) => Lattice::new(grid, width).height(),
    }
}
