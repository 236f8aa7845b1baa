//! The results of a large sweep in a folder of Parquet files.
//!
//! ```text
//! SCENE-sweep/_study.toml                         what the study is
//! SCENE-sweep/part-0000000000-0000065535.parquet  the rows of these points
//! ```
//!
//! A part is written beside its place and renamed when it is complete: a file with the name of a part is whole, whatever
//! happened to the process that wrote it. Which points a part has follows from the study alone, so that shards fill one folder.

mod part_file;

use crate::explain::SweepError;
use crate::sweep::compute::{Design, PointResult, Row, Shard};
use crate::sweep::store::{SCENE_TEXT, StoreFault, StudyIdentity, study_difference};
use crate::sweep::stored::{FailedPoints, MAX_LISTED, StoredPoints, StoredResults};
use part_file::{PartFault, PartFile, PartFormat};
use rayon::prelude::*;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// The definition of the study, beside its parts: readers of a folder of Parquet files leave out names with an underscore.
const STUDY_FILE: &str = "_study.toml";
/// Ending of the name of a file that is being written.
const UNFINISHED: &str = "unfinished";

/// The folder of a study.
pub(crate) struct PartFolder<'a> {
    path: PathBuf,
    format: PartFormat,
    design: &'a Design,
    results: usize,
    /// Points of a part; the last one may have fewer.
    length: u64,
    shard: Option<Shard>,
    existing: Vec<Range<u64>>,
    /// The parts that had no file when the folder was opened.
    pub(crate) missing: Vec<Range<u64>>,
    points: StoredPoints,
}

impl<'a> PartFolder<'a> {
    /// Opens the folder of a study, or creates it. `headings` are those of the inputs and of the results.
    ///
    /// # Errors
    /// [`SweepError::DifferentStudy`] if it holds another study, [`SweepError::Store`] if something in it is damaged, or it
    /// cannot be read or written.
    pub(crate) fn open(
        path: &Path,
        study: &StudyIdentity,
        headings: [&[String]; 2],
        (design, length, shard): (&'a Design, u64, Option<Shard>),
    ) -> Result<Self, SweepError> {
        let failed = |reason: String| StoreFault::Reason(reason).with_path(path);
        fs::create_dir_all(path)
            .map_err(|e| failed(format!("the folder cannot be created: {e}")))?;
        check_study(&path.join(STUDY_FILE), study)?;
        let format = PartFormat::new(headings, study_hash(study));
        let mut folder = Self {
            path: path.to_owned(),
            format: format.map_err(|e| failed(e.to_string()))?,
            design,
            results: headings[1].len(),
            length,
            shard,
            existing: Vec::new(),
            missing: Vec::new(),
            points: StoredPoints::default(),
        };
        for part in folder.parts() {
            if folder.file(&part).exists() {
                folder.open_part(&part)?;
                folder.points.push(part.clone());
                folder.existing.push(part);
            } else {
                folder.missing.push(part);
            }
        }
        Ok(folder)
    }

    /// All parts of the study, or of the shard.
    fn parts(&self) -> Vec<Range<u64>> {
        let (points, length) = (self.design.points, self.length);
        let numbers = 0..points.div_ceil(length);
        let numbers = numbers.filter(|number| self.shard.is_none_or(|s| s.contains(*number)));
        let part = |number| number * length..points.min((number + 1) * length);
        numbers.map(part).collect()
    }

    fn file(&self, part: &Range<u64>) -> PathBuf {
        let (first, last) = (part.start, part.end - 1);
        self.path
            .join(format!("part-{first:010}-{last:010}.parquet"))
    }

    /// Writes a part. Another process may write the same one: both have the same rows.
    pub(crate) fn write(&self, part: &Range<u64>, rows: &[Row]) -> Result<(), SweepError> {
        let file = self.file(part);
        let unfinished = unfinished(&file);
        let write = || -> Result<(), String> {
            let written = self.format.write(&unfinished, rows);
            written.map_err(|e| e.to_string())?;
            let renamed = fs::rename(&unfinished, &file);
            renamed.map_err(|e| e.to_string())
        };
        write().map_err(|reason| {
            // What remains is of no use; that it cannot be removed adds nothing to the first error.
            let _ = fs::remove_file(&unfinished);
            StoreFault::Reason(format!("cannot be written: {reason}")).with_path(&file)
        })
    }

    /// Notes that all missing parts are written, and removes what killed runs left.
    pub(crate) fn complete(&mut self) {
        self.existing = self.parts();
        self.missing.clear();
        self.points = StoredPoints::default();
        for part in &self.existing {
            self.points.push(part.clone());
        }
        if self.shard.is_some() {
            return;
        }
        for entry in fs::read_dir(&self.path).into_iter().flatten().flatten() {
            let path = entry.path();
            if path.extension().is_some_and(|ending| ending == UNFINISHED) {
                let _ = fs::remove_file(path);
            }
        }
    }

    fn open_part(&self, part: &Range<u64>) -> Result<PartFile, SweepError> {
        let rows = (part.end - part.start) as usize;
        let opened = self.format.open(&self.file(part), rows);
        opened.map_err(|fault| self.fault(part, fault))
    }

    fn fault(&self, part: &Range<u64>, fault: PartFault) -> SweepError {
        let remedy = "remove it, and its points are computed again";
        let fault = match fault {
            PartFault::OtherStudy => StoreFault::Differs("the part is of another study".to_owned()),
            PartFault::Damaged(what) => {
                StoreFault::Reason(format!("the file is damaged ({what}): {remedy}"))
            }
            PartFault::Unreadable(why) => {
                StoreFault::Reason(format!("the file cannot be read ({why}): {remedy}"))
            }
        };
        fault.with_path(&self.file(part))
    }

    /// Reads something of every stored part, side by side.
    fn of_parts<T: Send>(
        &self,
        read: impl Fn(&PartFile, &Range<u64>) -> Result<T, PartFault> + Sync,
    ) -> Result<Vec<T>, SweepError> {
        let parts = self.existing.par_iter();
        let read = parts.map(|part| {
            let file = self.open_part(part)?;
            read(&file, part).map_err(|fault| self.fault(part, fault))
        });
        read.collect()
    }

    /// Checks that the parts hold the points of their names: indices and inputs follow from the study.
    pub(crate) fn check_inputs(&self) -> Result<(), SweepError> {
        const OTHER_POINTS: PartFault = PartFault::Damaged("it holds other points");
        let checked = self.of_parts(|file, part| {
            let expected = part.start as i64..part.end as i64;
            if !file.indices()?.into_iter().eq(expected) {
                return Err(OTHER_POINTS);
            }
            let inputs: Vec<Vec<f64>> = part.clone().map(|k| self.design.values(k)).collect();
            for axis in 0..self.design.axes.len() {
                let expected = inputs.iter().map(|values| values[axis].to_bits());
                if !file.input(axis)?.iter().map(|v| v.to_bits()).eq(expected) {
                    return Err(OTHER_POINTS);
                }
            }
            Ok(())
        });
        checked.map(|_| ())
    }
}

impl StoredResults for PartFolder<'_> {
    fn points(&self) -> &StoredPoints {
        &self.points
    }

