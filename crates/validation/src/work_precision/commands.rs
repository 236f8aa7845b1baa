//! The true accuracy of `dwell simulate --accuracy …`, and its cost.

use super::combination::{ErrorQuantity, Errors};
use super::evaluator::Evaluator;
use super::reference_solution::ReferenceSolution;
use super::studied_scene::{CommandedMotion, StudiedScene};
use super::subject::Subject;
use dwell_findings::Table;
use dwell_report::{OutputFolder, ReportError};
use dwell_study::{
    Outcome, PictureFormat, Pictures, StudyError, no_progress, simulate_to_accuracy,
};
use std::fs;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// The accuracies that the command has names for.
pub(super) const PRESETS: [(&str, f64); 4] = [
    ("draft", 1e-3),
    ("standard", 1e-6),
    ("precise", 1e-9),
    ("reference", 1e-10),
];

/// Times that differ by less than this fraction of the motion are equal.
const SAME_TIME: f64 = 1e-12;

/// The command at one accuracy.
#[derive(Debug, Clone, PartialEq)]
pub struct CommandRun {
    /// The name of the accuracy, and the accuracy.
    pub preset: (&'static str, f64),
    /// The method of its motion.
    pub method: String,
    /// Its reported estimated error; `None` if it fails.
    pub estimated_error: Option<f64>,
    /// The true errors of its rows over the studied motion.
    pub errors: Errors,
    /// Whether it reports that the accuracy is reached.
    pub is_reached: bool,
    /// Time of the motion with its rows and extrema, without files, s.
    pub computing: f64,
    /// Time including the files of tables and page, and with the main pictures, too, s.
    pub whole: Option<[f64; 2]>,
}

impl CommandRun {
    /// Whether all true errors, or those of the reference if they are larger, are within the accuracy.
    pub fn keeps_accuracy(&self, reference: &Errors) -> bool {
        let within = |quantity| {
            let error = self.errors.of(quantity);
            error.is_nan() && quantity == ErrorQuantity::Reaction
                || error <= self.preset.1.max(reference.of(quantity))
        };
        ErrorQuantity::ALL.into_iter().all(within)
    }
}

/// The command at each accuracy, on the studied motion.
pub(super) fn command_runs<S: StudiedScene>(
    reference: &mut ReferenceSolution<'_, S>,
    exact: &dyn Evaluator,
    subject: &Subject<S>,
    with_files: bool,
    done: &dyn Fn(&str),
) -> Result<Vec<CommandRun>, StudyError> {
    let scene = subject.scene.lasting(subject.end());
    let one = |preset: (&'static str, f64)| {
        let started = Instant::now();
        let CommandedMotion {
            method,
            estimated_error,
            is_reached,
            table,
        } = CommandedMotion::new(&scene, preset.1)?;
        let computing = started.elapsed().as_secs_f64();
        let states = rows_at(subject, &reference.states, &table);
        // Loads may have no value where there is no row.
        let errors = if states.iter().flatten().all(|value| value.is_finite()) {
            reference.errors(&states, &mut exact.reactions())
        } else {
            Ok(Errors::UNKNOWN)
        };
        let whole = with_files.then(|| whole_command(&scene, preset.1));
        done(&format!("simulate --accuracy {:.0e}", preset.1));
        Ok(CommandRun {
            preset,
            method,
            estimated_error,
            errors: errors.map_err(|e| subject.explain(&e))?,
            is_reached,
            computing,
            whole: whole.transpose()?,
        })
    };
    PRESETS.into_iter().map(one).collect()
}

/// The states of the rows nearest to the compared times: coordinates and speeds from the table; other states (currents, works) from
/// the reference.
fn rows_at<S: StudiedScene>(
    subject: &Subject<S>,
    reference: &[Vec<f64>],
    table: &Table,
) -> Vec<Vec<f64>> {
    let column = |name: &str| table.columns.iter().position(|c| c.name == name);
    let free = subject.machine.free();
    let name = |i: usize| subject.scene.actuator(i).map_or("", |(name, _)| name);
    let names: Vec<String> = free.iter().map(|&i| name(i).to_owned()).collect();
    let speeds = names.iter().map(|name| format!("{name}.velocity"));
    let columns: Vec<Option<usize>> = names
        .iter()
        .cloned()
        .chain(speeds)
        .map(|name| column(&name))
        .collect();
    let time = column("t");
    let at = |row: &[f64]| time.map_or(f64::NAN, |t| row[t]);
    let times = subject.times.iter().zip(reference);
    let states = times.map(|(t, expected)| {
        let mut rows = table.rows.iter();
        let nearest = rows.find(|row| (at(row) - t).abs() <= SAME_TIME * subject.end());
        let mut state = expected.clone();
        for (value, column) in state.iter_mut().zip(&columns) {
            let known = nearest.zip(*column).map(|(row, k)| row[k]);
            // A missing row counts as disagreement.
            *value = known.unwrap_or(f64::NAN);
        }
        state
    });
    states.collect()
}

/// The time, s, from the scene in memory to its files in a folder, which is then removed: without pictures, and with
/// the main ones.
fn whole_command<S: StudiedScene>(scene: &S, accuracy: f64) -> Result<[f64; 2], StudyError> {
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let name = format!("dwell-work-precision-{}-{number}", std::process::id());
    let path = std::env::temp_dir().join(name);
    let started = Instant::now();
    let outcome = simulate_to_accuracy(scene, accuracy, None, &no_progress)?.outcome;
    let computing = started.elapsed().as_secs_f64();
    let written = |outcome: Outcome, pictures: Pictures| -> Result<f64, StudyError> {
        let started = Instant::now();
        let files = outcome
            .draw((pictures, PictureFormat::Png), &no_progress)?
            .files;
        OutputFolder::open(&path)?.write(&files)?;
        Ok(computing + started.elapsed().as_secs_f64())
    };
    let without = written(outcome.clone(), Pictures::None);
    let seconds = without.and_then(|without| Ok([without, written(outcome, Pictures::Main)?]));
    let removed = fs::remove_dir_all(&path);
    removed.map_err(|source| ReportError::File { path, source })?;
    seconds
}
