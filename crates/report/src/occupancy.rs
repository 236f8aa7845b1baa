//! The occupied parts of a plot, which labels avoid.

use crate::curve::steps;
use crate::rect::Rect;
use std::ops::Range;

/// Side of a cell in pixels.
const CELL: f64 = 5.0;

/// Cells of a plot that hold data or words.
#[derive(Debug, Clone)]
pub(crate) struct Occupancy {
    area: Rect,
    columns: usize,
    rows: usize,
    occupied: Vec<bool>,
}

impl Occupancy {
    /// Nothing drawn yet.
    pub(crate) fn new(area: Rect) -> Self {
        let cells = |length: f64| ((length / CELL).ceil().clamp(1.0, 4000.0)) as usize;
        let (columns, rows) = (cells(area.width()), cells(area.height()));
        Self {
            area,
            columns,
            rows,
            occupied: vec![false; columns * rows],
        }
    }

    /// A line has been drawn.
    pub(crate) fn line(&mut self, points: &[[f64; 2]]) {
        for pair in points.windows(2) {
            steps([pair[0], pair[1]], 0.5 * CELL, 1e4).for_each(|at| self.point(at));
        }
    }

    /// A point has been drawn.
    pub(crate) fn point(&mut self, at: [f64; 2]) {
        if self.area.contains(at) {
            let (column, row) = self.cell(at);
            self.occupied[row * self.columns + column] = true;
        }
    }

    /// A block, such as a text, has been drawn.
    pub(crate) fn block(&mut self, block: &Rect) {
        for row in self.rows_of(block) {
            self.occupied[row].fill(true);
        }
    }

    /// How many taken cells lie in the block.
    pub(crate) fn count(&self, block: &Rect) -> usize {
        let cells = self.rows_of(block).flat_map(|row| &self.occupied[row]);
        cells.filter(|&&occupied| occupied).count()
    }

    fn cell(&self, [x, y]: [f64; 2]) -> (usize, usize) {
        // A negative or NaN quotient saturates to 0.
        let column = ((x - self.area.x0) / CELL) as usize;
        let row = ((y - self.area.y0) / CELL) as usize;
        (column.min(self.columns - 1), row.min(self.rows - 1))
    }

    /// The cells of a block, row by row; none where it is outside.
    fn rows_of(&self, block: &Rect) -> impl Iterator<Item = Range<usize>> + use<> {
        let (first, last) = (
            self.cell([block.x0, block.y0]),
            self.cell([block.x1, block.y1]),
        );
        let rows = if self.area.intersects(block) {
            first.1..last.1 + 1
        } else {
            0..0
        };
        let columns = self.columns;
        rows.map(move |row| row * columns + first.0..row * columns + last.0 + 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_takes_the_cells_it_crosses_and_no_other() {
        let mut map = Occupancy::new(Rect::sized(10.0, 20.0, 200.0, 100.0));
        map.line(&[[10.0, 20.0], [210.0, 120.0]]);
        assert!(map.count(&Rect::sized(100.0, 60.0, 20.0, 20.0)) > 0);
        assert_eq!(map.count(&Rect::sized(150.0, 25.0, 50.0, 30.0)), 0);
        assert_eq!(map.count(&Rect::sized(500.0, 500.0, 50.0, 30.0)), 0);
    }

    #[test]
    fn a_steep_line_between_two_points_is_seen_too() {
        let mut map = Occupancy::new(Rect::sized(0.0, 0.0, 100.0, 100.0));
        map.line(&[[50.0, -1e4], [50.0, 1e4]]);
        assert!(map.count(&Rect::sized(40.0, 40.0, 20.0, 20.0)) > 0);
    }
}
