//! Charts one below another over one horizontal axis.

use crate::canvas::{Canvas, Drawn};
use crate::chart::Sheet;
use crate::figure::Chart;
use crate::rect::{Insets, Rect};

/// Height of each plot in pixels, whatever its width: a few ticks, and a curve's shape.
const PLOT: f64 = 240.0;

/// The charts of a stack with their spans found, the uppermost first.
pub(crate) struct Stack<'a> {
    sheets: Vec<Sheet<'a>>,
}

impl<'a> Stack<'a> {
    pub(crate) fn new(charts: &'a [Chart]) -> Self {
        Self {
            sheets: Sheet::stacked(charts),
        }
    }

    /// Height of the cell that suits the stack at this width.
    pub(crate) fn height(&self, width: f64) -> f64 {
        let plots = PLOT * self.sheets.len() as f64;
        plots + strips(&self.own(&Rect::sized(0.0, 0.0, width, plots)))
    }

    /// What every chart needs in a cell of this width. What it needs at the sides is right only if the height is its
    /// own, as that decides about ticks.
    fn own(&self, cell: &Rect) -> Vec<Insets> {
        self.sheets.iter().map(|s| s.insets(cell)).collect()
    }

    /// Strips the labels need around the whole stack.
    pub(crate) fn insets(&self, cell: &Rect) -> Insets {
        let parts = parts(cell, self.own(cell));
        let own = self
            .sheets
            .iter()
            .zip(&parts)
            .map(|(s, (part, _))| s.insets(part));
        let widest = own.fold(Insets::default(), Insets::max);
        Insets {
            top: parts.first().map_or(0.0, |(_, first)| first.top),
            bottom: parts.last().map_or(0.0, |(_, last)| last.bottom),
            ..widest
        }
    }

    /// Draws the charts with plots of one height.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>, cell: &Rect, insets: Insets) -> Drawn {
        for (sheet, (part, own)) in self.sheets.iter().zip(self.laid_out(cell, insets)) {
            sheet.draw(canvas, &part, own)?;
        }
        Ok(())
    }

    /// The part of each chart, whose outer strips line up with what is beside the stack.
    fn laid_out(&self, cell: &Rect, insets: Insets) -> Vec<(Rect, Insets)> {
        let mut own = self.own(cell);
        for own in &mut own {
            (own.left, own.right) = (insets.left, insets.right);
        }
        if let Some(first) = own.first_mut() {
            first.top = insets.top;
        }
        if let Some(last) = own.last_mut() {
            last.bottom = insets.bottom;
        }
        parts(cell, own)
    }
}

/// Height of what stands above and below the plots.
fn strips(own: &[Insets]) -> f64 {
    own.iter().map(|own| own.top + own.bottom).sum()
}

/// The cell divided so that all plots have one height.
fn parts(cell: &Rect, own: Vec<Insets>) -> Vec<(Rect, Insets)> {
    let plot = (cell.height() - strips(&own)) / own.len().max(1) as f64;
    let mut y = cell.y0;
    let part = |own: Insets| {
        let height = own.top + plot + own.bottom;
        y += height;
        let part = Rect::sized(cell.x0, y - height, cell.width(), height);
        (part, own)
    };
    own.into_iter().map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::{Axis, Series};
    use crate::fonts;

    #[test]
    fn plots_have_one_height_and_follow_each_other() {
        fonts::ready().unwrap();
        let chart = |title: &str, high: f64| Chart {
            title: title.to_owned(),
            x: Axis::new("t", "s"),
            y: Axis::new("y", "m"),
            series: vec![Series::line("", vec![[0.0, 0.0], [1.0, high]])],
            ..Chart::default()
        };
        let charts = [chart("Motion", 1.0), chart("", 1e-5), chart("Titled", 1e6)];
        let stack = Stack::new(&charts);
        let cell = Rect::sized(10.0, 20.0, 900.0, stack.height(900.0));
        let insets = stack.insets(&cell);
        let plots: Vec<Rect> = stack
            .laid_out(&cell, insets)
            .into_iter()
            .map(|(part, own)| part.inside(own))
            .collect();
        for plot in &plots {
            // A sum of strips and its differences round in the last digits of a thousand.
            assert!((plot.height() - PLOT).abs() < 1e-9);
            assert_eq!((plot.x0, plot.x1), (plots[0].x0, plots[0].x1));
            assert!(cell.holds(plot));
        }
        assert!(plots.windows(2).all(|pair| pair[1].y0 > pair[0].y1));
    }

    #[test]
    fn one_axis_shows_what_any_chart_has() {
        let early = Series::line("", vec![[0.0, 1.0], [2.0, 3.0]]);
        let late = Series::line("", vec![[1.0, 1.0], [5.0, 3.0]]);
        let charts = [early, late].map(|series| Chart {
            series: vec![series],
            ..Chart::default()
        });
        let sheets = Sheet::stacked(&charts);
        assert!(
            sheets
                .iter()
                .all(|s| s.shows(0.0) && s.shows(5.0) && !s.shows(5.1))
        );
        assert!(Sheet::stacked(&[]).is_empty());
    }
}
