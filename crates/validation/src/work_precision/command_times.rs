//! The seconds of the whole command `dwell simulate --accuracy …`, beside those of its computation.

use super::studied_scene::StudiedScene;
use super::subject::Subject;
use dwell_report::{OutputFolder, ReportError};
use dwell_study::{Outcome, PictureFormat, Pictures, StudyError, no_progress};
use std::fs;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::Instant;

/// The accuracies that the command has names for.
const PRESETS: [(&str, f64); 4] = [
    ("draft", 1e-3),
    ("standard", 1e-6),
    ("precise", 1e-9),
    ("reference", 1e-10),
];

/// The command at one accuracy.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CommandTime {
    /// The name of the accuracy, and the accuracy.
    pub(super) preset: (&'static str, f64),
    /// The estimated error that it reports; none where it fails.
    pub(super) estimated_error: Option<f64>,
    /// The motion with its rows and extrema, without anything written, s.
    pub(super) computing: f64,
    /// The same with tables and page, and with the main pictures too, all in their files, s.
    pub(super) with_files: f64,
    pub(super) with_pictures: f64,
}

/// The command at each accuracy, on the motion of a scene.
pub(super) fn command_times<S: StudiedScene>(scene: &S) -> Result<Vec<CommandTime>, StudyError> {
    let scene = Subject::new(scene)?.scene;
    let one = |preset: (&'static str, f64)| {
        let accuracy = preset.1;
        let started = Instant::now();
        let estimated_error = scene.estimated_error(accuracy)?;
        let computing = started.elapsed().as_secs_f64();
        let [with_files, with_pictures] = whole_command(&scene, accuracy)?;
        Ok(CommandTime {
            preset,
            estimated_error,
            computing,
            with_files,
            with_pictures,
        })
    };
    PRESETS.into_iter().map(one).collect()
}

/// The seconds from the scene in memory to its files in a folder, which is removed afterwards: without pictures, and with
/// the main ones.
fn whole_command<S: StudiedScene>(scene: &S, accuracy: f64) -> Result<[f64; 2], StudyError> {
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    let number = NUMBER.fetch_add(1, Ordering::Relaxed);
    let name = format!("dwell-work-precision-{}-{number}", std::process::id());
    let path = std::env::temp_dir().join(name);
    let started = Instant::now();
    let outcome = scene.simulated(accuracy)?;
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
