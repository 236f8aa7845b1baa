//! All points of a sweep in memory.

use crate::explain::StudyError;
use crate::sweep::compute::{Axis, Design, PointResult, RequestedQuantities};
use dwell_findings::{Column, Table};
use dwell_scene::Scene;
use rayon::prelude::*;

/// The results of a sweep.
#[derive(Debug)]
pub struct SweepTable {
    /// A row for each point: the varied numbers in the scene's units, then the results.
    pub table: Table,
    /// By point: why results are missing.
    pub messages: Vec<Option<String>>,
}

/// Computes a sweep in memory, on all cores. `vary`, `samples`, `seed` and `requests` are those of a
/// [sweep into a file](crate::sweep()).
///
/// # Errors
/// [`StudyError`] where the sweep is invalid, or the unchanged scene cannot be assembled. A point that cannot be computed
/// has a message.
pub fn compute_sweep(
    scene: &Scene,
    vary: &[String],
    samples: Option<u64>,
    seed: u64,
    requests: &[String],
) -> Result<SweepTable, StudyError> {
    let design = Design::new(scene, vary, samples, seed)?;
    let requested = RequestedQuantities::new(scene, requests)?;
    let row = |k: u64| {
        let inputs = design.values(k);
        let paths = design.axes.iter().map(|axis| axis.path.as_str());
        let values: Vec<(&str, f64)> = paths.zip(inputs.iter().copied()).collect();
        let PointResult { values, message } = requested.evaluate(scene, &values);
        ([inputs, values].concat(), message)
    };
    let rows: Vec<_> = (0..design.points).into_par_iter().map(row).collect();
    let input = |axis: &Axis| Column::new(axis.path.clone(), axis.unit.clone());
    let inputs = design.axes.iter().map(input);
    let results = requested.quantities.iter();
    let results = results.map(|q| Column::new(q.name.clone(), q.unit));
    let columns = inputs.chain(results).collect();
    let (rows, messages) = rows.into_iter().unzip();
    Ok(SweepTable {
        table: Table { columns, rows },
        messages,
    })
}
