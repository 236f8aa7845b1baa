//! Fills the folder of a study: computes the missing points of its parts, and stores intermediate results of each.

use crate::explain::SweepError;
use crate::sweep::compute::Row;
use crate::sweep::identity::StoreFault;
use crate::sweep::parts::stored::Held;
use crate::sweep::parts::{Part, PartFolder, StoredRows};
use rayon::prelude::*;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// Shortest and longest time between two storings: with the writing, no row waits for 30 s.
const WAIT: [Duration; 2] = [Duration::from_secs(1), Duration::from_secs(15)];
/// Time until rows are stored again, as a multiple of the time of the last storing, which therefore takes 2 % of a
/// thread.
const TIMES_STORING: u32 = 50;

/// Takes rows that are computed.
pub(crate) type Sink<'s> = dyn Fn(Vec<Row>) -> Result<(), SweepError> + Sync + 's;

/// Parts that are being computed.
struct Filling<'f, 'a> {
    folder: &'f PartFolder<'a>,
    parts: &'f [Part],
    /// By part.
    open: Vec<Mutex<OpenRows>>,
    /// Why rows could not be stored; the next thread with rows takes it, and ends the run.
    failure: Mutex<Option<SweepError>>,
}

/// The rows of a part that is being computed.
#[derive(Default)]
struct OpenRows {
    rows: Vec<Row>,
    /// How many of them the file of this run has.
    stored: usize,
}

impl<'a> PartFolder<'a> {
    /// Computes the missing points of parts, by a function of the missing points of one part, and returns all rows of
    /// this run.
    ///
    /// # Errors
    /// [`SweepError`] if a file is damaged or cannot be written.
    pub(crate) fn fill(
        self,
        parts: &[Part],
        compute: impl Fn(&[u64], &Sink<'_>) -> Result<(), SweepError> + Sync,
    ) -> Result<StoredRows<'a>, SweepError> {
        let filling = Filling {
            folder: &self,
            parts,
            open: parts.iter().map(|_| Mutex::default()).collect(),
            failure: Mutex::default(),
        };
        let held: Result<Vec<Held>, SweepError> = std::thread::scope(|scope| {
            // The thread ends when this is dropped.
            let (_running, ended) = channel();
            let filling = &filling;
            scope.spawn(move || filling.store_repeatedly(&ended));
            let parts = parts.par_iter().zip(&filling.open);
            let fill = |(part, open)| filling.fill_part(part, open, &compute);
            parts.map(fill).collect()
        });
        let held = held?;
        if self.share.shard().of == 1 {
            self.remove_unfinished();
        }
        Ok(StoredRows::new(self, held))
    }
}

impl Filling<'_, '_> {
    /// Computes and stores the missing points of a part.
    fn fill_part(
        &self,
        part: &Part,
        open: &Mutex<OpenRows>,
        compute: impl Fn(&[u64], &Sink<'_>) -> Result<(), SweepError>,
    ) -> Result<Held, SweepError> {
        let (folder, points) = (self.folder, &part.points);
        let is_own = points.clone().all(|k| folder.share.contains(k));
        match (part.is_whole, is_own) {
            (true, true) => {
                // Left by a run that was killed when it had finished the part.
                remove(&part.pieces);
                return Ok(Held::Whole(points.clone()));
            }
            (true, false) => return Ok(Held::Rows(folder.whole_rows(points)?)),
            (false, _) => {}
        }
        let own = folder.own_piece(points);
        if part.pieces.contains(&own) {
            let rows = folder.rows(&own, points)?;
            let stored = rows.len();
            *lock(open) = OpenRows { rows, stored };
        }
        let missing: Vec<u64> = folder.missing(part).collect();
        compute(&missing, &|rows| {
            lock(open).rows.extend(rows);
            lock(&self.failure).take().map_or(Ok(()), Err)
        })?;
        // Until this part is finished nobody else stores it, and then nothing is left to store.
        let mut open = lock(open);
        if !is_own {
            open.store(folder, points)?;
        }
        self.finish(part, std::mem::take(&mut *open).rows, is_own)
    }

    /// Merges the rows that this run has of a part with those of other runs; all of a part go to its file.
    fn finish(&self, part: &Part, mut rows: Vec<Row>, is_own: bool) -> Result<Held, SweepError> {
        let (folder, points) = (self.folder, &part.points);
        let (file, own) = (folder.file(points), folder.own_piece(points));
        let others = part.pieces.iter().filter(|piece| **piece != own);
        let gathered = others.map(|piece| folder.rows(piece, points));
        let gathered = gathered.collect::<Result<Vec<Vec<Row>>, SweepError>>();
        // If it exists, another process has finished the part, and removed the files of some of its points.
        let is_whole = file.exists();
        if !is_whole {
            rows.extend(gathered?.into_iter().flatten());
            sort(&mut rows);
            // Runs at the same time may have computed the same points.
            rows.dedup_by_key(|row| row.index);
        }
        match (is_own, is_whole) {
            (false, false) => return Ok(Held::Rows(rows)),
            (false, true) => return Ok(Held::Rows(folder.whole_rows(points)?)),
            (true, false) if rows.len() as u64 != points.end - points.start => {
                return Err(changed(&file));
            }
            (true, false) => folder.write(&file, points, &rows)?,
            (true, true) => {}
        }
        remove(&part.pieces);
        remove(&[own]);
        Ok(Held::Whole(points.clone()))
    }

    /// Stores the rows of open parts from time to time, until the sender is dropped.
    fn store_repeatedly(&self, ended: &Receiver<()>) {
        let [shortest, longest] = WAIT;
        let mut wait = shortest;
        while ended.recv_timeout(wait) == Err(RecvTimeoutError::Timeout) {
            let begun = Instant::now();
            let mut parts = self.parts.iter().zip(&self.open);
            let stored =
                parts.try_for_each(|(part, open)| lock(open).store(self.folder, &part.points));
            if let Err(failure) = stored {
                *lock(&self.failure) = Some(failure);
            }
            wait = (begun.elapsed() * TIMES_STORING).clamp(shortest, longest);
        }
    }
}

impl OpenRows {
    /// Stores the rows that there are, if there are more than before.
    fn store(&mut self, folder: &PartFolder<'_>, points: &Range<u64>) -> Result<(), SweepError> {
        if self.rows.len() == self.stored || folder.file(points).exists() {
            return Ok(());
        }
        sort(&mut self.rows);
        folder.write(&folder.own_piece(points), points, &self.rows)?;
        self.stored = self.rows.len();
        Ok(())
    }
}

/// A thread that panics ends the run.
fn lock<T>(open: &Mutex<T>) -> MutexGuard<'_, T> {
    open.lock().unwrap_or_else(PoisonError::into_inner)
}

fn sort(rows: &mut [Row]) {
    rows.sort_unstable_by_key(|row| row.index);
}

/// Removes files whose rows are in another file. If a file cannot be removed, the next run tries again.
fn remove(pieces: &[PathBuf]) {
    for piece in pieces {
        let _ = fs::remove_file(piece);
    }
}

/// The error of a part whose other files have changed during the run.
fn changed(file: &Path) -> SweepError {
    let fault =
        "another process changes the files of this part: wait for it, and run the command again";
    StoreFault::Reason(fault.to_owned()).with_path(file)
}
