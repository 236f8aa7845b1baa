//! A free motion in time: coordinates, speeds, energies.

use crate::checked::multibody::FreeMotionRun;
use dwell_report::{Axis, Chart, Figure, Panel, Series, Stroke};
use dwell_scene::Scene;
use dwell_study::output::{scene_caption, symbol};

/// Most points of a curve: there are thousands of steps.
const MAX_POINTS: usize = 1500;

/// The motion that was held against the multibody equations.
pub(crate) fn energies(scene: &Scene, run: &FreeMotionRun) -> Figure {
    let thin = run.steps.len().div_ceil(MAX_POINTS).max(1);
    let mut drawn_steps: Vec<usize> = (0..run.steps.len()).step_by(thin).collect();
    // A motion is shown to its end.
    drawn_steps.extend(
        run.steps
            .len()
            .checked_sub(1)
            .filter(|last| Some(last) != drawn_steps.last()),
    );
    let curve = |of: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        drawn_steps
            .iter()
            .map(|&k| [run.steps[k].t, of(k)])
            .collect()
    };
    let chart = |title: String, y: Axis, series: Vec<Series>| Chart {
        title,
        x: Axis::new("time", "s"),
        y,
        series,
        ..Chart::default()
    };
    let mut charts = Vec::new();
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
            charts.push(chart(title, Axis::new(label, unit), vec![line]));
        }
    }
    let initial_potential = run.steps.first().map_or(0.0, |first| first.potential);
    let lines = vec![
        Series::line("kinetic", curve(&|k| run.steps[k].kinetic)),
        Series::line(
            "potential",
            curve(&|k| run.steps[k].potential - initial_potential),
        ),
        // Often the same curve as another.
        Series::line("work", curve(&|k| run.steps[k].work)).stroke(Stroke::Dashed),
    ];
    let energy = Axis::new("energy", "J");
    charts.push(chart("Energies".to_owned(), energy, lines));
    let text = "The free motion under loads and drives, checked by the full multibody equations. The potential energy is zero at the start; the work is that of all forces without a potential.";
    Figure {
        name: "motion".to_owned(),
        title: "Free motion".to_owned(),
        caption: scene_caption(scene, text),
        columns: 1,
        panels: vec![Panel::Stack(charts)],
        provenance: FreeMotionRun::method_text(),
    }
}
