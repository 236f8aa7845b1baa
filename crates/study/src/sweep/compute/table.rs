//! A whole sweep in memory.

use crate::explain::StudyError;
use crate::sweep::compute::{Design, PointResult, RequestedQuantities};
use dwell_findings::{Column, Table};
use dwell_scene::Scene;
use rayon::prelude::*;

/// The points of a sweep.
#[derive(Debug)]
pub struct ComputedSweep {
    /// A row for each point: the varied numbers, then the results; NaN where there is none.
    pub table: Table,
    /// By point: why not all results could be computed.
    pub messages: Vec<Option<String>>,
    /// A line for each requested result that is called by a former name.
    pub notes: String,
}

/// Computes all points of a sweep on all cores: `vary` and `requests` are those of
/// `dwell sweep`, `samples` the number of random samples.
///
/// # Errors
/// [`StudyError`] where the sweep is invalid or the unchanged scene cannot be assembled. A point that cannot be
/// computed is no error: it has a message.
pub fn compute_sweep(
    scene: &Scene,
    vary: &[String],
    samples: Option<u64>,
    seed: u64,
    requests: &[String],
) -> Result<ComputedSweep, StudyError> {
    let design = Design::new(scene, vary, samples, seed)?;
    let requested = RequestedQuantities::new(scene, requests)?;
    let point = |k: u64| -> (Vec<f64>, Option<String>) {
        let (inputs, PointResult { values, message }) = requested.point(scene, &design, k);
        ([inputs, values].concat(), message)
    };
    let points: Vec<_> = (0..design.points).into_par_iter().map(point).collect();
    let (rows, messages) = points.into_iter().unzip();
    Ok(ComputedSweep {
        table: Table {
            columns: requested.columns(&design),
            rows,
        },
        messages,
        notes: requested.notes,
    })
}

impl RequestedQuantities {
    /// The columns of a table: the varied numbers, then the results.
    pub(crate) fn columns(&self, design: &Design) -> Vec<Column> {
        let inputs = design.axes.iter().map(|a| Column::new(&a.path, &a.unit));
        let results = self.quantities.iter().map(|q| Column::new(&q.name, q.unit));
        inputs.chain(results).collect()
    }

    /// The inputs and the results of point `k`.
    pub(crate) fn point(&self, scene: &Scene, design: &Design, k: u64) -> (Vec<f64>, PointResult) {
        let inputs = design.values(k);
        let paths = design.axes.iter().map(|axis| axis.path.as_str());
        let values: Vec<(&str, f64)> = paths.zip(inputs.iter().copied()).collect();
        let result = self.evaluate(scene, &values);
        (inputs, result)
    }
}
