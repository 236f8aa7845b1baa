//! A free motion in time: coordinates, velocities, energies.

use crate::checked::multibody::FreeMotionRun;
use dwell_report::{Axis, Figure, Series, Stroke};
use dwell_scene::Scene;
use dwell_study::output::{chart, figure, symbol};

/// Most points of a curve: there are thousands of steps.
const MAX_POINTS: usize = 1500;

/// The motion that was compared with the multibody equations.
pub(crate) fn energies(scene: &Scene, run: &FreeMotionRun) -> Figure {
    let thin = run.steps.len().div_ceil(MAX_POINTS).max(1);
    let mut drawn_steps: Vec<usize> = (0..run.steps.len()).step_by(thin).collect();
    // A motion is shown to its end.
    let last = run.steps.len().checked_sub(1);
    drawn_steps.extend(last.filter(|last| Some(last) != drawn_steps.last()));
    let curve = |of: &dyn Fn(usize) -> f64| -> Vec<[f64; 2]> {
        let points = drawn_steps.iter().map(|&k| [run.steps[k].t, of(k)]);
        points.collect()
    };
    let time = || Axis::new("time", "s");
    let mut charts = Vec::new();
    for (a, actuator) in scene.mechanism.actuators.iter().enumerate() {
        let coordinate = actuator.coordinate();
        let unit = coordinate.unit();
        let name = match coordinate.is_angle() {
            true => symbol(&actuator.name),
            false => actuator.name.clone(),
        };
        let line = |i: usize| vec![Series::line("", curve(&|k| run.coordinates[k][a][i]))];
        let title = format!("Coordinate {name}");
        let axis = Axis::new(name.clone(), unit);
        charts.push(chart(title, time(), axis, line(0)));
        let axis = Axis::new("velocity", format!("{unit}/s"));
        let title = format!("Velocity of {name}");
        charts.push(chart(title, time(), axis, line(1)));
    }
    let initial = run.steps.first().map_or(0.0, |first| first.potential);
    let lines = vec![
        Series::line("kinetic", curve(&|k| run.steps[k].kinetic)),
        Series::line("potential", curve(&|k| run.steps[k].potential - initial)),
        // Often the same curve as another.
        Series::line("work", curve(&|k| run.steps[k].work)).stroke(Stroke::Dashed),
    ];
    let energy = Axis::new("energy", "J");
    charts.push(chart("Energies", time(), energy, lines));
    let text = "The free motion under loads and drives, checked by the full multibody equations. The potential energy is zero at the start; the work is that of all forces without a potential.";
    let provenance = FreeMotionRun::method_text();
    figure(
        scene,
        "motion",
        "Free motion",
        text,
        vec![charts.into()],
        provenance,
    )
}
