//! Figures of the two unit runs over the coordinate, and of their combination in the form of the paper's Figures 3a and 3b.

use super::compute::{UnitRuns, values};
use crate::reduce::compute::{ReducedScene, coefficient_units, inertia_units};
use crate::reduce::figures::RangeFigures;
use dwell_kinetostatics::Coefficients;
use dwell_report::{Figure, Panel, Series, Stroke};

/// Maximum number of reactions in a figure.
const MAX_REACTIONS: usize = 3;
/// About how many positions of the reduced model are marked.
const MARKS: usize = 24;

impl<P: ReducedScene> UnitRuns<P> {
    /// Both runs, then m₁ and ½∂m₁/∂q₁, then mₑ₁ and mₑ₂ of the first requested reactions.
    pub(super) fn figures(&self) -> Vec<Figure> {
        let mut figures = vec![self.runs_figure(), self.inertia_figure()];
        figures.extend(self.reaction_figure());
        figures
    }

    fn range(&self) -> RangeFigures<'_> {
        RangeFigures {
            prepared: &self.prepared,
            q: &self.combined.q,
            method: "two kinetostatic runs",
        }
    }

    fn panel(&self, title: &str, label: &str, unit: &str, series: Vec<Series>) -> Panel {
        let unit = unit.replace('2', "²");
        self.range().panel(title, label, &unit, series)
    }

    /// The actuator's moment and the first reactions of both runs.
    fn runs_figure(&self) -> Figure {
        let both = |name: &str| {
            let [one, two] = [0, 1].map(|run| values(&self.runs[run], name));
            [
                self.range().line("run i", one),
                self.range().line("run ii", two).stroke(Stroke::Dashed),
            ]
        };
        let coordinate = self.prepared.coordinate_name();
        let moment = both(&format!("{coordinate}.actuator_force"));
        let (title, unit) = if self.prepared.is_angle() {
            ("Actuator moment", "N m")
        } else {
            ("Actuator force", "N")
        };
        let mut panels = vec![self.panel(title, "T", unit, moment.into())];
        for (name, unit) in self.prepared.reaction_units().iter().take(MAX_REACTIONS) {
            let label = if *unit == "N" { "F" } else { "M" };
            panels.push(self.panel(name, label, unit, both(name).into()));
        }
        let text = "Run i: unit speed, no acceleration. Run ii: unit acceleration from rest at the beginning of the range.";
        self.range()
            .figure("runs", "Kinetostatic runs", text, panels)
    }

    /// A coefficient of the combined runs as a line, of the reduced model as points.
    fn compared(&self, of: impl Fn(&Coefficients) -> f64) -> Vec<Series> {
        let line = self
            .range()
            .line("combined runs", self.combined.coefficients.iter().map(&of));
        let mut marked = self
            .range()
            .line("reduce", self.reduced.coefficients.iter().map(&of));
        let stride = marked.points.len().div_ceil(MARKS).max(1);
        marked.points = marked.points.into_iter().step_by(stride).collect();
        vec![line, marked.stroke(Stroke::Points)]
    }

    fn inertia_figure(&self) -> Figure {
        let [m, half_dm] = inertia_units(self.prepared.is_angle());
        let inertia = self.compared(|at| at.m);
        let derivative = self.compared(|at| at.half_dm);
        let panels = vec![
            self.panel("m₁ (generalised inertia)", "m₁", m, inertia),
            self.panel(
                "½∂m₁/∂q₁ (half its derivative)",
                "½∂m₁/∂q₁",
                half_dm,
                derivative,
            ),
        ];
        let text = "From both runs: ½∂m₁/∂q₁ = T/q̇² of run i, m₁ = (T − ½∂m₁/∂q₁ q̇²)/q̈ of run ii.";
        let title = "Reduced parameters from the kinetostatic runs";
        self.range().figure("runs-inertia", title, text, panels)
    }

    fn reaction_figure(&self) -> Option<Figure> {
        let mut panels = Vec::new();
        let reactions = self.prepared.reaction_units();
        for (k, (name, unit)) in reactions.iter().take(MAX_REACTIONS).enumerate() {
            let units = coefficient_units(unit, self.prepared.is_angle());
            let title = |symbol: &str| format!("{symbol} of {name}");
            let one = self.compared(|at| at.a[k]);
            panels.push(self.panel(&title("mₑ₁"), "mₑ₁", units[0], one));
            let two = self.compared(|at| at.b[k]);
            panels.push(self.panel(&title("mₑ₂"), "mₑ₂", units[1], two));
        }
        let text = "From both runs: mₑ₂ = F/q̇² of run i, mₑ₁ = (F − mₑ₂ q̇²)/q̈ of run ii; F is the force of the joint's first body on its second.";
        let title = "Reduced parameters of reactions from the kinetostatic runs";
        let figure = self.range().figure("runs-reaction", title, text, panels);
        (!figure.panels.is_empty()).then_some(figure)
    }
}
