//! A free motion in time: of the reduced model (the paper's Figure 4), or under loads and drives with its energies.

use crate::checked::history::History;
use crate::checked::multibody::FreeMotionRun;
use dwell_report::{Axis, Figure, Mark, Panel, Series, Stroke};
use dwell_scene::PlaneScene;
use dwell_study::output::{self, coordinate_label, symbol};
use dwell_study::{PreparedScene, SolverSettings};

/// Periods that are drawn; more would only repeat.
const DRAWN_PERIODS: f64 = 2.0;
/// Most reactions to a panel.
const MAX_CURVES: usize = 6;

/// The motion over two periods (or all of it, where it has none).
pub(crate) fn history(prepared: &PreparedScene<'_>, history: &History) -> Figure {
    let drawn = history.period.map(|t| DRAWN_PERIODS * t * (1.0 + 1e-9));
    let drawn = drawn.unwrap_or(f64::INFINITY);
    let is_drawn = |row: &&Vec<f64>| row[0] - history.rows[0][0] <= drawn;
    let curve = |column: usize| -> Vec<[f64; 2]> {
        let rows = history.rows.iter().filter(is_drawn);
        rows.map(|row| [row[0], row[column]]).collect()
    };
    let marks = revolution_marks(history, drawn);
    let chart = |title: String, label: String, unit: &str, series: Vec<Series>| -> Panel {
        let (time, y) = (Axis::new("time", "s"), Axis::new(label, unit));
        let mut chart = output::chart(title, time, y, series);
        chart.marks.clone_from(&marks);
        chart.into()
    };
    let q = symbol(prepared.coordinate_name());
    let angle = coordinate_label(prepared);
    let velocity = vec![Series::line("", curve(2))];
    let title = format!("Velocity of the {angle}");
    let mut panels = vec![chart(title, format!("d{q}/dt"), "rad/s", velocity)];
    let named = prepared.reaction_units();
    for (unit, noun) in [("N", "force"), ("N m", "moment")] {
        let acts = |k: usize| history.rows.iter().any(|row| row[5 + k] != 0.0);
        for (title, label, reactions) in reaction_panels(&named, unit, noun, &acts) {
            let line = |(name, k)| Series::line(name, curve(5 + k));
            let lines = reactions.into_iter().map(line).collect();
            panels.push(chart(title, label, unit, lines));
        }
    }
    let fitted = prepared.scene.calibration.as_ref().map(|c| {
        format!(
            " {} is fitted to a period of {} s, so that agreement is by construction.",
            c.path, c.period
        )
    });
    let fitted = fitted.unwrap_or_default();
    let reactions = match panels.len() {
        1 => "",
        _ => " Reactions by R = a q̈ + b q̇².",
    };
    let text = format!("No torque.{reactions}{fitted}");
    let columns = if panels.len() > 2 { 2 } else { 1 };
    let provenance = format!("reduced model, {}", SolverSettings::default().describe());
    Figure {
        columns,
        ..output::figure(
            prepared.scene,
            "motion",
            "Free motion",
            &text,
            panels,
            provenance,
        )
    }
}

/// A reaction's name, and its index among those of the model.
type NamedReaction = (String, usize);

/// Title, label and reactions, by name and index, of at most two panels of a unit. One reaction alone needs no name;
/// those that never act are left out.
fn reaction_panels(
    named: &[(String, &str)],
    unit: &str,
    noun: &str,
    acts: &dyn Fn(usize) -> bool,
) -> Vec<(String, String, Vec<NamedReaction>)> {
    let all = named.iter().enumerate().filter(|(_, (_, of))| *of == unit);
    let all = all.filter(|(k, _)| acts(*k));
    let all: Vec<NamedReaction> = all.map(|(k, (name, _))| (name.clone(), k)).collect();
    let panels = all.len().div_ceil(MAX_CURVES).max(1);
    let per_panel = all.len().div_ceil(panels).max(1);
    let panel = |group: &[NamedReaction]| match group {
        [(name, k)] => (
            format!("Reaction {name}"),
            name.clone(),
            vec![(String::new(), *k)],
        ),
        _ => {
            let [first, last] = [0, group.len() - 1].map(|k| &group[k].0);
            let title = format!("Reactions {first} to {last}");
            (title, format!("reaction {noun}"), group.to_vec())
        }
    };
    all.chunks(per_panel).take(2).map(panel).collect()
}

/// The ends of the revolutions up to a time.
fn revolution_marks(history: &History, until: f64) -> Vec<Mark> {
    let revolutions = history.run.event_occurrences.iter().map(|o| o.state.t);
    let drawn = revolutions.take_while(|t| *t <= until).enumerate();
    let mark = |(k, at): (usize, f64)| {
        let label = format!("T = {at:.4} s");
        let label = if k == 0 { label } else { String::new() };
        Mark::Vertical { at, label }
    };
    drawn.map(mark).collect()
}

/// Most charts below each other.
const MAX_STACKED: usize = 9;
/// Most points of a curve: there are thousands of steps.
const MAX_POINTS: usize = 1500;

/// The motion that was compared with the multibody equations.
pub(crate) fn energies(scene: &PlaneScene, run: &FreeMotionRun) -> Figure {
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
        charts.push(output::chart(title, time(), axis, line(0)));
        let axis = Axis::new("velocity", format!("{unit}/s"));
        let title = format!("Velocity of {name}");
        charts.push(output::chart(title, time(), axis, line(1)));
    }
    let initial = run.steps.first().map_or(0.0, |first| first.potential);
    let lines = vec![
        Series::line("kinetic", curve(&|k| run.steps[k].kinetic)),
        Series::line("potential", curve(&|k| run.steps[k].potential - initial)),
        // Often the same curve as another.
        Series::line("work", curve(&|k| run.steps[k].work)).stroke(Stroke::Dashed),
    ];
    let energy = Axis::new("energy", "J");
    charts.push(output::chart("Energies", time(), energy, lines));
    let text = "The free motion under loads and drives, checked by the full multibody equations. The potential energy is zero at the start; the work is that of all forces without a potential.";
    let provenance = FreeMotionRun::method_text();
    // Over one axis more would be longer than two pages.
    let panels = match charts.len() > MAX_STACKED {
        true => charts.into_iter().map(Panel::from).collect(),
        false => vec![charts.into()],
    };
    output::figure(scene, "motion", "Free motion", text, panels, provenance)
}
