//! The marks of cells that do not apply or have failed, in a matrix and in its key.

use crate::canvas::{Canvas, LineStyle};
use crate::curve::clipped;
use crate::rect::Rect;
use crate::theme::GRID;

/// Between the lines of a hatched cell.
const HATCH_SPACING: f64 = 11.0;

/// A cell that does not apply.
pub(crate) fn hatched_cell(canvas: &mut Canvas<'_>, area: &Rect) {
    let mut x = area.x0 + 0.5 * HATCH_SPACING;
    while x < area.x1 + area.height() {
        let line = [[x, area.y0], [x - area.height(), area.y1]];
        for part in clipped(line.map(Some), area) {
            canvas.line(&part, LineStyle::solid(GRID, 1.6));
        }
        x += HATCH_SPACING;
    }
    canvas.rect_outline(&area.grown(-0.75), LineStyle::solid(GRID, 1.5));
}
