//! Actions, reactions, power and inner forces.

use super::{Sheet, TOGETHER};
use crate::figures::{drawn, symbol, tell};
use crate::run::{Command, Link, Quantity};
use dwell_geometry::JointId;
use dwell_report::{Axis, Chart, Figure, Paint, Panel, Series, Stroke};

impl Sheet<'_> {
    pub(super) fn actions(&self) -> Option<Figure> {
        let panel = |unit: &str, title: &str, label: &str| {
            let places =
                self.places(|c| matches!(c.quantity, Quantity::Action(_)) && c.unit == unit);
            let curves = self.named(&places, ".action");
            let curves: Vec<_> = curves.into_iter().map(|(n, k)| (symbol(&n), k)).collect();
            (!curves.is_empty()).then(|| Panel::from(self.chart(title, label, &curves)))
        };
        let panels: Vec<Panel> = [
            panel("N m", "Couples of the actuators", "couple"),
            panel("N", "Forces of the actuators", "force"),
        ]
        .into_iter()
        .flatten()
        .collect();
        let words = "What the actuators must exert: the action of the first body on the second.";
        let title = "Actuator actions".to_owned();
        (!panels.is_empty()).then(|| self.figure("f-actions".to_owned(), title, words, panels))
    }

    /// Forces of the joints by their magnitudes, or the one component they have; then the couples.
    /// With what has to be said if not all are drawn.
    pub(super) fn reactions(&self) -> (Vec<Figure>, Option<String>) {
        let asked = |joint: &JointId| {
            self.scene
                .requests
                .reactions
                .iter()
                .any(|r| r.joint == *joint)
        };
        let mechanism = &self.scene.mechanism;
        let forces = self.places(|c| match c.quantity {
            Quantity::Magnitude(joint) => asked(&joint),
            _ => false,
        });
        let all = mechanism.reactions();
        let single = |unit: &str| {
            self.places(|c| match c.quantity {
                Quantity::Reaction(k) if c.unit == unit => {
                    let joint = all[k].joint;
                    let has_magnitude = self
                        .record
                        .columns
                        .iter()
                        .any(|c| c.quantity == Quantity::Magnitude(joint));
                    asked(&joint) && (unit != "N" || !has_magnitude)
                }
                _ => false,
            })
        };
        let mut panels: Vec<Panel> = Vec::new();
        let mut group = |title, label, curves: Vec<(String, usize)>| {
            // Even shares, so that no chart has a single curve left over.
            let count = curves.len().div_ceil(TOGETHER).max(1);
            for some in curves.chunks(curves.len().div_ceil(count).max(1)) {
                panels.push(self.chart(title, label, some).into());
            }
        };
        group(
            "Magnitudes of the forces",
            "force",
            self.named(&forces, ".magnitude"),
        );
        group(
            "Forces of one direction",
            "force",
            self.named(&single("N"), ""),
        );
        group("Couples", "couple", self.named(&single("N m"), ""));
        // Three panels fill a page.
        let (drawn, note) = drawn(self.scene, panels.len().div_ceil(3));
        let pages = panels.chunks(3).take(drawn).enumerate();
        let mut figures: Vec<Figure> = pages
            .map(|(i, panels)| {
                let name = match i {
                    0 => "g-reactions".to_owned(),
                    i => format!("g-reactions-{}", i + 1),
                };
                let words = "The action of each joint's first body on its second.";
                self.figure(name, "Joint reactions".to_owned(), words, panels.to_vec())
            })
            .collect();
        tell(&mut figures, note.as_deref());
        (figures, note)
    }

    pub(super) fn frame(&self) -> Option<Figure> {
        let places = self.places(|c| matches!(c.quantity, Quantity::Frame(_)));
        let &[fx, fy, m] = places.as_slice() else {
            return None;
        };
        if [fx, fy, m].iter().all(|&k| self.is_still(k, 0.0)) {
            return None;
        }
        let curves = [("x".to_owned(), fx), ("y".to_owned(), fy)];
        let charts = vec![
            self.chart("", "force", &curves),
            self.chart("", "moment", &[("moment".to_owned(), m)]),
        ];
        let words =
            "What joints, actuators and loads do to the frame, with the moment about its origin.";
        let title = match self.command {
            Command::Kinetostatics | Command::Simulate => "Shaking force and moment",
            _ => "Force and moment on the frame",
        };
        Some(self.figure(
            "h-frame".to_owned(),
            title.to_owned(),
            words,
            vec![charts.into()],
        ))
    }

    pub(super) fn power(&self) -> Option<Figure> {
        let places = self.places(|c| matches!(c.quantity, Quantity::Balance(_)) && c.unit == "W");
        let curves: Vec<_> = self
            .named(&places, "")
            .into_iter()
            .filter_map(|(name, k)| {
                let name = match name.strip_prefix("balance.")? {
                    "residual" => return None,
                    other => other.to_owned(),
                };
                Some((name, k))
            })
            .collect();
        if curves.is_empty() || curves.iter().all(|(_, k)| self.is_still(*k, 0.0)) {
            return None;
        }
        let mut chart = self.chart("", "power", &curves);
        // Where there is no load, the other two lie on each other.
        if let Some(kinetic) = chart.series.last_mut() {
            kinetic.stroke = Stroke::Dashed;
        }
        let words =
            "Power of the actuators and of the loads; together they change the kinetic energy.";
        let title = "Power balance".to_owned();
        Some(self.figure("i-power".to_owned(), title, words, vec![chart.into()]))
    }

    /// Axial force, shear and bending moment where it is largest, within their envelopes.
    pub(super) fn link(&self, link: &Link) -> Option<Figure> {
        let (row, sections) = link.worst.as_ref()?;
        let body = self.scene.mechanism.body_name(link.request.body);
        let [from, to] = &link.request.names;
        let millimetres = |s: f64| s * 1e3;
        let chart = |i: usize, label: &str, unit: &str| {
            let worst = sections.iter().map(|s| {
                let value = [s.axial, s.shear, s.bending][i];
                [millimetres(s.station), value]
            });
            let edge = |side: usize| -> Vec<[f64; 2]> {
                let envelope = link.envelope.iter();
                envelope
                    .map(|(s, e)| [millimetres(*s), e[i][side]])
                    .collect()
            };
            let bound = |name: &str, side| {
                Series::line(name, edge(side))
                    .stroke(Stroke::Dashed)
                    .color(Paint::Grey)
            };
            Chart {
                x: Axis::new(format!("distance from {from}"), "mm"),
                y: Axis::new(label, unit),
                series: vec![
                    Series::line("largest", worst.collect()).stroke(Stroke::Filled),
                    bound("envelope", 0),
                    bound("", 1),
                ],
                ..Chart::default()
            }
        };
        let charts = vec![
            chart(0, "axial force", "N"),
            chart(1, "shear force", "N"),
            chart(2, "bending moment", "N m"),
        ];
        let words = format!(
            "At {}, where the bending moment is largest; dashed: the smallest and largest values of the whole way.",
            self.told(*row),
        );
        Some(Figure {
            name: format!("j-section-{}", link.name(body)),
            title: format!("Inner forces of {body} from {from} to {to}"),
            caption: self.foot(&words),
            columns: 1,
            panels: vec![charts.into()],
            provenance: self.how.clone(),
        })
    }
}
