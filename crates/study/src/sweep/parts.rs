//! The rows of a study in a folder of Parquet files.
//!
//! ```text
//! SCENE-sweep/_study.toml                                what the study is
//! SCENE-sweep/part-0000000000-0000065535.parquet         the rows of these points
//! SCENE-sweep/part-0000065536-0000131071.1-of-1.parquet  some of them, which a run or a shard has computed so far
//! ```
//!
//! The points of a part follow from the study alone, so that shards can fill one folder. Every file is written under a
//! temporary name and renamed when it is complete, so that it is never partial, even if its process was killed. A run
//! replaces its unfinished parts by longer ones from time to time, and in the end by the file of all their points.

mod filling;
mod part_file;
mod stored;

use crate::explain::SweepError;
use crate::sweep::compute::{Design, PointResult, Row, Shard};
use crate::sweep::identity::{StoreFault, StudyIdentity, check_study, study_hash};
use crate::sweep::share::{PART_LENGTH, Share};
use part_file::{PartFault, PartFile, PartFormat, unsigned};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fs;
use std::hash::{BuildHasher as _, RandomState};
use std::ops::Range;
use std::path::{Path, PathBuf};
pub(crate) use stored::{FailedPoints, StoredRows};

/// The definition of the study, beside its parts: readers of a folder of Parquet files ignore names with an underscore.
const STUDY_FILE: &str = "_study.toml";
/// Ending of the name of a file that is being written.
const UNFINISHED: &str = "unfinished";
const PARQUET: &str = "parquet";

/// The folder of a study.
pub(crate) struct PartFolder<'a> {
    path: PathBuf,
    format: PartFormat,
    design: &'a Design,
    results: usize,
    share: Share,
    /// Among the names of unfinished files, so that no other process writes the same one.
    process: u64,
}

/// The points of one file, and the files with some of them.
pub(crate) struct Part {
    points: Range<u64>,
    /// Whether its file is there.
    is_whole: bool,
    /// Files with some of its points, some of which are those of this run.
    pieces: Vec<PathBuf>,
    /// The points of these files, ascending.
    stored: Vec<u64>,
    /// Number of points of this run that no file has.
    pub(crate) missing: usize,
}

impl<'a> PartFolder<'a> {
    /// Opens the folder of a study, or creates it. `headings` are those of the inputs and of the results.
    ///
    /// # Errors
    /// [`SweepError::DifferentStudy`] if it holds another study, [`SweepError::Store`] if it cannot be read or written.
    pub(crate) fn open(
        path: &Path,
        study: &StudyIdentity,
        headings: [&[String]; 2],
        design: &'a Design,
        shard: Option<Shard>,
    ) -> Result<Self, SweepError> {
        let failed = |reason: String| StoreFault::Reason(reason).with_path(path);
        fs::create_dir_all(path)
            .map_err(|e| failed(format!("the folder cannot be created: {e}")))?;
        let format = PartFormat::new(headings, study_hash(study));
        let folder = Self {
            path: path.to_owned(),
            format: format.map_err(|e| failed(e.to_string()))?,
            design,
            results: headings[1].len(),
            share: Share::new(design.points, shard),
            process: RandomState::new().hash_one(std::process::id()),
        };
        let file = path.join(STUDY_FILE);
        check_study(&file, &folder.unfinished(&file), study)?;
        Ok(folder)
    }

    /// All parts with points of this run, each with its existing files.
    ///
    /// # Errors
    /// [`SweepError`] for a file that is damaged or belongs to another study.
    pub(crate) fn parts(&self) -> Result<Vec<Part>, SweepError> {
        let mut files = self.files()?;
        let starts = (0..self.design.points).step_by(PART_LENGTH as usize);
        let files = starts.map(|start| (start, files.remove(&start).unwrap_or_default()));
        let files: Vec<(u64, Vec<PathBuf>)> = files.collect();
        let parts = files.into_par_iter().map(|(start, files)| {
            let points = start..self.design.points.min(start + PART_LENGTH);
            self.part(points, files)
        });
        let parts: Result<Vec<Option<Part>>, SweepError> = parts.collect();
        Ok(parts?.into_iter().flatten().collect())
    }

