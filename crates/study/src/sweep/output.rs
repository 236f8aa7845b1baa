//! `dwell sweep`: results of many variants of a scene, stored in files during the computation.
//!
//! ```text
//! --vary … ── Axis ── Design: point k → values ─┐            (rayon, any order)
//! scene, --result ── RequestedQuantities ───────┴→ PointResult ── PartFolder (a file for each part)
//!                                                               StoredRows → tables, figures, summary
//! ```

use super::export;
use crate::explain::{StudyError, SweepError};
use crate::output::Outcome;
use crate::progress::{Progress, Step};
use crate::sweep::compute::{
    Axis, Design, RequestedQuantities, Shard, SweepRequest, SweptScene, VariationKind, block_length,
};
use crate::sweep::identity::{SCENE_TEXT, StudyIdentity};
use crate::sweep::parts::PartFolder;
use crate::sweep::share::PART_LENGTH;
use dwell_report::{Column, TableFormat};
use rayon::prelude::*;
use std::fs;
use std::path::{Path, PathBuf};

/// Maximum number of rows of a table, which is in memory.
const MAX_ROWS: u64 = 20_000_000;

/// The definition of a parameter sweep.
#[derive(Debug, Clone, Copy)]
pub struct ParameterSweep<'a> {
    /// What it varies and computes.
    pub request: SweepRequest<'a>,
    /// The shard to compute; `None` for the whole study.
    pub shard: Option<Shard>,
    /// Write the rows as a table, too, in this format.
    pub export: Option<TableFormat>,
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
}

impl<'a, S: SweptScene> PreparedSweep<'a, S> {
    fn new(scene: &'a S, sweep: &'a ParameterSweep<'_>) -> Result<Self, StudyError> {
        let (design, requested) = sweep.request.prepare(scene)?;
        let columns = requested.columns(&design);
        let mut inputs: Vec<String> = columns.iter().map(heading).collect();
        let results = inputs.split_off(design.axes.len());
        let refuse = |message: String| Err(SweepError::Design(message).into());
        if let (Some(shard), Some(_)) = (sweep.shard, sweep.export) {
            let message = "--export writes the points of all shards: omit --export or --shard";
            return refuse(format!("{message} {shard}"));
        }
        if design.points > MAX_ROWS && sweep.export.is_some() {
            let points = design.points;
            return refuse(format!(
                "{points} points are more than a table may have ({MAX_ROWS}): leave --export out, and read the Parquet files"
            ));
        }
        let axes = design.axes.iter().map(exact_text);
        let ties = design.ties.iter().map(|tie| &tie.number);
        let ties = ties.map(|tie| format!("{} tied to {}", tie.path, tie.text));
        let exact: Vec<String> = axes.chain(ties).collect();
        let mut wanted = results.clone();
        wanted.extend(requested.limit_texts());
        // A study without random axes has no seed.
        let seed = if design.is_random() {
            design.seed.to_string()
        } else {
            "none".to_owned()
        };
        let study = vec![
            ("scene", scene.name.clone()),
            ("scene_sha256", scene.hash()),
            ("axes", exact.join("; ")),
            ("samples", design.samples.to_string()),
            ("seed", seed),
            ("results", wanted.join("; ")),
            ("points", design.points.to_string()),
            ("dwell", env!("CARGO_PKG_VERSION").to_owned()),
            ("part_length", PART_LENGTH.to_string()),
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
        })
    }

    /// The folder of the rows, which all shards share.
    fn path(&self) -> PathBuf {
        self.sweep.folder.join(format!("{}-sweep", self.scene.name))
    }
}

/// Sweeps a scene: computes the points that are missing in the files of its folder. When the study is complete, writes the figure
/// and the requested table.
///
/// # Errors
/// [`StudyError`] if the sweep is invalid, the unchanged scene cannot be assembled, or a file belongs to another study or cannot
/// be written. A point that cannot be computed is no error: its row contains the message.
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
    let (design, requested) = (&prepared.design, &prepared.requested);
    let headings: [&[String]; 2] = [&prepared.inputs, &prepared.results];
    let path = prepared.path();
    let folder = PartFolder::open(&path, &prepared.study, headings, design, sweep.shard)?;
    let parts = folder.parts()?;
    let pending = parts.iter().map(|part| part.missing).sum();
    let family = scene.family(design, requested);
    let stored = folder.fill(&parts, |points, sink| {
        let blocks = points.par_chunks(block_length(family.as_ref()));
        blocks.try_for_each(|block| {
            let mut rows = Vec::with_capacity(block.len());
            requested.points(scene, design, family.as_ref(), block, &mut |row| {
                rows.push(row);
                progress(Step {
                    total: pending,
                    done: "points",
                });
            });
            sink(rows)
        })
    })?;
    stored.check()?;
    let counts = export::Counts {
        existing: stored.count().saturating_sub(pending),
        computed: pending,
    };
    export::report_sweep(&prepared, &path, &stored, counts)
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
