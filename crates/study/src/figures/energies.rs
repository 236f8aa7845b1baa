//! A free motion in time: coordinates, speeds, energies.

use super::{foot, symbol};
use crate::multibody::FreeRun;
use dwell_report::{Axis, Chart, Figure, Panel, Series, Stroke};
use dwell_scene::Scene;

/// Most points of a curve: there are thousands of steps.
const POINTS: usize = 1500;

/// The motion that was held against the multibody equations.
pub(crate) fn energies(scene: &Scene, run: &FreeRun) -> Figure {
    let thin = run.steps.len().div_ceil(POINTS).max(1);
    let shown: Vec<usize> = (0..run.steps.len()).step_by(thin).collect();
    let curve = |of: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        shown.iter().map(|&k| [run.steps[k].t, of(k)]).collect()
    };
    let chart = |title: String, y: Axis, series: Vec<Series>| {
        Panel::from(Chart {
            title,
            x: Axis::new("time", "s"),
            y,
            series,
            ..Chart::default()
        })
    };
    let mut panels = Vec::new();
    for (a, actuator) in scene.mechanism.actuators.iter().enumerate() {
        let (name, unit) = match actuator.coordinate().is_angle() {
            true => (symbol(&actuator.name), "rad"),
            false => (actuator.name.clone(), "m"),
        };
        for (i, unit) in [unit.to_owned(), format!("{unit}/s")]
            .into_iter()
            .enumerate()
        {
            let (title, label) = match i {
                0 => (format!("Coordinate {name}"), name.clone()),
                _ => (format!("Speed of {name}"), "speed".to_owned()),
            };
            let line = Series::line("", curve(&|k| run.coordinates[k][a][i]));
            panels.push(chart(title, Axis::new(label, unit), vec![line]));
        }
    }
    let began = run.steps.first().map_or(0.0, |first| first.potential);
    let lines = vec![
        Series::line("kinetic", curve(&|k| run.steps[k].kinetic)),
        Series::line("potential", curve(&|k| run.steps[k].potential - began)),
        // Often the same curve as another.
        Series::line("work", curve(&|k| run.steps[k].work)).stroke(Stroke::Dashed),
    ];
    let energy = Axis::new("energy", "J");
    panels.push(chart("Energies".to_owned(), energy, lines));
    let words = "The free motion under loads and drives, judged by the full multibody equations. The potential counts \
                 from the start; the work is that of all that has none.";
    Figure {
        name: "d-motion".to_owned(),
        title: "Free motion".to_owned(),
        caption: foot(scene, words),
        columns: if panels.len() > 3 { 2 } else { 1 },
        panels,
        provenance: FreeRun::how(),
    }
}
