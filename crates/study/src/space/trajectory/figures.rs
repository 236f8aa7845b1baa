//! Figures of a trajectory in space: rotations, points, reactions.

use crate::explain::StudyError;
use crate::trajectory::compute::{Column, ComputedTrajectory, Quantity};
use crate::trajectory::figures::{ChartContext, PictureSpan};
use dwell_geometry::BodyId;
use dwell_report::{Chart, Figure};
use dwell_scene::SpaceScene;

/// Largest difference of two columns that are equal within rounding, relative to the larger.
const SAME: f64 = 1e-9;

/// The figures of a trajectory, except that of the mechanism.
///
/// # Errors
/// [`StudyError::Scene`] if the span of the curves is not within the trajectory.
pub(crate) fn figures(
    scene: &SpaceScene,
    swept: Option<(&str, bool)>,
    computed: &ComputedTrajectory<'_>,
    span: PictureSpan,
) -> Result<Vec<Figure>, StudyError> {
    let charts = ChartContext::new(&scene.file, swept, computed, span)?;
    let of = SpaceFigures {
        scene,
        charts,
        computed,
    };
    let mut figures: Vec<Figure> = of.charts.coordinates().into_iter().collect();
    figures.extend(of.charts.energies());
    figures.extend(of.rotations());
    figures.extend(of.points());
    figures.extend(of.charts.actuator_forces());
    figures.extend(of.reactions());
    figures.extend(of.charts.shaking_force());
    figures.extend(of.charts.power());
    figures.extend(of.charts.drives(&scene.drives));
    Ok(figures)
}

struct SpaceFigures<'a> {
    scene: &'a SpaceScene,
    charts: ChartContext<'a>,
    computed: &'a ComputedTrajectory<'a>,
}

impl SpaceFigures<'_> {
    /// A vector, its velocity and its acceleration, each with three curves, by the order of a column; empty if it does not move.
    fn charts(&self, labels: [&str; 3], order_of: impl Fn(&Column) -> Option<usize>) -> Vec<Chart> {
        let chart = |order: usize| {
            let is_of_order = |c: &Column| order_of(c) == Some(order);
            let names = ["x", "y", "z"].map(str::to_owned).into_iter();
            let columns = self.charts.columns_where(is_of_order);
            let curves: Vec<(String, usize)> = names.zip(columns).collect();
            self.charts.chart_of_some("", labels[order], &curves)
        };
        let rates: Vec<Chart> = (1..3).filter_map(chart).collect();
        let vector = chart(0).filter(|_| !rates.is_empty());
        vector.into_iter().chain(rates).collect()
    }

    /// Figures of each body that turns: its rotation, its angular velocity and its angular acceleration.
    fn rotations(&self) -> Vec<Figure> {
        let bodies = 0..self.scene.mechanism.bodies.len();
        let one = |b: usize| {
            let labels = ["rotation", "angular velocity", "angular acceleration"];
            let charts = self.charts(labels, |column| match column.quantity {
                Quantity::Rotation(body, order, _) if body == BodyId(b) => Some(order),
                _ => None,
            });
            let name = &self.scene.mechanism.bodies[b].name;
            let text = "Components in the ground's axes; the rotation is a vector along its axis whose length is the angle.";
            let (file, title) = (format!("rotation-{name}"), format!("Rotation of {name}"));
            (!charts.is_empty()).then(|| {
                let panels = vec![charts.into()];
                self.charts.figure(file, title, text, panels)
            })
        };
        bodies.filter_map(one).collect()
    }

    /// Figures of each point that moves: its position, velocity and acceleration. A point under several names is drawn
    /// once.
    fn points(&self) -> Vec<Figure> {
        let mut drawn: Vec<Vec<usize>> = Vec::new();
        let mut figures = Vec::new();
        for (b, points) in self.scene.points.iter().enumerate() {
            for (point, at) in points {
                let order_of = |column: &Column| match column.quantity {
                    Quantity::Point(body, p, order, _)
                        if body == BodyId(b) && p == [at.x, at.y, at.z] =>
                    {
                        Some(order)
                    }
                    _ => None,
                };
                let columns = self.charts.columns_where(|c| order_of(c).is_some());
                let is_known = drawn.iter().any(|other| self.are_one(other, &columns));
                let charts = self.charts(["position", "velocity", "acceleration"], order_of);
                if is_known || charts.is_empty() {
                    continue;
                }
                drawn.push(columns);
                let name = format!("{}.{point}", self.scene.mechanism.bodies[b].name);
                let text = "Components in the ground's axes.";
                let (file, title) = (format!("point-{name}"), format!("Point {name}"));
                let panels = vec![charts.into()];
                figures.push(self.charts.figure(file, title, text, panels));
            }
        }
        figures
    }

    /// Whether some columns have the values of others.
    fn are_one(&self, some: &[usize], others: &[usize]) -> bool {
        let rows = &self.computed.results.rows;
        let alike = |(&a, &b): (&usize, &usize)| {
            rows.iter()
                .all(|row| (row[a] - row[b]).abs() <= SAME * (1.0 + row[a].abs()))
        };
        some.len() == others.len() && some.iter().zip(others).all(alike)
    }

    /// Magnitudes of the forces and moments of the joints.
    fn reactions(&self) -> Option<Figure> {
        let charts = &self.charts;
        let forces = charts.columns_where(|c| matches!(c.quantity, Quantity::ForceMagnitude(_)));
        let moments = charts.columns_where(|c| matches!(c.quantity, Quantity::MomentMagnitude(_)));
        let forces = charts.labelled(&forces, ".magnitude");
        let moments = charts.labelled(&moments, ".moment-magnitude");
        let mut panels = charts.even_charts("Magnitudes of joint forces", "force", forces);
        panels.extend(charts.even_charts("Magnitudes of joint moments", "moment", moments));
        let text = "The force of each joint's first body on its second, and the moment about the joint's point of the second.";
        (!panels.is_empty()).then(|| charts.figure("reactions", "Joint reactions", text, panels))
    }
}
