//! The visible curve of each pixel of a page: later ink hides earlier ink.

use crate::curve::steps;
use crate::rect::Rect;

/// Side of a cell in pixels: finer than the width of a line.
const CELL: f64 = 1.0;

/// The ink of a page, cell by cell.
#[derive(Debug)]
pub(crate) struct Ink {
    columns: usize,
    rows: usize,
    cells: Vec<Option<u16>>,
    /// By curve: how many cells it filled when it was drawn.
    drawn: Vec<usize>,
    /// Left, top, right, bottom of all ink.
    extent: [f64; 4],
    /// Whose ink the next is: of a curve by its index; none of axes, words and curves without a name.
    pub(crate) owner: Option<u16>,
}

/// The first cell from a place on; below zero saturates, and a cell counts if its middle is covered.
fn first_cell(v: f64) -> usize {
    (v / CELL + 0.5).floor().max(0.0) as usize
}

impl Ink {
    pub(crate) fn new(size: [f64; 2]) -> Self {
        let [columns, rows] = size.map(|side| (side / CELL).ceil().clamp(1.0, 20_000.0) as usize);
        Self {
            columns,
            rows,
            cells: vec![None; columns * rows],
            drawn: Vec::new(),
            extent: [f64::INFINITY, f64::INFINITY, -f64::INFINITY, -f64::INFINITY],
            owner: None,
        }
    }

    /// A line of a width.
    pub(crate) fn line(&mut self, points: &[[f64; 2]], width: f64) {
        for at in points
            .windows(2)
            .flat_map(|pair| steps([pair[0], pair[1]], CELL, 1e5))
        {
            self.block(&Rect::around(at, 0.5 * width));
        }
    }

    /// A block of cells, such as the box of a disc.
    pub(crate) fn block(&mut self, block: &Rect) {
        let Rect { x0, y0, x1, y1 } = *block;
        self.extend([x0, y0, x1, y1]);
        let columns = first_cell(x0)..first_cell(x1).min(self.columns);
        let rows = first_cell(y0)..first_cell(y1).min(self.rows);
        for row in rows {
            for column in columns.clone() {
                self.cell(row * self.columns + column);
            }
        }
    }

    /// A filled polygon, by the even-odd rule.
    pub(crate) fn polygon(&mut self, points: &[[f64; 2]]) {
        let ys = || points.iter().map(|p| p[1]);
        let (top, bottom) = (
            ys().fold(f64::INFINITY, f64::min),
            ys().fold(-f64::INFINITY, f64::max),
        );
        for [x, y] in points {
            self.extend([*x, *y, *x, *y]);
        }
        let mut y = (top.max(0.0) / CELL).floor() * CELL + 0.5 * CELL;
        while y < bottom.min(self.rows as f64 * CELL) {
            let edges = (0..points.len()).map(|k| [points[k], points[(k + 1) % points.len()]]);
            let crossing = |[a, b]: [[f64; 2]; 2]| {
                let crosses = (a[1] <= y) != (b[1] <= y);
                crosses.then(|| a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
            };
            let mut xs: Vec<f64> = edges.filter_map(crossing).collect();
            xs.sort_by(f64::total_cmp);
            for span in xs.chunks_exact(2) {
                let row = (y / CELL) as usize;
                for column in first_cell(span[0])..first_cell(span[1]).min(self.columns) {
                    self.cell(row * self.columns + column);
                }
            }
            y += CELL;
        }
    }

    /// Notes left, top, right and bottom of new ink.
    fn extend(&mut self, [x0, y0, x1, y1]: [f64; 4]) {
        let [left, top, right, bottom] = self.extent;
        self.extent = [left.min(x0), top.min(y0), right.max(x1), bottom.max(y1)];
    }

    fn cell(&mut self, index: usize) {
        if self.cells[index] == self.owner {
            return;
        }
        self.cells[index] = self.owner;
        if let Some(curve) = self.owner.map(usize::from) {
            self.drawn.resize(self.drawn.len().max(curve + 1), 0);
            self.drawn[curve] += 1;
        }
    }

    /// By curve: the area that it filled when drawn, and the area still visible.
    pub(crate) fn areas(&self, curves: usize) -> Vec<[f64; 2]> {
        let mut visible = vec![0_usize; curves];
        for owner in self.cells.iter().flatten() {
            if let Some(count) = visible.get_mut(usize::from(*owner)) {
                *count += 1;
            }
        }
        let drawn = self.drawn.iter().copied().chain(std::iter::repeat(0));
        let areas = drawn.zip(visible);
        let area = |cells: usize| cells as f64 * CELL * CELL;
        areas
            .map(|(drawn, visible)| [drawn, visible].map(area))
            .collect()
    }

    /// Left, top, right and bottom of all ink.
    pub(crate) fn extent(&self) -> [f64; 4] {
        self.extent
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn later_ink_hides_earlier_ink() {
        let mut ink = Ink::new([100.0, 50.0]);
        ink.owner = Some(0);
        ink.line(&[[10.0, 25.0], [90.0, 25.0]], 4.0);
        ink.owner = Some(1);
        ink.polygon(&[[50.0, 0.0], [120.0, 0.0], [120.0, 50.0], [50.0, 50.0]]);
        let areas = ink.areas(2);
        assert_eq!(areas[0], [84.0 * 4.0, 42.0 * 4.0]);
        assert_eq!(areas[1], [50.0 * 50.0; 2]);
        assert_eq!(ink.extent(), [8.0, 0.0, 120.0, 50.0]);
    }
}
