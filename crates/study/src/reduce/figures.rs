//! Figures of the reduced parameters: m and ½m′, a and b of the reactions, and w of the loads.
//!
//! ```text
//! m q̈ + ½m′ q̇² = Σ w_ℓ F_ℓ,    R_k = a_k q̈ + b_k q̇² + Σ c_kℓ F_ℓ
//! ```
//!
//! F is the magnitude that the scene gives; for a damper, friction or a separating force, the force or moment itself.

use crate::number_format::count;
use crate::output::{
    add_note, chart, coordinate_axis, figure, inner_range, range_caption, reaction_figure_count,
    symbol,
};
use crate::reduce::compute::{
    ReducedCurves, ReducedScene, UnitLoadCurves, coefficient_units, inertia_units,
};
use dwell_kinetostatics::Coefficients;
use dwell_report::{Axis, Figure, Panel, Series};

/// Maximum number of reactions in a figure; more would not be distinguishable.
const MAX_CURVES: usize = 6;

/// The common data of the figures: the scene with its model, and the coordinates.
pub(crate) struct RangeFigures<'a> {
    pub(crate) prepared: &'a dyn ReducedScene,
    pub(crate) q: &'a [f64],
    /// The method that computed them.
    pub(crate) method: &'static str,
}

fn of_reduced_model<'a>(prepared: &'a dyn ReducedScene, q: &'a [f64]) -> RangeFigures<'a> {
    RangeFigures {
        prepared,
        q,
        method: "reduced model by unit runs",
    }
}

impl RangeFigures<'_> {
    /// A curve over the range.
    pub(crate) fn line(&self, name: &str, values: impl IntoIterator<Item = f64>) -> Series {
        let points = self.q.iter().zip(values);
        let x = |q: f64| {
            if self.prepared.is_angle() {
                q.to_degrees()
            } else {
                q
            }
        };
        Series::line(name, points.map(|(q, v)| [x(*q), v]).collect())
    }

    /// Curves over the range; next to a limit position they may leave the chart.
    pub(crate) fn panel(&self, title: &str, label: &str, unit: &str, series: Vec<Series>) -> Panel {
        let mut y = Axis::new(label, unit);
        y.range = inner_range(self.prepared.range(), &series);
        let label = self.prepared.coordinate_label();
        let x = coordinate_axis(&label, self.prepared.is_angle());
        chart(title, x, y, series).into()
    }

    pub(crate) fn figure(
        &self,
        name: impl Into<String>,
        title: impl Into<String>,
        text: &str,
        panels: Vec<Panel>,
    ) -> Figure {
        let text = range_caption(self.prepared.has_limits(), text);
        let positions = count(self.q.len(), "position");
        let provenance = format!("{}, at {positions}", self.method);
        figure(self.prepared.file(), name, title, &text, panels, provenance)
    }
}

/// m and ½m′, without curves that are zero by [`ReducedCurves::rounding`].
pub fn reduced(
    prepared: &dyn ReducedScene,
    curves: &ReducedCurves,
    is_rounding: &[bool],
) -> Figure {
    let (range, at) = (of_reduced_model(prepared, &curves.q), &curves.coefficients);
    let [m_unit, half_dm_unit] = inertia_units(prepared.is_angle()).map(|u| u.replace('2', "²"));
    let m = vec![range.line("", at.iter().map(|c| c.m))];
    let inertia = range.panel("m (generalised inertia)", "m", &m_unit, m);
    let half_dm = vec![range.line("", at.iter().map(|c| c.half_dm))];
    let title = "½m′ (half its derivative)";
    let derivative = range.panel(title, "½m′", &half_dm_unit, half_dm);
    let text = "m is the actuator force at unit acceleration and zero speed, ½m′ at unit speed and zero acceleration.";
    let title = "Reduced inertia and half its derivative";
    let panels = if is_rounding[1] {
        vec![inertia]
    } else {
        vec![inertia, derivative]
    };
    range.figure("reduced", title, text, panels)
}

