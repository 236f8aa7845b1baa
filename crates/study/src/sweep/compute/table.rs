//! A whole sweep in memory.

use crate::explain::StudyError;
use crate::sweep::compute::{Design, RequestedQuantities, Row};
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
    let points = (0..design.points).into_par_iter();
    let rows: Vec<Row> = points.map(|k| requested.point(scene, &design, k)).collect();
    Ok(ComputedSweep {
        table: requested.table(&design, &rows),
        messages: rows.into_iter().map(|row| row.result.message).collect(),
        notes: requested.notes,
    })
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

    /// Computes the point of an index.
    pub(crate) fn point(&self, scene: &Scene, design: &Design, index: u64) -> Row {
        let inputs = design.values(index);
        let paths = design.axes.iter().map(|axis| axis.path.as_str());
        let values: Vec<(&str, f64)> = paths.zip(inputs.iter().copied()).collect();
        let result = self.evaluate(scene, &values);
        Row {
            index,
            inputs,
            result,
        }
    }
}
