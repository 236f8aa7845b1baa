//! The reduced parameters over the range.

use super::{coordinate_label, drawn, range_caption, reduced_at, symbol, tell};
use crate::prepare::Prepared;
use crate::reduce::Sweep;
use dwell_geometry::Range;
use dwell_kinetostatics::{Coefficients, Reduced};
use dwell_report::{Axis, Chart, Figure, Panel, Series};

/// Most reactions that share a figure; more would not be told apart.
const TOGETHER: usize = 6;

fn points(sweep: &Sweep, of: impl Fn(&Coefficients) -> f64) -> Vec<[f64; 2]> {
    let pairs = sweep.q.iter().zip(&sweep.at);
    pairs.map(|(q, at)| [q.to_degrees(), of(at)]).collect()
}

/// The extent of the curves that is worth showing. Towards a limit position everything grows
/// without bound, so there the extent is that of the inner nine tenths of the range.
pub(crate) fn extent(prepared: &Prepared<'_>, curves: &[Series]) -> Option<[f64; 2]> {
    if prepared.model.range() == Range::Full {
        return None;
    }
    let inner = |c: &Series| {
        let n = c.points.len();
        c.points[n / 20..n - n / 20].to_vec()
    };
    let (low, high) = curves
        .iter()
        .flat_map(inner)
        .fold((f64::MAX, f64::MIN), |(a, b), [_, v]| (a.min(v), b.max(v)));
    let margin = 0.08 * (high - low);
    (high > low).then_some([low - margin, high + margin])
}

/// m and ½m′.
pub(crate) fn reduced(prepared: &Prepared<'_>, sweep: &Sweep) -> Figure {
    let panel = |title: &str, unit: &str, of: fn(&Coefficients) -> f64| {
        let series = vec![Series::line("", points(sweep, of))];
        Panel::from(Chart {
            title: title.to_owned(),
            x: Axis::degrees(coordinate_label(prepared)),
            y: Axis {
                range: extent(prepared, &series),
                ..Axis::new(title.split(' ').next().unwrap_or(title), unit)
            },
            series,
            ..Chart::default()
        })
    };
    Figure {
        name: "b-reduced".to_owned(),
        title: "Reduced inertia and half its derivative".to_owned(),
        caption: range_caption(
            prepared,
            "m is the action of the actuator at unit acceleration from rest, ½m′ at unit speed without acceleration.",
        ),
        columns: 1,
        panels: vec![
            panel("m (generalised inertia)", "kg m²", |c| c.m),
            panel("½m′ (half its derivative)", "kg m²/rad", |c| c.half_dm),
        ],
        provenance: reduced_at(sweep.q.len()),
    }
}

/// a and b of the requested reactions, forces and moments apart, a few to a figure.
/// With what has to be said if not all are drawn.
pub(crate) fn coefficients(
    prepared: &Prepared<'_>,
    sweep: &Sweep,
) -> (Vec<Figure>, Option<String>) {
    let reactions = prepared.reactions();
    let mut pages: Vec<(Vec<usize>, &str)> = Vec::new();
    for unit in ["N", "N m"] {
        let of_unit: Vec<usize> = (0..reactions.len())
            .filter(|&k| reactions[k].1 == unit)
            .collect();
        pages.extend(of_unit.chunks(TOGETHER).map(|some| (some.to_vec(), unit)));
    }
    let (drawn, note) = drawn(prepared.scene, pages.len());
    let pages = pages.iter().take(drawn).enumerate();
    let figure =
        |(k, (some, unit)): (usize, &(Vec<usize>, &str))| one(prepared, sweep, some, unit, k);
    let mut figures: Vec<Figure> = pages.map(figure).collect();
    tell(&mut figures, note.as_deref());
    (figures, note)
}

fn one(prepared: &Prepared<'_>, sweep: &Sweep, some: &[usize], unit: &str, more: usize) -> Figure {
    let reactions = prepared.reactions();
    let unit = if unit == "N" { "kg m" } else { "kg m²" };
    let q = symbol(prepared.coordinate());
    let panel = |title: String, label: &str, of: fn(&Coefficients, usize) -> f64| {
        let line = |&k: &usize| {
            let name = if some.len() > 1 {
                reactions[k].0.clone()
            } else {
                String::new()
            };
            Series::line(name, points(sweep, |at| of(at, k)))
        };
        let series: Vec<Series> = some.iter().map(line).collect();
        Panel::from(Chart {
            title,
            x: Axis::degrees(coordinate_label(prepared)),
            y: Axis {
                range: extent(prepared, &series),
                ..Axis::new(label, unit)
            },
            series,
            ..Chart::default()
        })
    };
    let title = match some {
        [k] => format!("Reduced parameters of the reaction {}", reactions[*k].0),
        _ => "Reduced parameters of the reactions".to_owned(),
    };
    Figure {
        name: if more == 0 {
            "c-reaction".to_owned()
        } else {
            format!("c-reaction-{}", more + 1)
        },
        title,
        caption: range_caption(
            prepared,
            "Reaction = a q̈ + b q̇²: the action of the joint's first body on its second.",
        ),
        columns: 1,
        panels: vec![
            panel(
                format!("a: what multiplies {q}'s acceleration"),
                "a",
                |c, k| c.a[k],
            ),
            panel(
                format!("b: what multiplies {q}'s speed squared"),
                "b",
                |c, k| c.b[k],
            ),
        ],
        provenance: reduced_at(sweep.q.len()),
    }
}
