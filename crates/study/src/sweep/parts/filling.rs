//! Fills the folder of a study: computes the missing points of its parts, and stores on the way what there is of each.

use crate::explain::SweepError;
use crate::sweep::compute::Row;
use crate::sweep::identity::StoreFault;
use crate::sweep::parts::stored::Held;
use crate::sweep::parts::{Part, PartFolder, StoredRows};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fs;
use std::ops::Range;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::sync::{Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

/// How long a computed row waits at least and at most until it is stored. With the writing it is below 30 s.
const WAIT: [Duration; 2] = [Duration::from_secs(1), Duration::from_secs(20)];
/// Storing takes at most this part of the time, 1/50.
const SHARE_OF_TIME: u32 = 50;

/// Takes rows that are computed.
pub(crate) type Sink<'s> = dyn Fn(Vec<Row>) -> Result<(), SweepError> + Sync + 's;

/// The parts that are being computed.
struct Filling<'f, 'a> {
    folder: &'f PartFolder<'a>,
    open: Mutex<OpenParts>,
}

#[derive(Default)]
struct OpenParts {
    /// By first point.
    parts: BTreeMap<u64, OpenPart>,
    /// Why rows could not be stored; the next thread with rows takes it, and ends the run.
    failure: Option<SweepError>,
}

/// A part that is being computed.
struct OpenPart {
    points: Range<u64>,
    rows: Vec<Row>,
    /// How many of them this run's file of it has.
    stored: usize,
}

impl<'a> PartFolder<'a> {
    /// Computes what is missing of some parts, by a function of the missing points of one of them, and hands out all rows
    /// of this run.
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
            open: Mutex::default(),
        };
        let held: Result<Vec<Held>, SweepError> = std::thread::scope(|scope| {
            // That it is dropped is what ends the thread.
            let (_running, ended) = channel();
            scope.spawn(|| filling.store_repeatedly(ended));
            let parts = parts.par_iter();
            parts
                .map(|part| filling.fill_part(part, &compute))
                .collect()
        });
        let held = held?;
        if self.share.shard().of == 1 {
            self.remove_unfinished();
        }
        Ok(StoredRows::new(self, held))
    }
}

impl Filling<'_, '_> {
    fn open(&self) -> MutexGuard<'_, OpenParts> {
        // A thread that panics ends the run.
        self.open.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Computes and stores what is missing of a part.
    fn fill_part(
        &self,
        part: &Part,
        compute: impl Fn(&[u64], &Sink<'_>) -> Result<(), SweepError>,
    ) -> Result<Held, SweepError> {
        let (folder, points) = (self.folder, &part.points);
        let is_own = points.clone().all(|k| folder.share.contains(k));
        if part.is_whole && is_own {
            // Left by a run that was killed after it had finished the part.
            remove(&part.pieces);
            return Ok(Held::Whole(points.clone()));
        }
        if part.is_whole {
            return Ok(Held::Rows(folder.whole_rows(points)?));
        }
        let own = folder.own_piece(points);
        let rows = match part.pieces.contains(&own) {
            true => folder.rows(&own, points)?,
            false => Vec::new(),
        };
        let start = points.start;
        let open = OpenPart {
            points: points.clone(),
            stored: rows.len(),
            rows,
        };
        self.open().parts.insert(start, open);
        let missing: Vec<u64> = folder.missing(part).collect();
        compute(&missing, &|rows| self.add(start, rows))?;
        // From here on nobody else stores it.
        let open = self.open().parts.remove(&start);
        let mut open = open.ok_or_else(|| changed(folder, points))?;
        let others = part.pieces.iter().filter(|piece| **piece != own);
        if !is_own {
            open.store(folder)?;
            open.add_pieces(folder, others)?;
            return Ok(Held::Rows(open.rows));
        }
        match open.add_pieces(folder, others) {
            Ok(()) if open.rows.len() as u64 == points.end - start => {
                folder.write(&folder.file(points), points, &open.rows)?;
            }
            // Another process has finished the part and removed the pieces.
            _ if folder.file(points).exists() => {}
            Ok(()) => return Err(changed(folder, points)),
            Err(fault) => return Err(fault),
        }
        remove(&part.pieces);
        remove(&[own]);
        Ok(Held::Whole(points.clone()))
    }

    /// Adds computed rows to an open part.
    fn add(&self, start: u64, rows: Vec<Row>) -> Result<(), SweepError> {
        let mut open = self.open();
        if let Some(failure) = open.failure.take() {
            return Err(failure);
        }
        if let Some(part) = open.parts.get_mut(&start) {
            part.rows.extend(rows);
        }
        Ok(())
    }

    /// Stores the rows of open parts from time to time, until the sender is dropped.
    fn store_repeatedly(&self, ended: Receiver<()>) {
        let [shortest, longest] = WAIT;
        let mut wait = shortest;
        while ended.recv_timeout(wait) == Err(RecvTimeoutError::Timeout) {
            let begun = Instant::now();
            let mut open = self.open();
            let mut parts = open.parts.values_mut();
            let stored = parts.try_for_each(|part| part.store(self.folder));
            open.failure = stored.err();
            wait = (begun.elapsed() * SHARE_OF_TIME).clamp(shortest, longest);
        }
    }
}

impl OpenPart {
    /// Stores the rows that there are, if there are more than before.
    fn store(&mut self, folder: &PartFolder<'_>) -> Result<(), SweepError> {
        if self.rows.len() == self.stored || folder.file(&self.points).exists() {
            return Ok(());
        }
        self.rows.sort_unstable_by_key(|row| row.index);
        folder.write(&folder.own_piece(&self.points), &self.points, &self.rows)?;
        self.stored = self.rows.len();
        Ok(())
    }

    /// Adds the rows of other runs, and orders all.
    fn add_pieces<'p>(
        &mut self,
        folder: &PartFolder<'_>,
        pieces: impl Iterator<Item = &'p PathBuf>,
    ) -> Result<(), SweepError> {
        for piece in pieces {
            self.rows.extend(folder.rows(piece, &self.points)?);
        }
        self.rows.sort_unstable_by_key(|row| row.index);
        // Runs at the same time may have computed the same points.
        self.rows.dedup_by_key(|row| row.index);
        Ok(())
    }
}

/// Removes files whose rows are in another one; what cannot be removed does no harm.
fn remove(pieces: &[PathBuf]) {
    for piece in pieces {
        let _ = fs::remove_file(piece);
    }
}

/// Files that are no longer what they were when the run began.
fn changed(folder: &PartFolder<'_>, points: &Range<u64>) -> SweepError {
    let fault =
        "another process changes the files of this part: wait for it, and run the command again";
    StoreFault::Reason(fault.to_owned()).with_path(&folder.file(points))
}
