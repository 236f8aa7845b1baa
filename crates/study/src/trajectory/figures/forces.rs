//! Reactions and internal forces.

use crate::models::lists_reactions;
use crate::output::{add_note, chart, figure, reaction_figure_count};
use crate::trajectory::compute::{Quantity, SectionedLink};
use crate::trajectory::figures::FigureContext;
use dwell_geometry::JointId;
use dwell_kinetostatics::Section;
use dwell_report::{Axis, Figure, Paint, Panel, Series, Stroke};

impl FigureContext<'_> {
    /// Joint forces by their magnitudes, or their only component; then the moments. With a note if not all are
    /// drawn.
    pub(crate) fn reactions(&self) -> (Vec<Figure>, Option<String>) {
        let requested = &self.scene.requests.reactions;
        let is_requested = |joint: JointId| requested.iter().any(|r| r.joint == joint);
        let forces = self.columns_where(
            |c| matches!(c.quantity, Quantity::ForceMagnitude(joint) if is_requested(joint)),
        );
        let all = self.scene.mechanism.reactions();
        let single = |unit: &str| {
            let columns = self.columns_where(|c| match c.quantity {
                Quantity::Reaction(k) if c.unit == unit => {
                    let joint = all[k].joint;
                    let magnitude = self.results.column_index(Quantity::ForceMagnitude(joint));
                    is_requested(joint) && (unit != "N" || magnitude.is_none())
                }
                _ => false,
            });
            self.labelled(&columns, "")
        };
        let mut panels: Vec<Panel> = Vec::new();
        let magnitudes = self.labelled(&forces, ".magnitude");
        for (title, label, curves) in [
            ("Magnitudes of joint forces", "force", magnitudes),
            ("Joint forces of fixed direction", "force", single("N")),
            ("Joint moments", "moment", single("N m")),
        ] {
            panels.extend(self.even_charts(title, label, curves));
        }
        // Three panels fill a page.
        let (shown, note) =
            reaction_figure_count(lists_reactions(self.scene), panels.len().div_ceil(3));
        let page = |(i, panels): (usize, &[Panel])| {
            let name = match i {
                0 => "reactions".to_owned(),
                i => format!("reactions-{}", i + 1),
            };
            let text = "The force or moment of each joint's first body on its second.";
            let title = match shown {
                1 => "Joint reactions".to_owned(),
                _ => format!("Joint reactions, {} of {shown}", i + 1),
            };
            self.figure(name, title, text, panels.to_vec())
        };
        let pages = panels.chunks(3).take(shown).enumerate();
        let mut figures: Vec<Figure> = pages.map(page).collect();
        add_note(&mut figures, note.as_deref());
        (figures, note)
    }

    /// Axial force, shear force and bending moment at the largest bending moment, with their envelopes.
    pub(crate) fn internal_forces(&self, link: &SectionedLink) -> Option<Figure> {
        let (row, sections) = link.max_bending_sections.as_ref()?;
        let body = self.scene.mechanism.body_name(link.request.body);
        let from = &link.request.names[0];
        let chart = |i: usize, label: &str, unit: &str| {
            let at = |s: &Section| [s.station, [s.axial, s.shear, s.bending][i]];
            let bound = |name: &str, side: usize| {
                let edge = link.envelope.iter().map(|(s, e)| [*s, e[i][side]]);
                let line = Series::line(name, edge.collect());
                line.stroke(Stroke::Dashed).color(Paint::Grey)
            };
            let largest =
                Series::line("largest", sections.iter().map(at).collect()).stroke(Stroke::Filled);
            let x = Axis::new(format!("distance from {from}"), "m");
            let series = vec![largest, bound("envelope", 0), bound("", 1)];
            chart("", x, Axis::new(label, unit), series)
        };
        let (axial, shear) = (chart(0, "axial force", "N"), chart(1, "shear force", "N"));
        let charts = vec![axial, shear, chart(2, "bending moment", "N m")];
        let text = format!(
            "At {}, where the bending moment is largest; dashed: smallest and largest values over the whole trajectory.",
            self.describe_row(*row),
        );
        let name = format!("internal-forces-{}", link.file_name(body));
        let title = format!("Internal forces of {}", link.name);
        let (panels, method) = (vec![charts.into()], &self.method_text);
        Some(figure(self.scene, name, title, &text, panels, method))
    }
}
