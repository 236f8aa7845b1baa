//! Figures of the reduced parameters: m and ½m′, a and b of the reactions, and w of the loads.
//!
//! ```text
//! m q̈ + ½m′ q̇² = Σ w_ℓ F_ℓ,    R_k = a_k q̈ + b_k q̇² + Σ c_kℓ F_ℓ
//! ```
//!
//! F is the magnitude that the scene gives; for a damper, friction or a separating force, the force or moment itself.

use crate::models::PreparedScene;
use crate::output::{
    add_note, chart, coordinate_label, figure, inner_range, range_caption, reaction_figure_count,
    reduced_provenance, symbol,
};
use crate::reduce::compute::{ReducedCurves, UnitLoadCurves};
use dwell_kinetostatics::Coefficients;
use dwell_report::{Axis, Figure, Panel, Series};

/// Maximum number of reactions in a figure; more would not be distinguishable.
const MAX_CURVES: usize = 6;

fn points(curves: &ReducedCurves, of: impl Fn(&Coefficients) -> f64) -> Vec<[f64; 2]> {
    let pairs = curves.q.iter().zip(&curves.coefficients);
    pairs.map(|(q, at)| [q.to_degrees(), of(at)]).collect()
}

/// Curves over the range; next to a limit position they may leave the chart.
fn panel(
    prepared: &PreparedScene<'_>,
    title: &str,
    label: &str,
    unit: &str,
    series: Vec<Series>,
) -> Panel {
    let mut y = Axis::new(label, unit);
    y.range = inner_range(prepared, &series);
    let x = Axis::degrees(coordinate_label(prepared));
    chart(title, x, y, series).into()
}

/// m and ½m′.
pub fn reduced(prepared: &PreparedScene<'_>, curves: &ReducedCurves) -> Figure {
    let inertia = vec![Series::line("", points(curves, |c| c.m))];
    let derivative = vec![Series::line("", points(curves, |c| c.half_dm))];
    let text = "m is the actuator force at unit acceleration and zero speed, ½m′ at unit speed and zero acceleration.";
    figure(
        prepared.scene,
        "reduced",
        "Reduced inertia and half its derivative",
        &range_caption(prepared, text),
        vec![
            panel(prepared, "m (generalised inertia)", "m", "kg m²", inertia),
            panel(
                prepared,
                "½m′ (half its derivative)",
                "½m′",
                "kg m²/rad",
                derivative,
            ),
        ],
        reduced_provenance(curves.q.len()),
    )
}

/// a and b of the requested reactions, separately for forces and moments, a few per figure; and a note if
/// not all are drawn.
pub fn coefficients(
    prepared: &PreparedScene<'_>,
    curves: &ReducedCurves,
) -> (Vec<Figure>, Option<String>) {
    let reactions = prepared.reaction_units();
    let mut pages: Vec<(Vec<usize>, &str)> = Vec::new();
    for (of, unit) in [("N", "kg m"), ("N m", "kg m²")] {
        let of_unit = (0..reactions.len()).filter(|&k| reactions[k].1 == of);
        let of_unit: Vec<usize> = of_unit.collect();
        pages.extend(of_unit.chunks(MAX_CURVES).map(|some| (some.to_vec(), unit)));
    }
    let (drawn, note) = reaction_figure_count(prepared.scene, pages.len());
    let pages = pages.iter().take(drawn).enumerate();
    let figures =
        pages.map(|(k, (some, unit))| coefficient_figure(prepared, curves, some, unit, k));
    let mut figures: Vec<Figure> = figures.collect();
    add_note(&mut figures, note.as_deref());
    (figures, note)
}

fn coefficient_figure(
    prepared: &PreparedScene<'_>,
    curves: &ReducedCurves,
    group: &[usize],
    unit: &str,
    index: usize,
) -> Figure {
    let reactions = prepared.reaction_units();
    let q = symbol(prepared.coordinate_name());
    let lines = |of: fn(&Coefficients, usize) -> f64| {
        let line = |&k: &usize| {
            let name = if group.len() > 1 {
                &*reactions[k].0
            } else {
                ""
            };
            Series::line(name, points(curves, |at| of(at, k)))
        };
        group.iter().map(line).collect()
    };
    let (a, b) = (lines(|c, k| c.a[k]), lines(|c, k| c.b[k]));
    let a_title = format!("a: coefficient of the acceleration of {q}");
    let b_title = format!("b: coefficient of the squared speed of {q}");
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
    figure(
        prepared.scene,
        name,
        title,
        &range_caption(prepared, text),
        vec![
            panel(prepared, &a_title, "a", unit, a),
            panel(prepared, &b_title, "b", unit, b),
        ],
        reduced_provenance(curves.q.len()),
    )
}

/// w of the loads by their units, and V.
pub(crate) fn unit_loads(
    curves: &UnitLoadCurves,
    prepared: &PreparedScene<'_>,
    q: &[f64],
) -> Figure {
    let line = |name: &str, values: &mut dyn Iterator<Item = f64>| {
        let points = q.iter().zip(values).map(|(q, v)| [q.to_degrees(), v]);
        Series::line(name, points.collect())
    };
    let mut panels = Vec::new();
    let unit_of = |l: usize| curves.unit(l);
    let mut unit_names: Vec<&str> = curves.working().map(unit_of).collect();
    unit_names.sort_unstable();
    unit_names.dedup();
    for unit in unit_names {
        let of_unit: Vec<usize> = curves.working().filter(|&l| unit_of(l) == unit).collect();
        for members in of_unit.chunks(MAX_CURVES) {
            let curve = |&l: &usize| {
                let mut values = curves.rows.iter().map(|row| row[l][0]);
                line(&curves.loads[l].name, &mut values)
            };
            let title = "w: generalised force per unit of each load";
            let unit = if unit.is_empty() { "1" } else { unit };
            panels.push(panel(
                prepared,
                title,
                "w",
                unit,
                members.iter().map(curve).collect(),
            ));
        }
    }
    if curves.conservative {
        let series = vec![line("", &mut curves.potential.iter().copied())];
        panels.push(panel(prepared, "V: potential energy", "V", "J", series));
    }
    let text = "m q̈ + ½m′ q̇² = Σ w F, with F the magnitude of each load; for a damper, its force or moment.";
    let (scene, text) = (prepared.scene, range_caption(prepared, text));
    figure(
        scene,
        "unit-loads",
        "Reduced loads",
        &text,
        panels,
        reduced_provenance(q.len()),
    )
}