    fn values(&self, result: usize) -> Result<Vec<f64>, SweepError> {
        let parts = self.of_parts(|file, _| file.result(result))?;
        Ok(parts.concat())
    }

    fn failed(&self) -> Result<FailedPoints, SweepError> {
        let of_parts =
            self.of_parts(|file, part| Ok(FailedPoints::of(part.clone().zip(file.messages()?))));
        let mut all = FailedPoints::default();
        for part in of_parts? {
            all.count += part.count;
            all.first.extend(part.first);
        }
        all.first.truncate(MAX_LISTED);
        Ok(all)
    }

    fn rows(&self) -> Result<Vec<Row>, SweepError> {
        let of_parts = self.of_parts(|file, part| {
            let columns: Result<Vec<_>, _> = (0..self.results).map(|k| file.result(k)).collect();
            let columns = columns?;
            let messages = file.messages()?;
            let rows = part.clone().zip(messages).enumerate();
            let row = |(k, (index, message))| Row {
                index,
                inputs: self.design.values(index),
                result: PointResult {
                    values: columns.iter().map(|column| column[k]).collect(),
                    message,
                },
            };
            Ok(rows.map(row).collect::<Vec<Row>>())
        });
        Ok(of_parts?.into_iter().flatten().collect())
    }
}

/// The folder's study must be this one; without a file it becomes it.
fn check_study(path: &Path, study: &StudyIdentity) -> Result<(), SweepError> {
    let reason = |reason: String| StoreFault::Reason(reason).with_path(path);
    match fs::read_to_string(path) {
        Ok(text) => {
            let stored: Result<HashMap<String, String>, _> = toml::from_str(&text);
            let stored = stored.map_err(|e| {
                reason(format!(
                    "it is not the definition of a study: {}",
                    e.message()
                ))
            })?;
            match study_difference(&stored, study) {
                None => Ok(()),
                Some(difference) => Err(difference.with_path(path)),
            }
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            let entries = study.iter();
            let entries =
                entries.map(|(key, value)| ((*key).to_owned(), toml::Value::from(value.as_str())));
            let table: toml::Table = entries.collect();
            // Shards may write it at the same time, with the same content.
            let unfinished = unfinished(path);
            let text = toml::to_string_pretty(&table).map_err(|e| reason(e.to_string()))?;
            let written = fs::write(&unfinished, text).and_then(|()| fs::rename(&unfinished, path));
            written.map_err(|e| reason(format!("cannot be written: {e}")))
        }
        Err(error) => Err(reason(format!("cannot be read: {error}"))),
    }
}

/// Where this process writes a file before it has its name.
fn unfinished(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let name = name.trim_start_matches('_');
    path.with_file_name(format!("_{name}.{}.{UNFINISHED}", std::process::id()))
}

/// The hash of a study's definition, by which its parts are known.
fn study_hash(study: &StudyIdentity) -> String {
    let mut digest = Sha256::new();
    // The scene's text is known by its hash, which is independent of line ends.
    for (key, value) in study.iter().filter(|(key, _)| *key != SCENE_TEXT) {
        digest.update(format!("{key}={value}\n"));
    }
    let hash = digest.finalize();
    hash.iter().map(|byte| format!("{byte:02x}")).collect()
}
