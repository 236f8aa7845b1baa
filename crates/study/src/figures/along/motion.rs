//! Angles, paths and travels, with their speeds and accelerations.

use super::{BODIES, Sheet, TOGETHER};
use crate::run::{Command, Quantity};
use dwell_geometry::BodyId;
use dwell_report::{Chart, Figure, Mark};

impl Sheet<'_> {
    pub(super) fn angles(&self) -> Option<Figure> {
        let bodies = (0..self.scene.mechanism.bodies.len()).map(BodyId);
        let angle = |body: BodyId, order: usize| {
            let columns = &self.record.columns;
            columns
                .iter()
                .position(|c| c.quantity == Quantity::Angle(body, order))
        };
        let turns = |body: &BodyId| {
            let Some(k) = angle(*body, 0) else {
                return false;
            };
            let start = self.record.rows.first().map_or(0.0, |row| row[k]);
            // A sliding body turns by rounding alone.
            self.record
                .rows
                .iter()
                .any(|row| (row[k] - start).abs() > 1e-9)
        };
        let all: Vec<BodyId> = bodies.filter(turns).collect();
        let wanted = |body: &BodyId| {
            let orders = (0..3).filter_map(|order| angle(*body, order));
            orders
                .into_iter()
                .any(|k| self.is_wanted(&self.record.columns[k]))
        };
        let all = self.apart(&all, angle);
        let asked: Vec<BodyId> = all.iter().copied().filter(wanted).collect();
        let few = if asked.is_empty() {
            &all[..all.len().min(BODIES)]
        } else {
            &asked[..asked.len().min(TOGETHER)]
        };
        let chart = |order: usize, cut: &str, label: &str| {
            let places: Vec<usize> = few.iter().filter_map(|b| angle(*b, order)).collect();
            (!places.is_empty()).then(|| self.chart("", label, &self.named(&places, cut)))
        };
        let charts: Vec<Chart> = [
            chart(0, ".angle", "angle"),
            chart(1, ".speed", "speed"),
            chart(2, ".acceleration", "acceleration"),
        ]
        .into_iter()
        .flatten()
        .collect();
        let left_out = all.len() - few.len();
        let words = match left_out {
            0 => "Angles of the bodies from the ground, with their speeds and accelerations."
                .to_owned(),
            n => format!("Angles of the bodies from the ground; {n} more are in the table."),
        };
        (!charts.is_empty()).then(|| {
            let title = "Angles".to_owned();
            self.figure("b-angles".to_owned(), title, &words, vec![charts.into()])
        })
    }

    /// Some bodies without those that turn as another one before them does.
    fn apart(
        &self,
        bodies: &[BodyId],
        angle: impl Fn(BodyId, usize) -> Option<usize>,
    ) -> Vec<BodyId> {
        let mut apart: Vec<BodyId> = Vec::new();
        for &body in bodies {
            let same = |other: &BodyId| {
                let both = angle(body, 0).zip(angle(*other, 0));
                let mut rows = self.record.rows.iter();
                both.is_some_and(|(a, b)| rows.all(|row| (row[a] - row[b]).abs() < 1e-9))
            };
            if !apart.iter().any(same) {
                apart.push(body);
            }
        }
        apart
    }

    pub(super) fn paths(&self) -> Vec<Figure> {
        let one = |path: &dwell_scene::PathPoint| {
            let labels = ["position", "velocity", "acceleration"];
            let chart = |order: usize| {
                let places = self.places(|c| {
                    matches!(c.quantity, Quantity::Point(b, at, k)
                        if b == path.body && at == path.at && k / 2 == order)
                });
                let names = ["x", "y"].map(str::to_owned);
                // Two names of one place are one point.
                let curves: Vec<_> = names.into_iter().zip(places.iter().copied()).collect();
                (!curves.is_empty()).then(|| self.chart("", labels[order], &curves))
            };
            let charts: Vec<Chart> = (0..3).filter_map(chart).collect();
            let body = self.scene.mechanism.body_name(path.body);
            let point = format!("{body}.{}", path.name);
            let words = "Components in the ground's axes.";
            let name = format!("c-path-{body}-{}", path.name);
            self.figure(name, format!("Point {point}"), words, vec![charts.into()])
        };
        self.scene.requests.paths.iter().map(one).collect()
    }

    /// Lengths and travels: of actuators, named coordinates and joints.
    pub(super) fn lengths(&self) -> Option<Figure> {
        let of_order = |order: usize, unit: &str| {
            self.places(|c| {
                let (Quantity::Drive(_, o) | Quantity::Measured(_, o)) = c.quantity else {
                    return false;
                };
                o == order && c.unit == unit
            })
        };
        // A travel that has a name of its own is drawn once.
        let mut kept: Vec<(String, usize)> = Vec::new();
        for (name, k) in self.named(&of_order(0, "m"), "") {
            let rows = &self.record.rows;
            let known = kept
                .iter()
                .any(|(_, other)| rows.iter().all(|row| row[k] == row[*other]));
            if !known && kept.len() < BODIES {
                kept.push((name, k));
            }
        }
        let charts: Vec<Chart> = [
            (0, "m", "travel", ""),
            (1, "m/s", "speed", ".speed"),
            (2, "m/s2", "acceleration", ".acceleration"),
        ]
        .into_iter()
        .filter_map(|(order, unit, label, cut)| {
            let mut curves = self.named(&of_order(order, unit), cut);
            curves.retain(|(name, _)| kept.iter().any(|(k, _)| k == name));
            (!curves.is_empty()).then(|| self.chart("", label, &curves))
        })
        .collect();
        (!charts.is_empty()).then(|| {
            let words = "Travels of joints and lengths, with their speeds and accelerations.";
            let title = "Travels and lengths".to_owned();
            self.figure("d-travels".to_owned(), title, words, vec![charts.into()])
        })
    }

    pub(super) fn transmission(&self) -> Option<Figure> {
        let mut places = self.places(|c| matches!(c.quantity, Quantity::Transmission(_)));
        places.truncate(TOGETHER);
        if places.is_empty() || self.command != Command::Kinematics {
            return None;
        }
        let chart = self.chart(
            "",
            "transmission angle",
            &self.named(&places, ".transmission"),
        );
        let chart = Chart {
            marks: vec![Mark::Horizontal {
                at: 90.0,
                label: "best".to_owned(),
            }],
            ..chart
        };
        let words = "The angle between the two bodies of a dyad at their pin, or between a rod and the normal of its slide.";
        let title = "Transmission angles".to_owned();
        Some(self.figure(
            "e-transmission".to_owned(),
            title,
            words,
            vec![chart.into()],
        ))
    }
}
