//! The last revolution of a long motion: ten of them over one axis cannot be read.

use super::charts::ChartContext;
use crate::trajectory::compute::{Quantity, TrajectoryResults};
use dwell_report::{Figure, Panel};
use std::f64::consts::TAU;

/// Revolutions up to which a motion is drawn as a whole only.
const MAX_REVOLUTIONS: f64 = 6.0;
/// Rows of the last revolution from which on its curves have a shape.
const MIN_ROWS: usize = 20;
/// Panels whose last revolutions still fit on the page.
const MAX_PANELS: usize = 5;

/// The first row of the last revolution, where the first driving angle goes through many.
pub(super) fn last_revolution(results: &TrajectoryResults) -> Option<usize> {
    let (rows, last) = (&results.rows, results.rows.last()?);
    let angle = results.column_index(Quantity::ActuatorCoordinate(0, 0))?;
    let turned = |row: &Vec<f64>| (last[angle] - row[angle]).abs() / TAU;
    let turns_often = results.columns[angle].unit == "rad" && turned(&rows[0]) > MAX_REVOLUTIONS;
    let first = rows.iter().rposition(|row| turned(row) >= 1.0 - 1e-9);
    first.filter(|first| turns_often && rows.len() - first > MIN_ROWS)
}

impl ChartContext<'_> {
    /// Shows the last revolution in addition to the whole motion, in panels over the abscissa.
    pub(super) fn with_last_revolution(&self, mut figure: Figure) -> Figure {
        let first = self.last_revolution.unwrap_or(usize::MAX);
        let places = self.abscissa_values.get(first..);
        let Some([from, .., to]) = places.filter(|_| figure.panels.len() <= MAX_PANELS) else {
            return figure;
        };
        for panel in std::mem::take(&mut figure.panels) {
            let part = self.part(panel.clone(), [*from, *to]);
            figure.columns = 1 + usize::from(part.is_some());
            let both = [Some(panel), part];
            figure.panels.extend(both.into_iter().flatten());
        }
        figure
    }

    /// A part of a panel; none of a phase portrait, which has another abscissa.
    fn part(&self, mut panel: Panel, ends: [f64; 2]) -> Option<Panel> {
        let charts = match &mut panel {
            Panel::Chart(chart) => std::slice::from_mut(chart),
            Panel::Stack(charts) => charts,
            Panel::Drawing(_) | Panel::Grid(_) | Panel::Tiles(_) => return None,
        };
        let [from, to] = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        let charts = Some(charts).filter(|all| all.iter().all(|chart| chart.x == self.x))?;
        for chart in charts.iter_mut() {
            chart.x.range = Some(ends);
            for series in &mut chart.series {
                series.points.retain(|[x, _]| (from..=to).contains(x));
            }
        }
        let title = &mut charts.first_mut()?.title;
        *title = match title.as_str() {
            "" => "Last revolution".to_owned(),
            title => format!("{title}, last revolution"),
        };
        Some(panel)
    }
}