/// a and b of the requested reactions, separately for forces and moments, a few per figure; and a note if
/// not all are drawn. Curves that are zero by [`ReducedCurves::rounding`] are omitted.
pub fn coefficients(
    prepared: &dyn ReducedScene,
    curves: &ReducedCurves,
    is_rounding: &[bool],
) -> (Vec<Figure>, Option<String>) {
    let reactions = prepared.reaction_units();
    let mut pages: Vec<(Vec<usize>, &str)> = Vec::new();
    for of in ["N", "N m"] {
        let is_drawn = |k: usize| coefficients_of(is_rounding, k).contains(&false);
        let of_unit = (0..reactions.len()).filter(|&k| reactions[k].1 == of && is_drawn(k));
        let of_unit: Vec<usize> = of_unit.collect();
        pages.extend(of_unit.chunks(MAX_CURVES).map(|some| (some.to_vec(), of)));
    }
    let (drawn, note) = reaction_figure_count(prepared.lists_reactions(), pages.len());
    let pages = pages.iter().take(drawn).enumerate();
    let mut figures: Vec<Figure> = pages
        .map(|(k, (some, of))| coefficient_figure(prepared, curves, is_rounding, some, of, k))
        .collect();
    add_note(&mut figures, note.as_deref());
    (figures, note)
}

/// For a and b of a reaction: whether it is zero within rounding.
fn coefficients_of(is_rounding: &[bool], reaction: usize) -> [bool; 2] {
    let (a, b) = is_rounding[2..].split_at((is_rounding.len() - 2) / 2);
    [a[reaction], b[reaction]]
}

fn coefficient_figure(
    prepared: &dyn ReducedScene,
    curves: &ReducedCurves,
    is_rounding: &[bool],
    group: &[usize],
    of: &str,
    index: usize,
) -> Figure {
    let range = of_reduced_model(prepared, &curves.q);
    let reactions = prepared.reaction_units();
    let name = symbol(prepared.coordinate_name());
    let lines = |part: usize, of: fn(&Coefficients, usize) -> f64| -> Vec<Series> {
        let line = |&k: &usize| {
            let name = if group.len() > 1 { &reactions[k].0 } else { "" };
            range.line(name, curves.coefficients.iter().map(|at| of(at, k)))
        };
        let drawn = group.iter();
        drawn
            .filter(|&&k| !coefficients_of(is_rounding, k)[part])
            .map(line)
            .collect()
    };
    let title = |what: &str| format!("{what} of {name}");
    let kinds = [
        (
            "a",
            title("a: coefficient of the acceleration"),
            lines(0, |c, k| c.a[k]),
        ),
        (
            "b",
            title("b: coefficient of the squared speed"),
            lines(1, |c, k| c.b[k]),
        ),
    ];
    let kinds = kinds.into_iter().filter(|(.., lines)| !lines.is_empty());
    let units = match (of, prepared.is_angle()) {
        ("N m", true) => ["kg m²"; 2],
        (of, is_angle) => coefficient_units(of, is_angle),
    };
    let panels = kinds.map(|(label, title, lines)| {
        let unit = units[usize::from(label == "b")];
        range.panel(&title, label, unit, lines)
    });
    let panels = panels.collect();
    let title = match group {
        [k] => format!("Reduced parameters of the reaction {}", reactions[*k].0),
        _ => "Reduced parameters of the reactions".to_owned(),
    };
    let name = match index {
        0 => "reaction".to_owned(),
        k => format!("reaction-{}", k + 1),
    };
    let text =
        "Reaction = a q̈ + b q̇²: the force or moment of the joint's first body on its second.";
    range.figure(name, title, text, panels)
}

/// w of the loads by their units, and V.
pub(crate) fn unit_loads(
    curves: &UnitLoadCurves,
    prepared: &dyn ReducedScene,
    q: &[f64],
) -> Figure {
    let range = of_reduced_model(prepared, q);
    let mut panels = Vec::new();
    let unit_of = |l: usize| curves.unit(l);
    let mut unit_names: Vec<&str> = curves.working().map(unit_of).collect();
    unit_names.sort_unstable();
    unit_names.dedup();
    for unit in unit_names {
        let of_unit: Vec<usize> = curves.working().filter(|&l| unit_of(l) == unit).collect();
        for members in of_unit.chunks(MAX_CURVES) {
            let curve =
                |&l: &usize| range.line(&curves.loads[l].name, curves.rows.iter().map(|r| r[l][0]));
            let title = "w: generalised force per unit of each load";
            let unit = if unit.is_empty() { "1" } else { unit };
            panels.push(range.panel(title, "w", unit, members.iter().map(curve).collect()));
        }
    }
    if curves.conservative {
        let series = vec![range.line("", curves.potential.iter().copied())];
        panels.push(range.panel("V: potential energy", "V", "J", series));
    }
    let text = "m q̈ + ½m′ q̇² = Σ w F, with F the magnitude of each load; for a damper, its force or moment.";
    range.figure("unit-loads", "Reduced loads", text, panels)
}
