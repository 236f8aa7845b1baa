//! `dwell sweep`: a study of many variants of a scene, whose results stay in a file as they are computed.
//!
//! ```text
//! --vary … ── Axis ── Design: point k → values ─┐            (rayon, any order)
//! scene, --want ── Wanted ──────────────────────┴→ Found ── channel ── Store (one writer)
//!                                                                        └→ Table, figures, summary
//! ```

mod axes;
mod design;
mod error;
mod export;
mod figure;
mod point;
mod random;
mod spread;
mod store;
#[cfg(test)]
mod tests;

pub use design::Shard;
pub use error::SweepError;
pub use export::Exported;

use crate::error::StudyError;
use crate::outcome::{Outcome, Progress, Step};
use design::Design;
use dwell_scene::Scene;
use point::Wanted;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::sync_channel;
use store::{Row, SHARD, Store, Study, TEXT};

/// Rows that wait for the writer before the workers do.
const WAITING: usize = 4096;
/// Most columns of inputs and results: what SQLite takes by default is 2000 in all.
const MOST_COLUMNS: usize = 1900;
/// What a file says of its part of the study when it holds all of it.
const WHOLE: &str = "all";

/// What is to be swept.
#[derive(Debug, Clone, Copy)]
pub struct Sweep<'a> {
    /// What varies: `PATH=FROM:TO:COUNT`, `PATH=A,B,C`, `PATH~normal(MEAN,SD)`, `PATH~uniform(FROM,TO)`,
    /// `PATH±TOLERANCE`, `PATH±PERCENT%`, each in the scene's unit.
    pub vary: &'a [String],
    /// Samples of what is random.
    pub samples: Option<u64>,
    /// Which random numbers.
    pub seed: u64,
    /// The results that are wanted, by name or the beginning of one; all if there are none.
    pub want: &'a [String],
    /// The part of the study that is computed; all of it if there is none.
    pub shard: Option<Shard>,
    /// Nothing is computed: what is there is written in this form.
    pub export: Option<Exported>,
    /// The folder of the files.
    pub folder: &'a Path,
}

/// A study put together.
struct Prepared<'a> {
    scene: &'a Scene,
    design: Design,
    wanted: Wanted,
    study: Study,
    inputs: Vec<String>,
    results: Vec<String>,
}

impl<'a> Prepared<'a> {
    fn new(scene: &'a Scene, sweep: &Sweep<'_>) -> Result<Self, StudyError> {
        let design = Design::new(scene, sweep.vary, sweep.samples, sweep.seed)?;
        let wanted = Wanted::new(scene, sweep.want)?;
        let inputs: Vec<String> = design.axes.iter().map(axes::Axis::heading).collect();
        let results: Vec<String> = wanted.quantities.iter().map(|q| q.heading()).collect();
        let columns = inputs.len() + results.len();
        if columns > MOST_COLUMNS {
            return Err(SweepError::Design(format!(
                "{columns} columns are more than a file holds: name the results with --want"
            ))
            .into());
        }
        if let Some(shard) = sweep.shard
            && sweep.export.is_some()
        {
            return Err(SweepError::Design(format!(
                "an export gathers all shards: leave --shard {shard} out"
            ))
            .into());
        }
        let exact: Vec<String> = design.axes.iter().map(axes::Axis::exact).collect();
        let shard = sweep.shard.map_or(WHOLE.to_owned(), |s| s.to_string());
        // What draws nothing has none.
        let seed = match design.is_random() {
            true => design.seed.to_string(),
            false => "none".to_owned(),
        };
        let study = vec![
            ("scene", scene.name.clone()),
            ("scene_sha256", scene.hash()),
            ("axes", exact.join("; ")),
            ("samples", design.samples.to_string()),
            ("seed", seed),
            ("results", results.join("; ")),
            ("points", design.points.to_string()),
            ("dwell", env!("CARGO_PKG_VERSION").to_owned()),
            (SHARD, shard),
            (TEXT, scene.source.inner().clone()),
        ];
        Ok(Self {
            scene,
            design,
            wanted,
            study,
            inputs,
            results,
        })
    }

    fn open(&self, path: &Path, shard: Option<&str>) -> Result<Store, SweepError> {
        let mut study = self.study.clone();
        if let Some(shard) = shard {
            let of = study.iter_mut().filter(|(key, _)| *key == SHARD);
            of.for_each(|(_, value)| shard.clone_into(value));
        }
        Store::open(path, &study, [&self.inputs, &self.results])
    }

