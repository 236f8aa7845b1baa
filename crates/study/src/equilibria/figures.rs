//! Equilibria on the static force, and on the potential of a conservative machine.

use crate::equilibria::compute::StaticCurves;
use crate::models::SceneMachine;
use crate::number_format::count;
use crate::output::{scene_caption, symbol};
use dwell_dynamics::{Equilibrium, Stability};
use dwell_report::{Axis, Chart, Figure, Mark, Paint, Panel, Series, Stroke};

/// The curves with the equilibria found, whose forces and potentials are `values`.
pub(crate) fn equilibria(
    machine: &SceneMachine<'_>,
    curves: &StaticCurves,
    found: &[Equilibrium],
    values: &[[f64; 2]],
) -> Figure {
    let (actuator, angle) = machine.first_free_coordinate();
    let name = symbol(machine.coordinate_name(actuator));
    let x = |q: f64| if angle { q.to_degrees() } else { q };
    let panel = |title: &str, y: Axis, k: usize| {
        let pairs = curves.q.iter().zip(&curves.force_and_potential);
        let line = Series::line("", pairs.map(|(q, values)| [x(*q), values[k]]).collect());
        let points = || {
            found
                .iter()
                .zip(values)
                .map(|(e, values)| (e, [x(e.y[0]), values[k]]))
        };
        let stable =
            |e: &Equilibrium| matches!(e.stability, Stability::Asymptotic | Stability::Centre);
        let filled: Vec<[f64; 2]> = points().filter(|(e, _)| stable(e)).map(|p| p.1).collect();
        let open = points()
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
    let mut panels = vec![panel("Static generalised force", Axis::new("Q", unit), 0)];
    if machine.machine.nonconservative_sources().is_empty() {
        panels.push(panel("Potential energy", Axis::new("V", "J"), 1));
    }
    Figure {
        name: "equilibria".to_owned(),
        title: "Equilibria".to_owned(),
        caption: scene_caption(
            machine.scene,
            "Filled: stable equilibria; rings: others. Drives are in their steady state at each position.",
        ),
        columns: 1,
        panels,
        provenance: format!(
            "static force at {}, and its zeros",
            count(curves.q.len(), "position")
        ),
    }
}
