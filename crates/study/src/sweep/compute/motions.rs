//! Results of the free motion and of the steady cycle of a variant.

use crate::cycle::compute::{CycleResults, CycleSearch, compute_cycle};
use crate::explain::StudyError;
use crate::free_motion::compute::MotionSolver;
use crate::machines::MachineScene;
use crate::models::SolverSettings;
use crate::number_format::{coordinate_unit, force_unit};
use crate::progress::no_progress;
use crate::sweep::compute::SweptScene;
use crate::trajectory::compute::ComputedTrajectory;
use dwell_scene::SceneError;

/// A result by its name and unit.
pub(crate) type NamedUnit = (String, String);

/// The statistics of a column of a motion.
const STATISTICS: [&str; 4] = ["end", "max_abs", "mean", "rms"];

/// The columns of a free motion whose results can be swept.
fn motion_columns<S: SweptScene>(scene: &S, compiled: &S::Rows) -> Vec<NamedUnit> {
    let mut all: Vec<NamedUnit> = Vec::new();
    for (name, is_angle) in (0..).map_while(|k| scene.actuator(k)) {
        let unit = coordinate_unit(is_angle);
        all.push((name.to_owned(), unit.to_owned()));
        all.push((format!("{name}.velocity"), format!("{unit}/s")));
    }
    let reactions = scene.swept_reactions(compiled).into_iter();
    all.extend(reactions.map(|(_, name, unit)| (name, unit.to_owned())));
    all.extend(scene.further_motion_columns());
    all
}

/// The results of a free motion, in their order.
pub(crate) fn motion_quantities<S: SweptScene>(scene: &S, compiled: &S::Rows) -> Vec<NamedUnit> {
    if !scene.has_motion() {
        return Vec::new();
    }
    let mut all = vec![("motion.end".to_owned(), "s".to_owned())];
    for (column, unit) in motion_columns(scene, compiled) {
        let of_column = STATISTICS.map(|of| (format!("motion.{column}.{of}"), unit.clone()));
        all.extend(of_column);
    }
    all
}

/// The values of [`motion_quantities`], with their names.
///
/// # Errors
/// [`StudyError`] if there is no motion, or it ends early.
pub(crate) fn motion_values<S: SweptScene>(
    scene: &S,
    compiled: &S::Rows,
) -> Result<Vec<(String, f64)>, StudyError> {
    let solver = MotionSolver::Settings(SolverSettings::default());
    let mut motion =
        scene.simulate_then(&solver, None, &no_progress, |_, of| of.motion.computed)?;
    if let Some(error) = motion.early_stop.take() {
        return Err(error);
    }
    let columns = motion_columns(scene, compiled);
    let values = statistics(&motion, columns.iter().map(|(name, _)| name))?;
    let names = motion_quantities(scene, compiled).into_iter();
    Ok(names.map(|(name, _)| name).zip(values).collect())
}

/// The end of a motion, s, and of each of some columns the [`STATISTICS`].
fn statistics<'n>(
    motion: &ComputedTrajectory<'_>,
    names: impl Iterator<Item = &'n String>,
) -> Result<Vec<f64>, StudyError> {
    let times = column(motion, "t")?;
    let mut values = vec![times.last().copied().unwrap_or(f64::NAN)];
    for name in names {
        values.extend(statistics_of_column(motion, name, &times)?);
    }
    Ok(values)
}

/// A column of a motion, by row.
fn column(motion: &ComputedTrajectory<'_>, name: &str) -> Result<Vec<f64>, StudyError> {
    let results = &motion.results;
    let found = results.columns.iter().position(|c| c.name == name);
    let found = found.ok_or_else(|| {
        let message = format!("the motion has no column `{name}`");
        SceneError::without_labels(message, None)
    })?;
    Ok(results.rows.iter().map(|row| row[found]).collect())
}

