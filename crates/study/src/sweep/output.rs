//! `dwell sweep`: results of many variants of a scene, stored in a file as they are computed.
//!
//! ```text
//! --vary … ── Axis ── Design: point k → values ─┐            (rayon, any order)
//! scene, --result ── RequestedQuantities ───────┴→ PointResult ─┬ channel ── Store (one writer)
//!                                                               └ PartFolder (a file for each part)
//!                                              StoredResults → tables, figures, summary
//! ```

use super::export;
use crate::explain::{StudyError, SweepError};
use crate::output::Outcome;
use crate::progress::{Progress, Step};
use crate::sweep::compute::{
    Axis, Design, RequestedQuantities, Row, Shard, SweptScene, VariationKind, block_length,
};
use crate::sweep::parts::PartFolder;
use crate::sweep::store::{SCENE_TEXT, SHARD, Store, StoreFault, StudyIdentity};
use crate::sweep::store_check::ExpectedPoints;
use crate::sweep::stored::{LoadedRows, StoredResults as _};
use dwell_report::{Column, TableFormat};
use dwell_scene::SceneFile;
use rayon::prelude::*;
use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::sync_channel;

/// Rows queued for the writer before the workers wait.
const QUEUE_LENGTH: usize = 4096;
/// Maximum number of input and result columns: SQLite's default limit is 2000 in all.
const MAX_COLUMNS: usize = 1900;
/// The shard entry of a file that holds the whole study.
const WHOLE_STUDY: &str = "all";

/// Points from which a study is stored in Parquet files unless it is said otherwise: SQLite's single writer would then be
/// what takes the time.
const PARQUET_FROM: u64 = 100_000;
/// Maximum number of rows in memory, for SQLite files and tables.
const MAX_ROWS: u64 = 20_000_000;
/// Points of a Parquet file where a variant takes some microseconds, and where each is compiled: what an interruption
/// may lose is computed again in seconds.
const PART_LENGTHS: [u64; 2] = [65_536, 4096];

/// The kind of file that the rows of a sweep are stored in.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RowStore {
    /// One SQLite file.
    Sqlite,
    /// A folder of Parquet files.
    Parquet,
}

/// The definition of a parameter sweep.
#[derive(Debug, Clone, Copy)]
pub struct ParameterSweep<'a> {
    /// What varies: `PATH=FROM:TO:COUNT`, `PATH=A,B,C`, `PATH~normal(MEAN,SD)`, `PATH~uniform(FROM,TO)`,
    /// `PATH±TOLERANCE`, `PATH±PERCENT%`, each in the scene's unit.
    pub vary: &'a [String],
    /// Number of random samples.
    pub samples: Option<u64>,
    /// Random seed.
    pub seed: u64,
    /// Result columns to compute, by name or prefix; empty for all.
    pub requests: &'a [String],
    /// The shard to compute; `None` for the whole study.
    pub shard: Option<Shard>,
    /// Compute nothing; export the stored rows in this format.
    pub export: Option<TableFormat>,
    /// Where rows are stored; `None` chooses by the number of points.
    pub store: Option<RowStore>,
    /// The output folder.
    pub folder: &'a Path,
}

/// A validated sweep, ready to compute.
pub(crate) struct PreparedSweep<'a, S> {
    pub(crate) scene: &'a S,
    pub(crate) sweep: &'a ParameterSweep<'a>,
    pub(crate) design: Design,
    pub(crate) requested: RequestedQuantities,
    pub(crate) study: StudyIdentity,
    pub(crate) inputs: Vec<String>,
    pub(crate) results: Vec<String>,
    pub(crate) store: RowStore,
}

