//! A whole sweep in memory.

use crate::explain::StudyError;
use crate::progress::{Progress, Step};
use crate::sweep::compute::point::PointResult;
use crate::sweep::compute::{Design, RequestedQuantities, Row, SweptScene, VariantFamily};
use dwell_dynamics::interruption;
use dwell_findings::{Column, Table};
use rayon::prelude::*;

/// The points of a sweep.
#[derive(Debug)]
pub struct ComputedSweep {
    /// A row for each point: the varied numbers, then the results; NaN if there is none.
    pub table: Table,
    /// By point: why not all results could be computed.
    pub messages: Vec<Option<String>>,
    /// A line for each body far from its approximate angle.
    pub notes: String,
}

/// What a sweep varies and computes, each as an option of `dwell sweep`.
#[derive(Debug, Clone, Copy, Default)]
pub struct SweepRequest<'a> {
    /// The variations: `PATH=FROM:TO:COUNT`, `PATH=A,B,C`, `PATH~normal(MEAN,SD)`, `PATH~uniform(FROM,TO)`,
    /// `PATH±TOLERANCE`, `PATH±PERCENT%`, each in the scene's unit.
    pub vary: &'a [String],
    /// The numbers that follow from others, besides those of the scene: `PATH=EXPRESSION`.
    pub tied: &'a [String],
    /// Number of random samples.
    pub samples: Option<u64>,
    /// Random seed.
    pub seed: u64,
    /// Result columns to compute, by name or prefix; empty for all.
    pub requests: &'a [String],
    /// The limits of results, besides those of the scene: `RESULT <= LIMIT`, `RESULT >= LIMIT`.
    pub limits: &'a [String],
}

impl SweepRequest<'_> {
    /// The points and the results.
    ///
    /// # Errors
    /// [`StudyError`] if the sweep is invalid or the unchanged scene cannot be assembled.
    pub(crate) fn prepare(
        &self,
        scene: &impl SweptScene,
    ) -> Result<(Design, RequestedQuantities), StudyError> {
        let design = Design::new(scene, self.vary, self.samples, self.seed)?;
        let requested = RequestedQuantities::within(scene, self.requests, self.limits)?;
        Ok((design.tied(scene, self.tied)?, requested))
    }
}

/// Computes all points of a sweep on all cores: `vary` and `requests` are those of
/// `dwell sweep`, `samples` the number of random samples. Every computed block of points is a step of progress.
///
/// # Errors
/// [`StudyError`] if the sweep is invalid or the unchanged scene cannot be assembled. A point that cannot be
/// computed is no error: it has a message.
pub fn compute_sweep(
    scene: &impl SweptScene,
    vary: &[String],
    samples: Option<u64>,
    seed: u64,
    requests: &[String],
    progress: Progress<'_>,
) -> Result<ComputedSweep, StudyError> {
    let request = SweepRequest {
        vary,
        samples,
        seed,
        requests,
        ..SweepRequest::default()
    };
    compute_request(scene, &request, progress)
}

/// Computes all points of a sweep on all cores. Every computed block of points is a step of progress.
///
/// # Errors
/// As of [`compute_sweep`].
pub fn compute_request(
    scene: &impl SweptScene,
    request: &SweepRequest<'_>,
    progress: Progress<'_>,
) -> Result<ComputedSweep, StudyError> {
    let (design, requested) = request.prepare(scene)?;
    let rows = compute_rows(scene, &design, &requested, progress)?;
    Ok(ComputedSweep {
        table: requested.table(&design, &rows),
        messages: rows.into_iter().map(|row| row.result.message).collect(),
        notes: requested.notes,
    })
}

/// Computes all points of a design on all cores.
///
/// # Errors
/// [`StudyError`] if the computation is interrupted.
pub(crate) fn compute_rows(
    scene: &impl SweptScene,
    design: &Design,
    requested: &RequestedQuantities,
    progress: Progress<'_>,
) -> Result<Vec<Row>, StudyError> {
    let family = scene.family(design, requested);
    let indices: Vec<u64> = (0..design.points).collect();
    let length = block_length(family.as_ref());
    let total = indices.len().div_ceil(length);
    let blocks = indices.par_chunks(length).map(|block| {
        let mut rows = Vec::with_capacity(block.len());
        if interruption::is_requested() {
            return rows;
        }
        let mut keep = |row| rows.push(row);
        requested.points(scene, design, family.as_ref(), block, &mut keep);
        progress(Step {
            total,
            done: "points",
        });
        rows
    });
    let rows: Vec<Row> = blocks.flatten_iter().collect();
    if rows.len() < indices.len() {
        let message = "the computation was interrupted".to_owned();
        return Err(scene.error(message, None, &[]).into());
    }
    Ok(rows)
}

/// Points that one thread computes in a row: of a family as many as make the copy of its model cheap.
pub(crate) fn block_length(family: Option<&VariantFamily>) -> usize {
    if family.is_some() { 256 } else { 1 }
}

impl RequestedQuantities {
    /// The columns of a table: the varied numbers, then the results.
    pub(crate) fn columns(&self, design: &Design) -> Vec<Column> {
        let inputs = design.axes.iter().map(|a| Column::new(&a.path, &a.unit));
        let results = self
            .quantities
            .iter()
            .map(|q| Column::new(&q.name, &q.unit));
        inputs.chain(results).collect()
    }

    /// Inputs and results.
    pub(crate) fn table(&self, design: &Design, rows: &[Row]) -> Table {
        let row = |row: &Row| [row.inputs.as_slice(), &row.result.values].concat();
        Table {
            columns: self.columns(design),
            rows: rows.iter().map(row).collect(),
        }
    }

    /// Computes the points of some indices, one after another: in the structure of their family, or by separate
    /// compilations if there is no family or a point does not fit it.
    pub(crate) fn points(
        &self,
        scene: &impl SweptScene,
        design: &Design,
        family: Option<&VariantFamily>,
        indices: &[u64],
        done: &mut dyn FnMut(Row),
    ) {
        let inputs: Vec<Vec<f64>> = indices.iter().map(|&k| design.values(k)).collect();
        let numbers: Vec<Vec<f64>> = inputs.iter().map(|of| design.numbers(of)).collect();
        let mut known: Vec<Option<Vec<f64>>> = Vec::with_capacity(indices.len());
        if let Some(family) = family {
            let mut keep = |_: usize, found| known.push(found);
            family.evaluate(&numbers, &self.quantities, &mut keep);
        }
        let known = known.into_iter().chain(std::iter::repeat(None));
        let points = indices.iter().zip(inputs).zip(&numbers);
        for (((&index, inputs), numbers), values) in points.zip(known) {
            let result = match values {
                Some(values) => PointResult {
                    values,
                    message: None,
                },
                None => self.evaluate(scene, &design.assigned(numbers)),
            };
            done(Row {
                index,
                inputs,
                result: self.limited(result),
            });
        }
    }
}
