//! Figures in another unit, such as the scene's unit of length.

use crate::animation::Animation;
use crate::axis::Axis;
use crate::figure::{Chart, Figure, Mark, Panel};
use crate::shape::{Drawing, Shape};

/// A unit, the other unit, and the conversion factor.
type Change<'a> = (&'a str, &'a str, f64);

impl Figure {
    /// Converts every axis in `unit`, `unit/s` or `unit/s²` into `other`, `other/s` or `other/s²`; one `unit` is `factor` `other`.
    pub fn change_unit(&mut self, unit: &str, other: &str, factor: f64) {
        let change = (unit, other, factor);
        for panel in &mut self.panels {
            match panel {
                Panel::Chart(chart) => change_chart(chart, change),
                Panel::Stack(charts) => charts.iter_mut().for_each(|c| change_chart(c, change)),
                Panel::Drawing(drawing) => change_drawing(drawing, change),
                Panel::Grid(_) | Panel::Tiles(_) => {}
            }
        }
    }
}

impl Animation {
    /// As [`Figure::change_unit`].
    pub fn change_unit(&mut self, unit: &str, other: &str, factor: f64) {
        let frames = self.frames.iter_mut();
        frames.for_each(|frame| change_drawing(frame, (unit, other, factor)));
    }
}

/// Converts an axis, and returns the factor of its values.
fn change_axis(axis: &mut Axis, (unit, other, factor): Change<'_>) -> f64 {
    let rest = axis.unit.strip_prefix(unit).unwrap_or("no such unit");
    if !(rest.is_empty() || rest.starts_with('/')) {
        return 1.0;
    }
    axis.unit = format!("{other}{rest}");
    axis.range = axis.range.map(|ends| ends.map(|end| end * factor));
    factor
}

fn change_chart(chart: &mut Chart, change: Change<'_>) {
    let x = change_axis(&mut chart.x, change);
    let y = change_axis(&mut chart.y, change);
    let y2 = chart
        .y2
        .as_mut()
        .map_or(y, |axis| change_axis(axis, change));
    for series in &mut chart.series {
        let y = if series.right_axis { y2 } else { y };
        series.points.iter_mut().for_each(|p| scale(p, [x, y]));
    }
    for mark in &mut chart.marks {
        match mark {
            Mark::Vertical { at, .. } => *at *= x,
            Mark::Horizontal { at, .. } => *at *= y,
            Mark::Band { from, to, .. } => {
                *from *= x;
                *to *= x;
            }
            Mark::Slope { through: at, .. } | Mark::Point { at, .. } | Mark::Text { at, .. } => {
                scale(at, [x, y]);
            }
        }
    }
}

fn change_drawing(drawing: &mut Drawing, change: Change<'_>) {
    let factors = [&mut drawing.x, &mut drawing.y].map(|axis| change_axis(axis, change));
    for shape in &mut drawing.shapes {
        match shape {
            Shape::Polyline { points, .. } => points.iter_mut().for_each(|p| scale(p, factors)),
            Shape::Disc { at, .. } | Shape::GroundPin { at } | Shape::Text { at, .. } => {
                scale(at, factors);
            }
            Shape::GroundLine { from, to } | Shape::Arrow { from, to, .. } => {
                scale(from, factors);
                scale(to, factors);
            }
        }
    }
}

fn scale(at: &mut [f64; 2], factors: [f64; 2]) {
    at.iter_mut()
        .zip(factors)
        .for_each(|(v, factor)| *v *= factor);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::figure::Series;

    #[test]
    fn lengths_and_speeds_change_and_nothing_else() {
        let mut chart = Chart {
            x: Axis::new("travel", "m").with_range(0.0, 0.5),
            y: Axis::new("velocity", "m/s"),
            y2: Some(Axis::new("ratio of mm", "mm")),
            series: vec![
                Series::line("v", vec![[0.25, 2.0]]),
                Series::line("r", vec![[0.25, 2.0]]).right(),
            ],
            marks: vec![Mark::vertical(0.5, "end"), Mark::horizontal(3.0, "")],
            ..Chart::default()
        };
        change_chart(&mut chart, ("m", "mm", 1e3));
        let units = (chart.x.unit.as_str(), chart.y.unit.as_str());
        assert_eq!((units, chart.x.range), (("mm", "mm/s"), Some([0.0, 500.0])));
        assert_eq!(chart.series[0].points, [[250.0, 2000.0]]);
        assert_eq!(chart.series[1].points, [[250.0, 2.0]]);
        let marks = [Mark::vertical(500.0, "end"), Mark::horizontal(3000.0, "")];
        assert_eq!(chart.marks, marks);
    }
}
