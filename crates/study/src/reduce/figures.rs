//! Unit-load response over the range: generalised force and reactions per unit of each load.
//!
//! ```text
//! m q̈ + ½m′ q̇² = Σ w_ℓ F_ℓ,    R_k = a_k q̈ + b_k q̇² + Σ c_kℓ F_ℓ
//! ```
//!
//! F is the magnitude that the scene gives; for a damper, friction or a separating force, the force or moment itself.

use crate::models::PreparedScene;
use crate::output::{
    add_note, coordinate_label, inner_range, range_caption, reaction_figure_count,
    reduced_provenance, symbol,
};
use crate::reduce::compute::{ReducedCurves, UnitLoadCurves, units};
use dwell_kinetostatics::Coefficients;
use dwell_report::{Axis, Chart, Figure, Panel, Series};

/// Maximum number of reactions in a figure; more would not be distinguishable.
pub(crate) const MAX_CURVES: usize = 6;

fn points(curves: &ReducedCurves, of: impl Fn(&Coefficients) -> f64) -> Vec<[f64; 2]> {
    let pairs = curves.q.iter().zip(&curves.coefficients);
    pairs.map(|(q, at)| [q.to_degrees(), of(at)]).collect()
}

/// m and ½m′.
pub fn reduced(prepared: &PreparedScene<'_>, curves: &ReducedCurves) -> Figure {
    let panel = |title: &str, unit: &str, of: fn(&Coefficients) -> f64| {
        let series = vec![Series::line("", points(curves, of))];
        Panel::from(Chart {
            title: title.to_owned(),
            x: Axis::degrees(coordinate_label(prepared)),
            y: Axis {
                range: inner_range(prepared, &series),
                ..Axis::new(title.split(' ').next().unwrap_or(title), unit)
            },
            series,
            ..Chart::default()
        })
    };
    Figure {
        name: "reduced".to_owned(),
        title: "Reduced inertia and half its derivative".to_owned(),
        caption: range_caption(
            prepared,
            "m is the actuator force at unit acceleration and zero speed, ½m′ at unit speed and zero acceleration.",
        ),
        columns: 1,
        panels: vec![
            panel("m (generalised inertia)", "kg m²", |c| c.m),
            panel("½m′ (half its derivative)", "kg m²/rad", |c| c.half_dm),
        ],
        provenance: reduced_provenance(curves.q.len()),
    }
}

/// a and b of the requested reactions, separately for forces and moments, a few per figure; and a note if
/// not all are drawn.
pub fn coefficients(
    prepared: &PreparedScene<'_>,
    curves: &ReducedCurves,
) -> (Vec<Figure>, Option<String>) {
    let reactions = prepared.reaction_units();
    let mut pages_of_reactions: Vec<(Vec<usize>, &str)> = Vec::new();
    for unit in ["N", "N m"] {
        let of_unit: Vec<usize> = (0..reactions.len())
            .filter(|&k| reactions[k].1 == unit)
            .collect();
        pages_of_reactions.extend(of_unit.chunks(MAX_CURVES).map(|some| (some.to_vec(), unit)));
    }
    let (drawn, note) = reaction_figure_count(prepared.scene, pages_of_reactions.len());
    let pages_of_reactions = pages_of_reactions.iter().take(drawn).enumerate();
    let figure = |(k, (some, unit)): (usize, &(Vec<usize>, &str))| {
        coefficient_figure(prepared, curves, some, unit, k)
    };
    let mut figures: Vec<Figure> = pages_of_reactions.map(figure).collect();
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
    let unit = if unit == "N" { "kg m" } else { "kg m²" };
    let q = symbol(prepared.coordinate_name());
    let panel = |title: String, label: &str, of: fn(&Coefficients, usize) -> f64| {
        let line = |&k: &usize| {
            let name = if group.len() > 1 {
                reactions[k].0.clone()
            } else {
                String::new()
            };
            Series::line(name, points(curves, |at| of(at, k)))
        };
        let series: Vec<Series> = group.iter().map(line).collect();
        Panel::from(Chart {
            title,
            x: Axis::degrees(coordinate_label(prepared)),
            y: Axis {
                range: inner_range(prepared, &series),
                ..Axis::new(label, unit)
            },
            series,
            ..Chart::default()
        })
    };
    let title = match group {
        [k] => format!("Reduced parameters of the reaction {}", reactions[*k].0),
        _ => "Reduced parameters of the reactions".to_owned(),
    };
    Figure {
        name: if index == 0 {
            "reaction".to_owned()
        } else {
            format!("reaction-{}", index + 1)
        },
        title,
        caption: range_caption(
            prepared,
            "Reaction = a q̈ + b q̇²: the action of the joint's first body on its second.",
        ),
        columns: 1,
        panels: vec![
            panel(
                format!("a: coefficient of the acceleration of {q}"),
                "a",
                |c, k| c.a[k],
            ),
            panel(
                format!("b: coefficient of the squared speed of {q}"),
                "b",
                |c, k| c.b[k],
            ),
        ],
        provenance: reduced_provenance(curves.q.len()),
    }
}

/// w of the loads by their units, and V.
pub(crate) fn unit_loads(
    curves: &UnitLoadCurves,
    prepared: &PreparedScene<'_>,
    q: &[f64],
) -> Figure {
    let x = &Axis::degrees(coordinate_label(prepared));
    let line = |name: &str, values: &[f64]| {
        let points = q.iter().zip(values).map(|(q, v)| [q.to_degrees(), *v]);
        Series::line(name, points.collect())
    };
    let panel = |title: &str, label: &str, unit: &str, series: Vec<Series>| {
        Panel::from(Chart {
            title: title.to_owned(),
            x: x.clone(),
            y: Axis {
                range: inner_range(prepared, &series),
                ..Axis::new(label, unit)
            },
            series,
            ..Chart::default()
        })
    };
    let mut panels = Vec::new();
    let mut unit_names: Vec<&str> = curves
        .loads
        .iter()
        .filter(|load| load.does_work())
        .map(|load| units(load.kind)[0])
        .collect();
    unit_names.sort_unstable();
    unit_names.dedup();
    for unit in unit_names {
        let of_unit: Vec<usize> = (0..curves.loads.len())
            .filter(|&l| curves.loads[l].does_work() && units(curves.loads[l].kind)[0] == unit)
            .collect();
        for members in of_unit.chunks(MAX_CURVES) {
            let curve = |&l: &usize| {
                let values: Vec<f64> = curves.rows.iter().map(|row| row[l][0]).collect();
                line(&curves.loads[l].name, &values)
            };
            let title = "w: generalised force per unit of each load";
            let unit_label = if unit.is_empty() { "1" } else { unit };
            panels.push(panel(
                title,
                "w",
                unit_label,
                members.iter().map(curve).collect(),
            ));
        }
    }
    if curves.conservative {
        let series = vec![line("", &curves.potential)];
        panels.push(panel("V: potential energy", "V", "J", series));
    }
    Figure {
        name: "unit-loads".to_owned(),
        title: "Reduced loads".to_owned(),
        caption: range_caption(
            prepared,
            "m q̈ + ½m′ q̇² = Σ w F, with F the magnitude of each load; for a damper, its force or moment.",
        ),
        columns: 1,
        panels,
        provenance: reduced_provenance(q.len()),
    }
}
