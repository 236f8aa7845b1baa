//! The rows of a long trajectory: all rows in a temporary file, and every n-th row in memory, for pictures.

use crate::bodies::BodyPose;
use crate::explain::StudyError;
use crate::trajectory::compute::Column;
use dwell_findings::{self as findings, LongTable};
use dwell_scene::SceneError;
use std::io;
use std::sync::Arc;

/// Values in memory at most: 32 MB.
const MAX_VALUES: usize = 4 << 20;

/// The storage of the rows of a trajectory.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum RowStorage {
    /// All in memory.
    Whole,
    /// In a temporary file, if they are many.
    Bounded,
}

/// A row and the poses of the bodies there.
type RowAndPoses = (Vec<f64>, Vec<BodyPose>);

/// All rows of a long trajectory.
pub(crate) struct LongRows {
    /// The rows of the columns that are kept.
    pub(crate) table: Arc<LongTable>,
    /// Every `stride`-th row is also in memory.
    stride: usize,
    /// The row and the poses that were added last, if they are not in memory otherwise.
    last: Option<RowAndPoses>,
    /// Why a row could not be stored.
    failure: Option<io::Error>,
}

impl LongRows {
    /// The storage for this number of positions; `None` if they fit into memory.
    pub(crate) fn new(columns: &[Column], points: usize) -> Result<Option<Self>, StudyError> {
        let stride = (points * columns.len()).div_ceil(MAX_VALUES);
        if stride <= 1 {
            return Ok(None);
        }
        let columns = columns
            .iter()
            .map(|c| findings::Column::new(&c.name, c.unit));
        let table = LongTable::new(columns.collect()).map_err(|e| not_stored(&e))?;
        Ok(Some(Self {
            table: Arc::new(table),
            stride,
            last: None,
            failure: None,
        }))
    }

    /// The number of the `k`th row in memory: every n-th row, and the last one.
    pub(crate) fn row_number(&self, k: usize) -> usize {
        (k * self.stride).min(self.table.len().saturating_sub(1))
    }

    /// Adds a row and its poses; returns them if they are also kept in memory.
    pub(crate) fn add(&mut self, row: Vec<f64>, poses: Vec<BodyPose>) -> Option<RowAndPoses> {
        let is_kept = self.table.len().is_multiple_of(self.stride);
        // While rows are added, nobody else has the table.
        if let Some(table) = Arc::get_mut(&mut self.table)
            && let Err(error) = table.push(&row)
        {
            self.failure.get_or_insert(error);
        }
        self.last = (!is_kept).then(|| (row.clone(), poses.clone()));
        is_kept.then_some((row, poses))
    }

    /// The last row, unless it is in memory already.
    ///
    /// # Errors
    /// Where a row could not be stored.
    pub(crate) fn finish(&mut self) -> Result<Option<RowAndPoses>, StudyError> {
        match self.failure.take() {
            Some(error) => Err(not_stored(&error)),
            None => Ok(self.last.take()),
        }
    }
}

/// The error of rows that the system does not store.
pub(crate) fn not_stored(error: &io::Error) -> StudyError {
    let folder = std::env::temp_dir();
    let message = format!(
        "there are too many rows to keep, and they cannot be stored in `{}`: {error}",
        folder.display()
    );
    let help = "ask for fewer `--points`, list `variables` in [requests], or set TMPDIR to a folder with more room";
    SceneError::without_labels(message, Some(help.to_owned())).into()
}
