//! Figures of a trajectory in space: rotations, points, reactions.

use crate::explain::StudyError;
use crate::trajectory::compute::{Column, ComputedTrajectory, Quantity};
use crate::trajectory::figures::{ChartContext, MAX_CURVES, PictureSpan};
use dwell_geometry::BodyId;
use dwell_report::{Chart, Figure, Panel};
use dwell_scene::SpaceScene;

/// Largest distance of two columns that are one but for rounding, in units of the larger.
const SAME: f64 = 1e-9;

/// The figures of a trajectory but that of the mechanism.
///
/// # Errors
/// [`StudyError::Scene`] where the span of the curves is not within the trajectory.
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
    /// Three curves of a vector.
    fn vector(&self, label: &str, of: impl Fn(&Column) -> Option<usize>) -> Option<Chart> {
        let names = ["x", "y", "z"];
        let columns = self.charts.columns_where(|c| of(c).is_some());
        let curves: Vec<(String, usize)> =
            names.map(str::to_owned).into_iter().zip(columns).collect();
        self.charts.chart_of_some("", label, &curves)
    }

    /// Of each body that turns: its rotation, its angular velocity and its angular acceleration.
    fn rotations(&self) -> Vec<Figure> {
        let bodies = 0..self.scene.mechanism.bodies.len();
        let one = |b: usize| {
            let labels = ["rotation", "angular velocity", "angular acceleration"];
            let order_of = |column: &Column, order: usize| match column.quantity {
                Quantity::RotationInSpace(body, k) if body == BodyId(b) && k / 3 == order => {
                    Some(k)
                }
                _ => None,
            };
            let chart = |order: usize| self.vector(labels[order], |c| order_of(c, order));
            let charts: Vec<Chart> = (1..3).filter_map(chart).collect();
            if charts.is_empty() {
                return None;
            }
            let charts: Vec<Chart> = chart(0).into_iter().chain(charts).collect();
            let name = &self.scene.mechanism.bodies[b].name;
            let text = "Components in the ground's axes; the rotation is a vector along its axis whose length is the angle.";
            let title = format!("Rotation of {name}");
            Some(
                self.charts
                    .figure(format!("rotation-{name}"), title, text, vec![charts.into()]),
            )
        };
        bodies.filter_map(one).collect()
    }

    /// Of each point that moves: its position, velocity and acceleration. A point under several names is drawn once.
    fn points(&self) -> Vec<Figure> {
        let mut drawn: Vec<Vec<usize>> = Vec::new();
        let mut figures = Vec::new();
        for (b, points) in self.scene.points.iter().enumerate() {
            for (point, at) in points {
                let columns = self.charts.columns_where(|c| {
                    matches!(c.quantity, Quantity::PointInSpace(body, p, _) if body == BodyId(b) && p == *at)
                });
                let is_known = drawn.iter().any(|other| self.are_one(other, &columns));
                let labels = ["position", "velocity", "acceleration"];
                let chart = |order: usize| {
                    self.vector(labels[order], |c| match c.quantity {
                        Quantity::PointInSpace(body, p, k)
                            if body == BodyId(b) && p == *at && k / 3 == order =>
                        {
                            Some(k)
                        }
                        _ => None,
                    })
                };
                let charts: Vec<Chart> = (1..3).filter_map(chart).collect();
                if is_known || charts.is_empty() {
                    continue;
                }
                drawn.push(columns);
                let charts: Vec<Chart> = chart(0).into_iter().chain(charts).collect();
                let name = format!("{}.{point}", self.scene.mechanism.bodies[b].name);
                let text = "Components in the ground's axes.";
                let title = format!("Point {name}");
                figures.push(self.charts.figure(
                    format!("point-{name}"),
                    title,
                    text,
                    vec![charts.into()],
                ));
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
        let of = |is_force: bool| {
            let columns = self.charts.columns_where(|c| match c.quantity {
                Quantity::ForceMagnitude(_) => is_force,
                Quantity::MomentMagnitude(_) => !is_force,
                _ => false,
            });
            let suffix = if is_force {
                ".magnitude"
            } else {
                ".moment-magnitude"
            };
            let mut curves = self.charts.labelled(&columns, suffix);
            curves.retain(|(_, k)| !self.charts.is_zero(*k));
            curves
        };
        let kinds = [
            ("Magnitudes of joint forces", "force", of(true)),
            ("Magnitudes of joint moments", "moment", of(false)),
        ];
        let mut panels: Vec<Panel> = Vec::new();
        for (title, label, curves) in &kinds {
            let count = curves.len().div_ceil(MAX_CURVES).max(1);
            for some in curves.chunks(curves.len().div_ceil(count).max(1)) {
                panels.push(self.charts.chart(title, label, some).into());
            }
        }
        let text = "The force of each joint's first body on its second, and the moment about the joint's point of the second.";
        (!panels.is_empty()).then(|| {
            self.charts
                .figure("reactions", "Joint reactions", text, panels)
        })
    }
}
