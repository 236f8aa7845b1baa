//! Equilibria on the force at rest, and on the potential where nothing takes or gives energy.

use super::{foot, symbol};
use crate::driven::Driven;
use crate::words::count;
use dwell_dynamics::{Equilibrium, Stability};
use dwell_report::{Axis, Chart, Figure, Mark, Paint, Panel, Series, Stroke};

/// Force (N·m or N) and potential (J) at rest over the coordinate.
pub(crate) struct Rested {
    pub(crate) q: Vec<f64>,
    pub(crate) held: Vec<[f64; 2]>,
}

/// The curves with the equilibria found, whose own forces and potentials are `held`.
pub(crate) fn equilibria(
    driven: &Driven<'_>,
    curves: &Rested,
    found: &[Equilibrium],
    held: &[[f64; 2]],
) -> Figure {
    let (only, angle) = driven.only();
    let name = symbol(driven.name(only));
    let x = |q: f64| if angle { q.to_degrees() } else { q };
    let panel = |title: &str, y: Axis, k: usize| {
        let pairs = curves.q.iter().zip(&curves.held);
        let line = Series::line("", pairs.map(|(q, held)| [x(*q), held[k]]).collect());
        let places = || {
            found
                .iter()
                .zip(held)
                .map(|(e, held)| (e, [x(e.y[0]), held[k]]))
        };
        let stable =
            |e: &Equilibrium| matches!(e.stability, Stability::Asymptotic | Stability::Centre);
        let filled: Vec<[f64; 2]> = places().filter(|(e, _)| stable(e)).map(|p| p.1).collect();
        let open = places()
            .filter(|(e, _)| !stable(e))
            .map(|(_, at)| Mark::Point {
                at,
                label: String::new(),
            });
        let mut marks: Vec<Mark> = open.collect();
        if k == 0 {
            marks.push(Mark::Horizontal {
                at: 0.0,
                label: String::new(),
            });
        }
        let mut series = vec![line];
        if !filled.is_empty() {
            let filled = Series::line("stable", filled).stroke(Stroke::Points);
            series.push(filled.color(Paint::Palette(1)));
        }
        Panel::from(Chart {
            title: title.to_owned(),
            x: if angle {
                Axis::degrees(name.clone())
            } else {
                Axis::new(name.clone(), "m")
            },
            y,
            series,
            marks,
            ..Chart::default()
        })
    };
    let unit = if angle { "N m" } else { "N" };
    let mut panels = vec![panel("Generalised force at rest", Axis::new("Q", unit), 0)];
    if driven.machine.workers().is_empty() {
        panels.push(panel("Potential energy", Axis::new("V", "J"), 1));
    }
    Figure {
        name: "equilibria".to_owned(),
        title: "Equilibria".to_owned(),
        caption: foot(
            driven.scene,
            "Filled: stable equilibria; rings: those that are not. The drives are settled at each position.",
        ),
        columns: 1,
        panels,
        provenance: format!(
            "the force at rest at {}, and its zeros",
            count(curves.q.len(), "position")
        ),
    }
}