impl<'a, S: SweptScene> PreparedSweep<'a, S> {
    fn new(scene: &'a S, sweep: &'a ParameterSweep<'_>) -> Result<Self, StudyError> {
        let design = Design::new(scene, sweep.vary, sweep.samples, sweep.seed)?;
        let requested = RequestedQuantities::new(scene, sweep.requests)?;
        let columns = requested.columns(&design);
        let mut inputs: Vec<String> = columns.iter().map(heading).collect();
        let results = inputs.split_off(design.axes.len());
        let columns = columns.len();
        let refuse = |message: String| Err(SweepError::Design(message).into());
        if columns > MAX_COLUMNS {
            let fault = "exceed what a file can hold: select results with --result";
            return refuse(format!("{columns} columns {fault}"));
        }
        if let (Some(shard), Some(_)) = (sweep.shard, sweep.export) {
            let message = "an export gathers all shards: leave --shard";
            return refuse(format!("{message} {shard} out"));
        }
        let by_size = match design.points < PARQUET_FROM {
            true => RowStore::Sqlite,
            false => RowStore::Parquet,
        };
        let store = sweep.store.unwrap_or(by_size);
        if design.points > MAX_ROWS && (store == RowStore::Sqlite || sweep.export.is_some()) {
            let points = design.points;
            let limit = "are more than an SQLite file or a table may have";
            return refuse(format!(
                "{points} points {limit} ({MAX_ROWS}): leave --store and --export out, and read the Parquet files"
            ));
        }
        let exact: Vec<String> = design.axes.iter().map(exact_text).collect();
        let shard = sweep.shard.map(|shard| shard.to_string());
        let shard = shard.unwrap_or_else(|| WHOLE_STUDY.to_owned());
        // A study without random axes has no seed.
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
            (SCENE_TEXT, scene.source.inner().clone()),
        ];
        Ok(Self {
            scene,
            sweep,
            design,
            requested,
            study,
            inputs,
            results,
            store,
        })
    }

    /// The SQLite file of the shard, or of the whole study.
    fn sqlite_path(&self) -> PathBuf {
        let name = match self.sweep.shard {
            None => format!("{}-sweep.sqlite", self.scene.name),
            Some(Shard { part, of }) => format!("{}-sweep-{part}-of-{of}.sqlite", self.scene.name),
        };
        self.sweep.folder.join(name)
    }

    /// The folder of Parquet files, which all shards share.
    fn parquet_path(&self) -> PathBuf {
        self.sweep.folder.join(format!("{}-sweep", self.scene.name))
    }

    /// Rows of this scene in the other kind of file would be left out without a word.
    fn refuse_other_store(&self) -> Result<(), SweepError> {
        let (other, option) = match self.store {
            RowStore::Sqlite => (self.parquet_path(), "parquet"),
            RowStore::Parquet => (self.sqlite_path(), "sqlite"),
        };
        if !other.exists() {
            return Ok(());
        }
        let fault = format!(
            "rows of a sweep of this scene are stored there: continue it with --store {option}, or move it"
        );
        Err(StoreFault::Reason(fault).with_path(&other))
    }

    /// Opens the file of a shard, or that of the whole study.
    fn open(&self, path: &Path, shard: Option<Shard>) -> Result<Store<'_>, SweepError> {
        let mut study = self.study.clone();
        if let Some(shard) = shard {
            study.retain(|(key, _)| *key != SHARD);
            study.push((SHARD, shard.to_string()));
        }
        let headings: [&[String]; 2] = [&self.inputs, &self.results];
        let points = ExpectedPoints {
            design: &self.design,
            shard,
        };
        Store::open(path, &study, headings, points).map_err(|e| e.with_path(path))
    }
}

/// Sweeps a scene: computes the points that its file in the folder does not hold yet, and writes tables and
/// figures once the study is complete. Rows of shard files in the folder are imported first.
///
/// # Errors
/// [`StudyError`] where the sweep is invalid, the unchanged scene cannot be assembled, or the file holds another
/// study or cannot be written. A point that cannot be computed is no error: its row holds the message.
pub fn sweep(
    scene: &impl SweptScene,
    sweep: &ParameterSweep<'_>,
    progress: Progress<'_>,
) -> Result<Outcome, StudyError> {
    let prepared = PreparedSweep::new(scene, sweep)?;
    fs::create_dir_all(sweep.folder).map_err(|e| SweepError::Store {
        path: sweep.folder.to_owned(),
        reason: format!("the folder cannot be created: {e}"),
    })?;
    prepared.refuse_other_store()?;
    match prepared.store {
        RowStore::Sqlite => sweep_to_sqlite(&prepared, progress),
        RowStore::Parquet => sweep_to_parquet(&prepared, progress),
    }
}

/// A sweep whose rows go to an SQLite file.
fn sweep_to_sqlite(
    prepared: &PreparedSweep<'_, impl SweptScene>,
    progress: Progress<'_>,
) -> Result<Outcome, StudyError> {
    let (scene, sweep) = (prepared.scene, prepared.sweep);
    let path = prepared.sqlite_path();
    let mut store = prepared.open(&path, sweep.shard)?;
    let mut existing: BTreeSet<u64> = store.indices()?.into_iter().collect();
    let existing_count = existing.len();
    if sweep.shard.is_none() {
        for (path, shard) in shard_files(scene, sweep.folder) {
            let rows = prepared.open(&path, Some(shard))?.rows()?;
            let new = rows.into_iter().filter(|row| existing.insert(row.index));
            let new: Vec<Row> = new.collect();
            write_from(&mut store, |sender| {
                new.into_iter().try_for_each(|row| sender.send(row).ok())
            })?;
        }
    }
    let is_in_shard = |k: &u64| sweep.shard.is_none_or(|shard| shard.contains(*k));
    let all = || (0..prepared.design.points).filter(is_in_shard);
    let imported = existing.len() - existing_count;
    let mut computed = 0;
    if sweep.export.is_none() {
        let pending: Vec<u64> = all().filter(|k| !existing.contains(k)).collect();
        compute(prepared, &mut store, &pending, progress)?;
        computed = pending.len();
    }
    let rows = store.rows()?;
    let counts = export::Counts {
        existing: existing_count,
        imported,
        computed,
        missing: all().count().saturating_sub(rows.len()),
    };
    export::report_sweep(prepared, &path, &LoadedRows::new(rows), counts)
}