    /// A part with its files; `None` if no point of it is of this run.
    fn part(&self, points: Range<u64>, files: Vec<PathBuf>) -> Result<Option<Part>, SweepError> {
        if !points.clone().any(|k| self.share.contains(k)) {
            return Ok(None);
        }
        let mut part = Part {
            is_whole: false,
            pieces: Vec::new(),
            stored: Vec::new(),
            missing: 0,
            points,
        };
        let whole = self.file(&part.points);
        for path in files {
            if path == whole {
                self.open_file(&path, &part.points)?;
                part.is_whole = true;
            } else {
                let read = |file: &PartFile| self.checked_points(file, &part.points);
                match self.read(&path, &part.points, read) {
                    Ok(stored) if !stored.iter().any(|k| self.share.contains(*k)) => continue,
                    Ok(stored) => part.stored.extend(stored),
                    // Another process has finished the part meanwhile, and removed what is in its file.
                    Err(_) if whole.exists() => part.is_whole = true,
                    Err(fault) => return Err(fault),
                }
                part.pieces.push(path);
            }
        }
        part.stored.sort_unstable();
        if !part.is_whole {
            part.missing = self.missing(&part).count();
        }
        Ok(Some(part))
    }

    /// The points of a part that this run has to compute, unless the part is whole.
    fn missing<'p>(&self, part: &'p Part) -> impl Iterator<Item = u64> + 'p {
        let share = self.share;
        let points = part.points.clone();
        points.filter(move |k| share.contains(*k) && part.stored.binary_search(k).is_err())
    }

    /// The Parquet files in the folder by the first point of their parts, each list in the order of the names.
    fn files(&self) -> Result<BTreeMap<u64, Vec<PathBuf>>, SweepError> {
        let failed = |e: std::io::Error| {
            StoreFault::Reason(format!("the folder cannot be read: {e}")).with_path(&self.path)
        };
        let mut files: BTreeMap<u64, Vec<PathBuf>> = BTreeMap::new();
        for entry in fs::read_dir(&self.path).map_err(failed)? {
            let path = entry.map_err(failed)?.path();
            if path.extension().is_none_or(|ending| ending != PARQUET) {
                continue;
            }
            let Some(start) = self.start_of(&path) else {
                let fault = "the file is no part of this study: move it to another folder";
                return Err(StoreFault::Reason(fault.to_owned()).with_path(&path));
            };
            files.entry(start).or_default().push(path);
        }
        files.values_mut().for_each(|paths| paths.sort());
        Ok(files)
    }

    /// The first point of the part that a file's name states.
    fn start_of(&self, path: &Path) -> Option<u64> {
        let name = path.file_name()?.to_str()?;
        let stated = name.strip_prefix("part-")?.strip_suffix(".parquet")?;
        let (range, shard) = match stated.split_once('.') {
            Some((range, shard)) => (range, Some(shard.replacen("-of-", "/", 1).parse().ok()?)),
            None => (stated, None),
        };
        let start: u64 = range.split_once('-')?.0.parse().ok()?;
        let end = self.design.points.min(start.saturating_add(PART_LENGTH));
        let is_part = start.is_multiple_of(PART_LENGTH) && start < end;
        (is_part && *path == self.named(&(start..end), shard)).then_some(start)
    }

    fn named(&self, points: &Range<u64>, shard: Option<Shard>) -> PathBuf {
        let (first, last) = (points.start, points.end - 1);
        let shard = shard.map_or_else(String::new, |s| format!(".{}-of-{}", s.part, s.of));
        self.path
            .join(format!("part-{first:010}-{last:010}{shard}.{PARQUET}"))
    }

    /// The file of all points of a part.
    fn file(&self, points: &Range<u64>) -> PathBuf {
        self.named(points, None)
    }

    /// The file of the points that this run has of an unfinished part.
    fn own_piece(&self, points: &Range<u64>) -> PathBuf {
        self.named(points, Some(self.share.shard()))
    }

    /// Where this process writes a file before it has its name.
    fn unfinished(&self, path: &Path) -> PathBuf {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let (name, process) = (name.trim_start_matches('_'), self.process);
        path.with_file_name(format!("_{name}.{process:016x}.{UNFINISHED}"))
    }

    /// Writes the rows of some points of a part, in their order. Another process may write the same file: both have the
    /// same rows.
    fn write(&self, path: &Path, points: &Range<u64>, rows: &[Row]) -> Result<(), SweepError> {
        let unfinished = self.unfinished(path);
        let write = || -> Result<(), String> {
            let written = self.format.write(&unfinished, rows);
            written.map_err(|e| e.to_string())?;
            let renamed = fs::rename(&unfinished, path);
            renamed.map_err(|e| e.to_string())
        };
        let Err(reason) = write() else {
            return Ok(());
        };
        // What remains is of no use; that it cannot be removed adds nothing to the first error.
        let _ = fs::remove_file(&unfinished);
        if self.file(points).exists() {
            // Another process has finished the part, and removed what it took for the remains of a killed run.
            return Ok(());
        }
        Err(StoreFault::Reason(format!("cannot be written: {reason}")).with_path(path))
    }

    /// Removes unfinished files of killed runs.
    fn remove_unfinished(&self) {
        for entry in fs::read_dir(&self.path).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.extension().is_some_and(|ending| ending == UNFINISHED) {
                let _ = fs::remove_file(path);
            }
        }
    }

    /// Opens the file of a part, or of some of its points.
    fn open_file(&self, path: &Path, points: &Range<u64>) -> Result<PartFile, SweepError> {
        let length = (points.end - points.start) as usize;
        let rows = if *path == self.file(points) {
            length..=length
        } else {
            1..=length
        };
        let opened = self.format.open(path, rows);
        opened.map_err(|fault| fault.with_path(path))
    }

    /// Reads something of a file of a part.
    fn read<T>(
        &self,
        path: &Path,
        points: &Range<u64>,
        read: impl Fn(&PartFile) -> Result<T, PartFault>,
    ) -> Result<T, SweepError> {
        let file = self.open_file(path, points)?;
        read(&file).map_err(|fault| fault.with_path(path))
    }

    /// Reads something of the file of a whole part.
    fn read_whole<T>(
        &self,
        points: &Range<u64>,
        read: impl Fn(&PartFile) -> Result<T, PartFault>,
    ) -> Result<T, SweepError> {
        self.read(&self.file(points), points, read)
    }

    /// The points whose rows a file has: of its part, ascending, and with the inputs that follow from the study.
    fn checked_points(&self, file: &PartFile, part: &Range<u64>) -> Result<Vec<u64>, PartFault> {
        const OTHER_POINTS: PartFault = PartFault::Damaged("it holds other points");
        // Below zero is beyond all points.
        let points: Vec<u64> = file.indices()?.into_iter().map(|k| k as u64).collect();
        let is_rising = points.is_sorted_by(|a, b| a < b);
        if !is_rising || !points.iter().all(|k| part.contains(k)) {
            return Err(OTHER_POINTS);
        }
        let inputs: Vec<Vec<f64>> = points.iter().map(|&k| self.design.values(k)).collect();
        for axis in 0..self.design.axes.len() {
            let expected = inputs.iter().map(|values| unsigned(values[axis]).to_bits());
            if !file.input(axis)?.iter().map(|v| v.to_bits()).eq(expected) {
                return Err(OTHER_POINTS);
            }
        }
        Ok(points)
    }

    /// The rows of a file that are of this run.
    fn rows(&self, path: &Path, part: &Range<u64>) -> Result<Vec<Row>, SweepError> {
        self.read(path, part, |file| {
            let points = self.checked_points(file, part)?;
            let inputs = 0..self.design.axes.len();
            let inputs: Vec<_> = inputs.map(|k| file.input(k)).collect::<Result<_, _>>()?;
            let results = 0..self.results;
            let results: Vec<_> = results.map(|k| file.result(k)).collect::<Result<_, _>>()?;
            let cells = |columns: &[Vec<f64>], k: usize| columns.iter().map(|c| c[k]).collect();
            let rows = points.into_iter().zip(file.messages()?).enumerate();
            let rows = rows.map(|(k, (index, message))| Row {
                index,
                inputs: cells(&inputs, k),
                result: PointResult {
                    values: cells(&results, k),
                    message,
                },
            });
            Ok(rows.filter(|row| self.share.contains(row.index)).collect())
        })
    }

    /// The rows of a whole part that are of this run.
    fn whole_rows(&self, points: &Range<u64>) -> Result<Vec<Row>, SweepError> {
        self.rows(&self.file(points), points)
    }
}
