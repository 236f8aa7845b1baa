//! The stored results of a sweep, by result instead of by row, so that a study of 10⁸ points is reported with one
//! column in memory.

use crate::explain::SweepError;
use crate::sweep::compute::{LEFT_OUT, Row};
use crate::sweep::parts::PartFolder;
use crate::sweep::parts::part_file::{PartFault, PartFile};
use crate::sweep::share::Share;
use rayon::prelude::*;
use std::ops::Range;

/// The points of a part that a run has.
pub(super) enum Held {
    /// All, in the file of the part.
    Whole(Range<u64>),
    /// The rows of a shard.
    Rows(Vec<Row>),
}

/// The stored points of a run: all of a study, or those of a shard.
pub(crate) struct StoredRows<'a> {
    folder: PartFolder<'a>,
    held: Vec<Held>,
}

/// The points without all results.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct FailedPoints {
    pub(crate) count: usize,
    /// Number of points beyond a limit, which are none of them.
    pub(crate) left_out: usize,
    /// The first of them, with their messages.
    pub(crate) first: Vec<(u64, String)>,
}

/// Maximum number of messages in a summary.
const MAX_LISTED: usize = 3;

impl FailedPoints {
    /// The counts for points and their messages, if they have one.
    fn of(points: impl Iterator<Item = (u64, Option<String>)>) -> Self {
        let mut failed = Self::default();
        for (index, message) in points.filter_map(|(k, message)| Some((k, message?))) {
            if message.starts_with(LEFT_OUT) {
                failed.left_out += 1;
                continue;
            }
            failed.count += 1;
            if failed.first.len() < MAX_LISTED {
                failed.first.push((index, message));
            }
        }
        failed
    }
}

impl<'a> StoredRows<'a> {
    /// The stored rows of parts, in the order of their points.
    pub(super) fn new(folder: PartFolder<'a>, held: Vec<Held>) -> Self {
        Self { folder, held }
    }

    /// Which points these are.
    pub(crate) fn share(&self) -> &Share {
        &self.folder.share
    }

    /// Number of rows.
    pub(crate) fn count(&self) -> usize {
        usize::try_from(self.share().count()).unwrap_or(usize::MAX)
    }

    /// Reads something of every part, side by side.
    fn of_parts<T: Send>(
        &self,
        of_file: impl Fn(&PartFile, &Range<u64>) -> Result<T, PartFault> + Sync,
        of_rows: impl Fn(&[Row]) -> T + Sync,
    ) -> Result<Vec<T>, SweepError> {
        let parts = self.held.par_iter().map(|held| match held {
            Held::Whole(points) => self.folder.read_whole(points, |file| of_file(file, points)),
            Held::Rows(rows) => Ok(of_rows(rows)),
        });
        parts.collect()
    }

    /// Checks that the parts hold the points of their names: indices and inputs follow from the study.
    pub(crate) fn check(&self) -> Result<(), SweepError> {
        let checked = self.of_parts(
            |file, points| self.folder.checked_points(file, points).map(|_| ()),
            |_| (),
        );
        checked.map(|_| ())
    }

    /// A result of all points, in the order of their indices; NaN where there is none.
    pub(crate) fn values(&self, result: usize) -> Result<Vec<f64>, SweepError> {
        let of_rows = |rows: &[Row]| rows.iter().map(|row| row.result.values[result]).collect();
        let parts = self.of_parts(|file, _| file.result(result), of_rows)?;
        Ok(parts.concat())
    }

    pub(crate) fn failed(&self) -> Result<FailedPoints, SweepError> {
        let of_rows = |rows: &[Row]| {
            let messages = rows.iter();
            FailedPoints::of(messages.map(|row| (row.index, row.result.message.clone())))
        };
        let of_parts = self.of_parts(
            |file, points| Ok(FailedPoints::of(points.clone().zip(file.messages()?))),
            of_rows,
        );
        let mut all = FailedPoints::default();
        for part in of_parts? {
            all.count += part.count;
            all.left_out += part.left_out;
            all.first.extend(part.first);
        }
        all.first.truncate(MAX_LISTED);
        Ok(all)
    }

    /// Everything, for a table.
    pub(crate) fn rows(&self) -> Result<Vec<Row>, SweepError> {
        let parts = self.held.par_iter().map(|held| match held {
            Held::Whole(points) => self.folder.whole_rows(points),
            Held::Rows(rows) => Ok(rows.clone()),
        });
        let parts: Result<Vec<Vec<Row>>, SweepError> = parts.collect();
        Ok(parts?.into_iter().flatten().collect())
    }
}