    /// The point with its values and what it comes to.
    fn row(&self, index: u64) -> Row {
        let inputs = self.design.values(index);
        let paths = self.design.axes.iter().map(|axis| axis.path.as_str());
        let values: Vec<(&str, f64)> = paths.zip(inputs.iter().copied()).collect();
        let found = self.wanted.at(self.scene, &values);
        Row {
            index,
            inputs,
            found,
        }
    }
}

/// Sweeps a scene: computes the points that its file in the folder does not hold yet, and when the whole study
/// is there, writes it up. Rows of the files of shards beside it are taken over first.
///
/// # Errors
/// [`StudyError`] where the study makes no sense, the scene as it is cannot be put together, or the file holds
/// another study or cannot be written. A point that cannot be computed is no error: its row says why.
pub fn sweep(
    scene: &Scene,
    sweep: &Sweep<'_>,
    progress: Progress<'_>,
) -> Result<Outcome, StudyError> {
    let prepared = Prepared::new(scene, sweep)?;
    fs::create_dir_all(sweep.folder).map_err(|e| SweepError::Store {
        path: sweep.folder.to_owned(),
        reason: format!("the folder cannot be made: {e}"),
    })?;
    let name = match sweep.shard {
        None => format!("{}-sweep.sqlite", scene.name),
        Some(Shard { part, of }) => format!("{}-sweep-{part}-of-{of}.sqlite", scene.name),
    };
    let path = sweep.folder.join(name);
    let mut store = prepared.open(&path, None)?;
    let mut there: BTreeSet<u64> = store.indices()?.into_iter().collect();
    let before = there.len();
    if sweep.shard.is_none() {
        for (path, shard) in shards(scene, sweep.folder) {
            let rows = prepared.open(&path, Some(&shard))?.rows()?;
            let new = rows.into_iter().filter(|row| there.insert(row.index));
            let new: Vec<Row> = new.collect();
            send(&mut store, |sender| {
                new.into_iter().try_for_each(|row| sender.send(row).ok())
            })?;
        }
    }
    let mine = |k: &u64| sweep.shard.is_none_or(|shard| shard.has(*k));
    let all = || (0..prepared.design.points).filter(mine);
    let taken = there.len() - before;
    let mut computed = 0;
    if sweep.export.is_none() {
        let pending: Vec<u64> = all().filter(|k| !there.contains(k)).collect();
        compute(&prepared, &mut store, &pending, progress)?;
        computed = pending.len();
    }
    let rows = store.rows()?;
    let counts = export::Counts {
        found: before,
        taken,
        computed,
        missing: all().count().saturating_sub(rows.len()),
    };
    export::write_up(&prepared, sweep, &path, &rows, counts)
}

/// Computes points on all cores; one writer takes them as they come.
fn compute(
    prepared: &Prepared<'_>,
    store: &mut Store,
    pending: &[u64],
    progress: Progress<'_>,
) -> Result<(), StudyError> {
    send(store, |sender| {
        pending.par_iter().try_for_each_with(sender, |sender, &k| {
            // A writer that is gone has its reason: nothing more is computed.
            sender.send(prepared.row(k)).ok()?;
            progress(Step {
                total: pending.len(),
                done: "points",
            });
            Some(())
        })
    })
}

/// Writes what another thread sends.
fn send(
    store: &mut Store,
    work: impl FnOnce(std::sync::mpsc::SyncSender<Row>) -> Option<()> + Send,
) -> Result<(), StudyError> {
    let (sender, receiver) = sync_channel(WAITING);
    std::thread::scope(|scope| {
        scope.spawn(move || work(sender));
        let written = store.take(&receiver);
        // Whoever still sends learns that no one listens.
        drop(receiver);
        Ok(written?)
    })
}

/// The files of shards of this scene in a folder, each with its part: `1/3`.
fn shards(scene: &Scene, folder: &Path) -> Vec<(PathBuf, String)> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let part = |path: &Path| -> Option<String> {
        let name = path.file_name()?.to_str()?;
        let name = name.strip_prefix(&format!("{}-sweep-", scene.name))?;
        let (part, of) = name.strip_suffix(".sqlite")?.split_once("-of-")?;
        let shard: Shard = format!("{part}/{of}").parse().ok()?;
        Some(shard.to_string())
    };
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let mut found: Vec<(PathBuf, String)> = paths
        .filter_map(|path| part(&path).map(|shard| (path, shard)))
        .collect();
    found.sort();
    found
}