/// A sweep whose rows go to Parquet files: a thread that has computed a part writes it.
fn sweep_to_parquet(
    prepared: &PreparedSweep<'_, impl SweptScene>,
    progress: Progress<'_>,
) -> Result<Outcome, StudyError> {
    let (design, requested) = (&prepared.design, &prepared.requested);
    let family = prepared.scene.family(design, requested);
    let length = PART_LENGTHS[usize::from(family.is_none())];
    let mut study = prepared.study.clone();
    study.retain(|(key, _)| *key != SHARD);
    study.push(("part_length", length.to_string()));
    let headings: [&[String]; 2] = [&prepared.inputs, &prepared.results];
    let path = prepared.parquet_path();
    let shard = prepared.sweep.shard;
    let mut folder = PartFolder::open(&path, &study, headings, (design, length, shard))?;
    let pending: u64 = folder
        .missing
        .iter()
        .map(|part| part.end - part.start)
        .sum();
    let pending = usize::try_from(pending).unwrap_or(usize::MAX);
    let mut counts = export::Counts {
        existing: folder.points().count(),
        imported: 0,
        computed: 0,
        missing: pending,
    };
    if prepared.sweep.export.is_none() {
        let study = (prepared.scene, design, family.as_ref());
        folder.missing.par_iter().try_for_each(|part| {
            let indices: Vec<u64> = part.clone().collect();
            let blocks = indices.par_chunks(block_length(family.as_ref()));
            let rows = blocks.flat_map_iter(|block| {
                let mut rows = Vec::with_capacity(block.len());
                requested.points(study, block, &mut |row| {
                    rows.push(row);
                    progress(Step {
                        total: pending,
                        done: "points",
                    });
                });
                rows
            });
            folder.write(part, &rows.collect::<Vec<Row>>())
        })?;
        folder.complete();
        (counts.computed, counts.missing) = (pending, 0);
    }
    folder.check_inputs()?;
    export::report_sweep(prepared, &path, &folder, counts)
}

/// Computes points on all cores; a single writer stores them as they arrive.
fn compute(
    prepared: &PreparedSweep<'_, impl SweptScene>,
    store: &mut Store<'_>,
    pending: &[u64],
    progress: Progress<'_>,
) -> Result<(), StudyError> {
    let (requested, design) = (&prepared.requested, &prepared.design);
    let family = prepared.scene.family(design, requested);
    let study = (prepared.scene, design, family.as_ref());
    write_from(store, |sender| {
        let blocks = pending.par_chunks(block_length(family.as_ref()));
        blocks.try_for_each_with(sender, |sender, block| {
            let mut written = Some(());
            requested.points(study, block, &mut |row| {
                // If the writer has failed, nothing more is computed.
                written = written.and_then(|()| sender.send(row).ok());
                progress(Step {
                    total: pending.len(),
                    done: "points",
                });
            });
            written
        })
    })
}

/// Writes what another thread sends.
fn write_from(
    store: &mut Store<'_>,
    work: impl FnOnce(std::sync::mpsc::SyncSender<Row>) -> Option<()> + Send,
) -> Result<(), StudyError> {
    let (sender, receiver) = sync_channel(QUEUE_LENGTH);
    std::thread::scope(|scope| {
        scope.spawn(move || work(sender));
        let written = store.write_rows(&receiver);
        // Senders then see that the channel is closed.
        drop(receiver);
        Ok(written?)
    })
}

/// The files of shards of this scene in a folder, each with its part: `1/3`.
fn shard_files(scene: &SceneFile, folder: &Path) -> Vec<(PathBuf, Shard)> {
    let Ok(entries) = fs::read_dir(folder) else {
        return Vec::new();
    };
    let part = |path: &Path| -> Option<Shard> {
        let name = path.file_name()?.to_str()?;
        let name = name.strip_prefix(&format!("{}-sweep-", scene.name))?;
        let (part, of) = name.strip_suffix(".sqlite")?.split_once("-of-")?;
        format!("{part}/{of}").parse().ok()
    };
    let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
    let files = paths.filter_map(|path| part(&path).map(|shard| (path, shard)));
    let mut files: Vec<(PathBuf, Shard)> = files.collect();
    files.sort_by(|a, b| a.0.cmp(&b.0));
    files
}

/// `name [unit]`.
fn heading(column: &Column) -> String {
    match column.unit.as_str() {
        "" => column.name.clone(),
        unit => format!("{} [{unit}]", column.name),
    }
}

/// An axis with all digits, as the store records it.
fn exact_text(axis: &Axis) -> String {
    let path = &axis.path;
    match &axis.kind {
        VariationKind::Grid { from, to, count } => format!("{path}={from:?}:{to:?}:{count}"),
        VariationKind::Listed(values) => {
            let values: Vec<String> = values.iter().map(|v| format!("{v:?}")).collect();
            format!("{path}={}", values.join(","))
        }
        VariationKind::Normal { mean, deviation } => {
            format!("{path}~normal({mean:?},{deviation:?})")
        }
        VariationKind::Uniform { from, to } => format!("{path}~uniform({from:?},{to:?})"),
    }
}
