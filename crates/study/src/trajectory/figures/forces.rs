//! Actuator forces, reactions, power and internal forces.

use crate::output::{add_note, reaction_figure_count, symbol};
use crate::trajectory::compute::{Analysis, ColumnQuantity, SectionedLink};
use crate::trajectory::figures::{FigureContext, MAX_CURVES};
use dwell_geometry::JointId;
use dwell_report::{Axis, Chart, Figure, Paint, Panel, Series, Stroke};

impl FigureContext<'_> {
    pub(crate) fn actuator_forces(&self) -> Option<Figure> {
        let panel = |unit: &str, title: &str, label: &str| {
            let indices = self.columns_where(|c| {
                matches!(c.quantity, ColumnQuantity::ActuatorForce(_)) && c.unit == unit
            });
            let curves = self.labelled(&indices, ".actuator_force");
            let curves: Vec<_> = curves.into_iter().map(|(n, k)| (symbol(&n), k)).collect();
            (!curves.is_empty()).then(|| Panel::from(self.chart(title, label, &curves)))
        };
        let panels: Vec<Panel> = [
            panel("N m", "Actuator moments", "couple"),
            panel("N", "Actuator forces", "force"),
        ]
        .into_iter()
        .flatten()
        .collect();
        let text = "Required actuator forces: the action of the first body on the second.";
        let title = "Actuator forces".to_owned();
        (!panels.is_empty()).then(|| self.figure("actuator-forces".to_owned(), title, text, panels))
    }

    /// Joint forces by their magnitudes, or their only component; then the moments. With a note if not all are
    /// drawn.
    pub(crate) fn reactions(&self) -> (Vec<Figure>, Option<String>) {
        let is_requested = |joint: &JointId| {
            self.scene
                .requests
                .reactions
                .iter()
                .any(|r| r.joint == *joint)
        };
        let mechanism = &self.scene.mechanism;
        let forces = self.columns_where(|c| match c.quantity {
            ColumnQuantity::ForceMagnitude(joint) => is_requested(&joint),
            _ => false,
        });
        let all = mechanism.reactions();
        let single = |unit: &str| {
            self.columns_where(|c| match c.quantity {
                ColumnQuantity::Reaction(k) if c.unit == unit => {
                    let joint = all[k].joint;
                    let has_magnitude = self
                        .results
                        .columns
                        .iter()
                        .any(|c| c.quantity == ColumnQuantity::ForceMagnitude(joint));
                    is_requested(&joint) && (unit != "N" || !has_magnitude)
                }
                _ => false,
            })
        };
        let mut panels: Vec<Panel> = Vec::new();
        let mut group = |title, label, curves: Vec<(String, usize)>| {
            // Evenly distributed, so that no chart has a single curve left over.
            let count = curves.len().div_ceil(MAX_CURVES).max(1);
            for some in curves.chunks(curves.len().div_ceil(count).max(1)) {
                panels.push(self.chart(title, label, some).into());
            }
        };
        group(
            "Magnitudes of joint forces",
            "force",
            self.labelled(&forces, ".magnitude"),
        );
        group(
            "Joint forces of fixed direction",
            "force",
            self.labelled(&single("N"), ""),
        );
        group("Couples", "couple", self.labelled(&single("N m"), ""));
        // Three panels fill a page.
        let (shown, note) = reaction_figure_count(self.scene, panels.len().div_ceil(3));
        let pages = panels.chunks(3).take(shown).enumerate();
        let mut figures: Vec<Figure> = pages
            .map(|(i, panels)| {
                let name = match i {
                    0 => "reactions".to_owned(),
                    i => format!("reactions-{}", i + 1),
                };
                let text = "The action of each joint's first body on its second.";
                self.figure(name, "Joint reactions".to_owned(), text, panels.to_vec())
            })
            .collect();
        add_note(&mut figures, note.as_deref());
        (figures, note)
    }

    pub(crate) fn shaking_force(&self) -> Option<Figure> {
        let indices = self.columns_where(|c| matches!(c.quantity, ColumnQuantity::ShakingForce(_)));
        let &[fx, fy, m] = indices.as_slice() else {
            return None;
        };
        if [fx, fy, m].iter().all(|&k| self.is_zero(k, 0.0)) {
            return None;
        }
        let curves = [("x".to_owned(), fx), ("y".to_owned(), fy)];
        let charts = vec![
            self.chart("", "force", &curves),
            self.chart("", "moment", &[("moment".to_owned(), m)]),
        ];
        let text =
            "Resultant of joint, actuator and load forces on the frame; moment about its origin.";
        let title = match self.analysis {
            Analysis::Kinetostatics | Analysis::FreeMotion => "Shaking force and moment",
            _ => "Force and moment on the frame",
        };
        Some(self.figure(
            "shaking-force".to_owned(),
            title.to_owned(),
            text,
            vec![charts.into()],
        ))
    }

    pub(crate) fn power(&self) -> Option<Figure> {
        let indices =
            self.columns_where(|c| matches!(c.quantity, ColumnQuantity::Power(_)) && c.unit == "W");
        let curves: Vec<_> = self
            .labelled(&indices, "")
            .into_iter()
            .filter_map(|(name, k)| {
                let name = match name.strip_prefix("power.")? {
                    "residual" => return None,
                    other => other.to_owned(),
                };
                Some((name, k))
            })
            .collect();
        if curves.is_empty() || curves.iter().all(|(_, k)| self.is_zero(*k, 0.0)) {
            return None;
        }
        let mut chart = self.chart("", "power", &curves);
        // Without loads the other two curves coincide.
        if let Some(kinetic) = chart.series.last_mut() {
            kinetic.stroke = Stroke::Dashed;
        }
        let text =
            "Power of the actuators and of the loads; their sum is the rate of the kinetic energy.";
        let title = "Power balance".to_owned();
        Some(self.figure("power-balance".to_owned(), title, text, vec![chart.into()]))
    }

    /// Axial force, shear force and bending moment at the largest bending moment, with their envelopes.
    pub(crate) fn internal_forces(&self, link: &SectionedLink) -> Option<Figure> {
        let (row, sections) = link.max_bending_sections.as_ref()?;
        let body = self.scene.mechanism.body_name(link.request.body);
        let [from, to] = &link.request.names;
        let millimetres = |s: f64| s * 1e3;
        let chart = |i: usize, label: &str, unit: &str| {
            let at_maximum = sections.iter().map(|s| {
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
                    Series::line("largest", at_maximum.collect()).stroke(Stroke::Filled),
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
        let text = format!(
            "At {}, where the bending moment is largest; dashed: smallest and largest values over the whole trajectory.",
            self.describe_position(*row),
        );
        Some(Figure {
            name: format!("internal-forces-{}", link.file_name(body)),
            title: format!("Internal forces of {body} from {from} to {to}"),
            caption: self.caption(&text),
            columns: 1,
            panels: vec![charts.into()],
            provenance: self.method_text.clone(),
        })
    }
}
