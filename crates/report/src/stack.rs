//! Charts one below another over one horizontal axis.

use crate::canvas::Canvas;
use crate::chart::PreparedChart;
use crate::figure::Chart;
use crate::rect::{Insets, Rect};

/// Height of each plot in pixels, for any width: enough for a few ticks and the shape of a curve.
const PLOT_HEIGHT: f64 = 240.0;

/// The charts of a stack with their spans found, the uppermost first.
pub(crate) struct Stack<'a> {
    charts: Vec<PreparedChart<'a>>,
}

impl<'a> Stack<'a> {
    pub(crate) fn new(charts: &'a [Chart]) -> Self {
        Self {
            charts: PreparedChart::stacked(charts),
        }
    }

    /// Height of the cell that suits the stack at this width.
    pub(crate) fn height(&self, width: f64) -> f64 {
        let plots = PLOT_HEIGHT * self.charts.len() as f64;
        plots + label_height(&self.chart_insets(&Rect::sized(0.0, 0.0, width, plots)))
    }

    /// What every chart needs in a cell of this width. What it needs at the sides is right only if the height is its
    /// own, as that decides about ticks.
    fn chart_insets(&self, cell: &Rect) -> Vec<Insets> {
        self.charts.iter().map(|s| s.insets(cell)).collect()
    }

    /// Strips the labels need around the whole stack.
    pub(crate) fn insets(&self, cell: &Rect) -> Insets {
        let parts = divided(cell, self.chart_insets(cell));
        let charts = self.charts.iter().zip(&parts);
        let needed = charts.map(|(s, (part, _))| s.insets(part));
        let widest = needed.fold(Insets::default(), Insets::max);
        Insets {
            top: parts.first().map_or(0.0, |(_, first)| first.top),
            bottom: parts.last().map_or(0.0, |(_, last)| last.bottom),
            ..widest
        }
    }

    /// Draws the charts with plots of one height.
    pub(crate) fn draw(&self, canvas: &mut Canvas<'_>, cell: &Rect, insets: Insets) {
        for (chart, (part, needed)) in self.charts.iter().zip(self.chart_cells(cell, insets)) {
            chart.draw(canvas, &part, needed);
        }
    }

    /// The part of each chart, whose outer strips line up with what is beside the stack.
    fn chart_cells(&self, cell: &Rect, insets: Insets) -> Vec<(Rect, Insets)> {
        let mut needed = self.chart_insets(cell);
        for needed in &mut needed {
            (needed.left, needed.right) = (insets.left, insets.right);
        }
        if let Some(first) = needed.first_mut() {
            first.top = insets.top;
        }
        if let Some(last) = needed.last_mut() {
            last.bottom = insets.bottom;
        }
        divided(cell, needed)
    }
}

/// Height of what stands above and below the plots.
fn label_height(insets: &[Insets]) -> f64 {
    insets.iter().map(|insets| insets.top + insets.bottom).sum()
}

/// The cell divided so that all plots have one height.
fn divided(cell: &Rect, insets: Vec<Insets>) -> Vec<(Rect, Insets)> {
    let plot = (cell.height() - label_height(&insets)) / insets.len().max(1) as f64;
    let mut y = cell.y0;
    let part = |insets: Insets| {
        let height = insets.top + plot + insets.bottom;
        y += height;
        let part = Rect::sized(cell.x0, y - height, cell.width(), height);
        (part, insets)
    };
    insets.into_iter().map(part).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::axis::Axis;
    use crate::figure::Series;

    #[test]
    fn plots_have_one_height_and_follow_each_other() {
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
            .chart_cells(&cell, insets)
            .into_iter()
            .map(|(part, needed)| part.inset(needed))
            .collect();
        for plot in &plots {
            // A sum of strips and its differences round in the last digits of a thousand.
            assert!((plot.height() - PLOT_HEIGHT).abs() < 1e-9);
            assert_eq!((plot.x0, plot.x1), (plots[0].x0, plots[0].x1));
            assert!(cell.contains_rect(plot));
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
        let prepared = PreparedChart::stacked(&charts);
        assert!(
            prepared
                .iter()
                .all(|s| (s.extent.x.min..=s.extent.x.max) == (0.0..=5.0))
        );
        assert!(PreparedChart::stacked(&[]).is_empty());
    }
}
