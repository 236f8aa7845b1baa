//! Angles, paths and travels, with their speeds and accelerations.

use crate::ranges::extent;
use crate::trajectory::compute::{Analysis, Quantity, RowScene as _, lifted};
use crate::trajectory::figures::{FigureContext, MAX_BODIES, MAX_CURVES};
use dwell_geometry::BodyId;
use dwell_report::{Chart, Figure, Mark, Paint};
use std::f64::consts::TAU;

/// Bodies that turn more often have a separate chart.
const MAX_SHARED_TURNS: f64 = 1.25;

impl FigureContext<'_> {
    pub(crate) fn angles(&self) -> Option<Figure> {
        let bodies = (0..self.scene.mechanism.bodies.len()).map(BodyId);
        let angle = |body, order| {
            self.results
                .column_index(Quantity::Rotation(body, order, 2))
        };
        let rotates = |body: &BodyId| {
            let Some(k) = angle(*body, 0) else {
                // Only its velocity or acceleration is requested.
                return (1..3).any(|order| angle(*body, order).is_some());
            };
            let mut rows = self.results.rows.iter();
            let start = self.results.rows.first().map_or(0.0, |row| row[k]);
            // A translating body rotates by rounding only.
            rows.any(|row| (row[k] - start).abs() > 1e-9)
        };
        let all: Vec<BodyId> = bodies.filter(rotates).collect();
        let requests = self.scene.requests();
        let is_requested = |body: &BodyId| {
            let mut columns = (0..3).filter_map(|order| angle(*body, order));
            columns.any(|k| requests.name(&self.results.columns[k]))
        };
        let all = self.distinct_bodies(&all, angle);
        let requested: Vec<BodyId> = all.iter().copied().filter(is_requested).collect();
        let shown = if requested.is_empty() {
            self.of_interest_first(&all, MAX_BODIES)
        } else {
            self.of_interest_first(&requested, MAX_CURVES)
        };
        let curves = |order: usize, label: &str| {
            let indices: Vec<usize> = shown.iter().filter_map(|b| angle(*b, order)).collect();
            let suffix = format!(".{}", label.replace(' ', "_"));
            self.labelled(&indices, &suffix)
        };
        let mut charts = self.angle_charts(&curves(0, "angle"));
        let rates = ["angular velocity", "angular acceleration"];
        let rates = rates
            .iter()
            .zip(1..)
            .map(|(label, order)| (*label, curves(order, label)));
        charts.extend(rates.filter_map(|(label, curves)| self.chart_of_some("", label, &curves)));
        let text = match all.len() - shown.len() {
            0 => "Angles of the bodies from the ground, with their speeds and accelerations."
                .to_owned(),
            n => {
                format!("Angles of the bodies from the ground; those of {n} more are in the table.")
            }
        };
        (!charts.is_empty()).then(|| self.figure("angles", "Angles", &text, vec![charts.into()]))
    }

    /// Curves of many turns have a separate chart, because they would flatten those within one turn.
    fn angle_charts(&self, curves: &[(String, usize)]) -> Vec<Chart> {
        let turns_often = |k: usize| {
            let [low, high] = extent(self.drawn_rows().map(|row| row[k]));
            high - low > MAX_SHARED_TURNS * TAU
        };
        let of = |often: bool| {
            let of = curves
                .iter()
                .zip(0..)
                .filter(|((_, k), _)| turns_often(*k) == often);
            let (some, colors): (Vec<_>, Vec<usize>) = of.map(|(c, i)| (c.clone(), i)).unzip();
            let label = match some.as_slice() {
                [(name, _)] if curves.len() > 1 => format!("angle of {name}"),
                _ => "angle".to_owned(),
            };
            let mut chart = self.chart_of_some("", &label, &some)?;
            // As in the charts of the speeds.
            for (series, i) in chart.series.iter_mut().zip(colors).filter(|(_, i)| *i < 6) {
                series.color = Some(Paint::Palette(i));
            }
            Some(chart)
        };
        [true, false].into_iter().filter_map(of).collect()
    }

    /// At most `count` of some bodies, in their order; those with a requested path come first.
    fn of_interest_first(&self, bodies: &[BodyId], count: usize) -> Vec<BodyId> {
        let paths = &self.scene.requests.paths;
        let mut chosen = bodies.to_vec();
        chosen.sort_by_key(|body| !paths.iter().any(|path| path.body == *body));
        chosen.truncate(count);
        chosen.sort_by_key(|body| body.0);
        chosen
    }

    /// The bodies without those that rotate exactly as an earlier one.
    fn distinct_bodies(
        &self,
        bodies: &[BodyId],
        angle: impl Fn(BodyId, usize) -> Option<usize>,
    ) -> Vec<BodyId> {
        let mut distinct: Vec<BodyId> = Vec::new();
        for &body in bodies {
            let same = |other: &BodyId| {
                let both = angle(body, 0).zip(angle(*other, 0));
                let mut rows = self.results.rows.iter();
                both.is_some_and(|(a, b)| rows.all(|row| (row[a] - row[b]).abs() < 1e-9))
            };
            if !distinct.iter().any(same) {
                distinct.push(body);
            }
        }
        distinct
    }

    pub(crate) fn paths(&self) -> Vec<Figure> {
        let one = |path: &dwell_scene::PathPoint| {
            let labels = ["position", "velocity", "acceleration"];
            let chart = |order: usize| {
                let indices = self.columns_where(|c| {
                    matches!(c.quantity, Quantity::Point(b, at, of, _)
                        if b == path.body && at == lifted(path.at) && of == order)
                });
                let names = ["x", "y"].map(str::to_owned);
                // Two names of one point are drawn once.
                let curves: Vec<_> = names.into_iter().zip(indices).collect();
                self.chart_of_some("", labels[order], &curves)
            };
            let charts: Vec<Chart> = (0..3).filter_map(chart).collect();
            let body = self.scene.mechanism.body_name(path.body);
            let title = format!("Point {body}.{}", path.name);
            let name = format!("path-{body}.{}", path.name);
            let text = "Components in the ground's axes.";
            (!charts.is_empty()).then(|| self.figure(name, title, text, vec![charts.into()]))
        };
        self.scene.requests.paths.iter().filter_map(one).collect()
    }

    /// Lengths and travels: of actuators, named coordinates and joints.
    pub(crate) fn lengths(&self) -> Option<Figure> {
        let of_order = |order: usize, unit: &str| {
            self.columns_where(|c| {
                use Quantity::{ActuatorCoordinate, Measured};
                let is_of_order =
                    matches!(c.quantity, ActuatorCoordinate(_, o) | Measured(_, o) if o == order);
                is_of_order && c.unit == unit
            })
        };
        // A travel that also has a coordinate name is drawn once.
        let mut kept: Vec<(String, usize)> = Vec::new();
        for (name, k) in self.labelled(&of_order(0, "m"), "") {
            let rows = &self.results.rows;
            let is_same = |other: usize| rows.iter().all(|row| row[k] == row[other]);
            let is_known = kept.iter().any(|&(_, other)| is_same(other));
            if !is_known && kept.len() < MAX_BODIES {
                kept.push((name, k));
            }
        }
        let kinds = [
            ("m", "travel", ""),
            ("m/s", "velocity", ".velocity"),
            ("m/s2", "acceleration", ".acceleration"),
        ];
        let chart = |(order, (unit, label, suffix))| {
            let mut curves = self.labelled(&of_order(order, unit), suffix);
            curves.retain(|(name, _)| kept.iter().any(|(k, _)| k == name));
            self.chart_of_some("", label, &curves)
        };
        let charts: Vec<Chart> = kinds.into_iter().enumerate().filter_map(chart).collect();
        let text = "Travels of joints and lengths, with their speeds and accelerations.";
        let title = "Travels and lengths";
        (!charts.is_empty()).then(|| self.figure("travels", title, text, vec![charts.into()]))
    }

    pub(crate) fn transmission(&self) -> Option<Figure> {
        let mut indices =
            self.columns_where(|c| matches!(c.quantity, Quantity::TransmissionAngle(_)));
        indices.truncate(MAX_CURVES);
        if indices.is_empty() || self.analysis != Analysis::Kinematics {
            return None;
        }
        let curves = self.labelled(&indices, ".transmission_angle");
        let mut chart = self.chart("", "transmission angle", &curves);
        chart.marks.push(Mark::Horizontal {
            at: 90.0,
            label: "optimum".to_owned(),
        });
        let text = "The angle between the two bodies of a dyad at their pin, or between a rod and the normal of its slide.";
        let panels = vec![chart.into()];
        Some(self.figure("transmission-angles", "Transmission angles", text, panels))
    }
}