/// The last value of a column, its largest magnitude, also between the rows, its mean over time, and its root mean square.
fn statistics_of_column(
    motion: &ComputedTrajectory<'_>,
    name: &str,
    times: &[f64],
) -> Result<[f64; 4], StudyError> {
    let values = column(motion, name)?;
    let results = &motion.results;
    let columns = results.columns.iter().zip(&results.extrema.of_columns);
    let extrema = columns.filter(|(column, _)| column.name == name);
    let between = extrema.filter_map(|(_, ends)| *ends).flatten();
    let sizes = between.map(|end| end.value.abs());
    let largest = sizes
        .chain(values.iter().map(|v| v.abs()))
        .fold(0.0, f64::max);
    let duration = times.last().zip(times.first());
    let duration = duration.map_or(f64::NAN, |(last, first)| last - first);
    // By trapezoids between the rows.
    let mean_of = |of: fn(f64) -> f64| {
        let pairs = times.windows(2).zip(values.windows(2));
        let sum: f64 = pairs
            .map(|(t, v)| 0.5 * (t[1] - t[0]) * (of(v[0]) + of(v[1])))
            .sum();
        sum / duration
    };
    let end = values.last().copied().unwrap_or(f64::NAN);
    Ok([end, largest, mean_of(|v| v), mean_of(|v| v * v).sqrt()])
}

/// The results of a steady cycle that every machine with drives has.
const CYCLE: [(&str, &str); 5] = [
    ("cycle.period", "s"),
    ("cycle.mean_speed", "rad/s"),
    ("cycle.slowest_speed", "rad/s"),
    ("cycle.fastest_speed", "rad/s"),
    ("cycle.coefficient_of_fluctuation", ""),
];

/// The results of the steady cycle, in their order.
pub(crate) fn cycle_quantities<S: MachineScene>(scene: &S) -> Vec<NamedUnit> {
    if scene.drives().is_empty() {
        return Vec::new();
    }
    let all = CYCLE.map(|(name, unit)| (name.to_owned(), unit.to_owned()));
    let mut all = Vec::from(all);
    for drive in scene.drives() {
        let unit = force_unit(S::is_angle(drive.coordinate)).to_owned();
        all.push((format!("cycle.{}.max_abs", drive.name), unit));
        all.push((format!("cycle.{}.work", drive.name), "J".to_owned()));
    }
    all
}

/// The values of [`cycle_quantities`].
///
/// # Errors
/// [`StudyError`] if there is no steady cycle.
pub(crate) fn cycle_values(scene: &impl MachineScene) -> Result<Vec<f64>, StudyError> {
    let settings = SolverSettings::default();
    let found = match compute_cycle(scene, &settings, None)? {
        CycleSearch::Steady(found) => found,
        CycleSearch::NoCycle { reason, .. } => return Err(reason),
    };
    let cycle = &found.steady;
    let mut values = vec![
        cycle.period,
        cycle.mean_speed,
        cycle.slowest[1],
        cycle.fastest[1],
        cycle.fluctuation,
    ];
    let peaks = peak_forces(&found)?;
    let sources = found.prepared.machine.nonconservative_sources();
    for (drive, peak) in scene.drives().iter().zip(peaks) {
        let mut works = sources.iter().zip(&cycle.works);
        let work = works.find(|(source, _)| scene.name_of_source(**source) == drive.name);
        values.extend([peak, work.map_or(f64::NAN, |(_, work)| *work)]);
    }
    Ok(values)
}

/// The largest magnitude of the force of each drive on the bodies, without the part that accelerates its rotor, at the samples of a cycle:
/// that of the column `<drive>.load_moment` or `<drive>.load_force` of `simulate`.
fn peak_forces(found: &CycleResults<'_, impl MachineScene>) -> Result<Vec<f64>, StudyError> {
    let machine = &found.prepared.machine;
    let mut workspace = machine.workspace();
    let mut peaks = vec![0.0_f64; machine.drives()];
    for point in &found.steady.samples {
        let state = machine.evaluate(point.t, &point.y, &mut workspace);
        let state = state.map_err(|e| found.prepared.explain(&e))?;
        for (peak, force) in peaks.iter_mut().zip(state.net_drive_forces()) {
            *peak = peak.max(force.abs());
        }
    }
    Ok(peaks)
}
