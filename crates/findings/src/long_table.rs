//! A table that is too long for memory: its rows are in a temporary file.
//!
//! If the system allows it, the file is removed from its folder as soon as it is open, so that a killed process leaves
//! no file.

use crate::table::Column;
use std::fs::{self, File, OpenOptions};
use std::io::{self, Read as _, Seek as _, SeekFrom, Write as _};
use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

/// Rows of a part; one part at a time is in memory.
const ROWS_OF_PART: usize = 4096;
/// Bytes of a number.
const NUMBER: usize = 8;
/// Maximum number of names tried for the temporary file.
const MAX_NAMES: usize = 1000;

/// A table in a file, with only some rows in memory.
#[derive(Debug)]
pub struct LongTable {
    columns: Vec<Column>,
    rows: usize,
    /// The rows not yet in the file, one after another.
    recent: Vec<f64>,
    file: Mutex<File>,
    /// The path, if the file still has one.
    named: Option<PathBuf>,
}

impl LongTable {
    /// A table without rows.
    ///
    /// # Errors
    /// The temporary file cannot be created.
    pub fn new(columns: Vec<Column>) -> io::Result<Self> {
        let (file, path) = temporary_file()?;
        let named = fs::remove_file(&path).is_err().then_some(path);
        Ok(Self {
            columns,
            rows: 0,
            recent: Vec::new(),
            file: Mutex::new(file),
            named,
        })
    }

    /// The columns.
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows
    }

    /// Whether there is no row.
    pub fn is_empty(&self) -> bool {
        self.rows == 0
    }

    /// Adds a row with one number for each column; missing numbers become NaN.
    ///
    /// # Errors
    /// The row cannot be written.
    pub fn push(&mut self, row: &[f64]) -> io::Result<()> {
        let width = self.columns.len();
        self.recent.extend(row.iter().take(width));
        self.rows += 1;
        let in_file = self.rows - self.rows % ROWS_OF_PART;
        let whole = if in_file == self.rows {
            ROWS_OF_PART
        } else {
            self.rows - in_file
        };
        self.recent.resize(whole * width, f64::NAN);
        if in_file == self.rows {
            let bytes = by_columns(&self.recent, width);
            self.recent.clear();
            let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
            file.seek(SeekFrom::End(0))?;
            file.write_all(&bytes)?;
        }
        Ok(())
    }

    /// Number of parts.
    pub fn parts(&self) -> usize {
        self.rows.div_ceil(ROWS_OF_PART)
    }

    /// A column of a part, one value for each row.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn part(&self, part: usize, column: usize) -> io::Result<Vec<f64>> {
        let width = self.columns.len();
        if (part + 1) * ROWS_OF_PART > self.rows {
            let rows = self.recent.chunks_exact(width.max(1));
            return Ok(rows.map(|row| row[column]).collect());
        }
        let start = (part * width + column) * ROWS_OF_PART * NUMBER;
        let mut bytes = vec![0; ROWS_OF_PART * NUMBER];
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        file.seek(SeekFrom::Start(start as u64))?;
        file.read_exact(&mut bytes)?;
        let (numbers, _) = bytes.as_chunks::<NUMBER>();
        Ok(numbers.iter().map(|b| f64::from_le_bytes(*b)).collect())
    }

    /// All values of a column.
    ///
    /// # Errors
    /// As [`part`](Self::part).
    pub fn column(&self, column: usize) -> io::Result<Vec<f64>> {
        let mut values = Vec::with_capacity(self.rows);
        for part in 0..self.parts() {
            values.extend(self.part(part, column)?);
        }
        Ok(values)
    }

    /// The value of a column in a row.
    ///
    /// # Errors
    /// As [`part`](Self::part).
    pub fn value(&self, row: usize, column: usize) -> io::Result<f64> {
        let part = self.part(row / ROWS_OF_PART, column)?;
        Ok(part.get(row % ROWS_OF_PART).copied().unwrap_or(f64::NAN))
    }

    /// The rows of a part, with some columns.
    ///
    /// # Errors
    /// As [`part`](Self::part).
    pub fn rows_of_part(&self, part: usize, columns: &[usize]) -> io::Result<Vec<Vec<f64>>> {
        let columns: Vec<Vec<f64>> = columns
            .iter()
            .map(|&k| self.part(part, k))
            .collect::<io::Result<_>>()?;
        let rows = columns.first().map_or(0, Vec::len);
        let row = |i: usize| columns.iter().map(|values| values[i]).collect();
        Ok((0..rows).map(row).collect())
    }
}

impl Drop for LongTable {
    fn drop(&mut self) {
        if let Some(path) = &self.named {
            // If an open file cannot be removed, the system clears its temporary folder later.
            let _ = fs::remove_file(path);
        }
    }
}

/// The bytes of rows, column after column.
fn by_columns(rows: &[f64], width: usize) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(rows.len() * NUMBER);
    for k in 0..width {
        let column = rows.iter().skip(k).step_by(width);
        column.for_each(|value| bytes.extend(value.to_le_bytes()));
    }
    bytes
}

/// A new file in the system's temporary folder.
fn temporary_file() -> io::Result<(File, PathBuf)> {
    static NUMBER: AtomicU64 = AtomicU64::new(0);
    let mut options = OpenOptions::new();
    options.read(true).write(true).create_new(true);
    let mut refused = io::Error::from(io::ErrorKind::AlreadyExists);
    for _ in 0..MAX_NAMES {
        let number = NUMBER.fetch_add(1, Ordering::Relaxed);
        let name = format!("dwell-rows-{}-{number}", std::process::id());
        let path = std::env::temp_dir().join(name);
        match options.open(&path) {
            Ok(file) => return Ok((file, path)),
            Err(e) if e.kind() == io::ErrorKind::AlreadyExists => refused = e,
            Err(e) => return Err(e),
        }
    }
    Err(refused)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "tests")]
    use super::*;

    #[test]
    fn every_bit_comes_back_from_every_part() {
        for rows in [0, 1, ROWS_OF_PART - 1, ROWS_OF_PART, 2 * ROWS_OF_PART + 3] {
            let columns = ["a", "b", "c"].map(|name| Column::new(name, ""));
            let mut table = LongTable::new(columns.to_vec()).unwrap();
            let value = |row: usize, k: usize| match (row + k) % 5 {
                0 => f64::NAN,
                1 => -0.0,
                _ => (row as f64).sqrt() / (k as f64 + 0.1),
            };
            for row in 0..rows {
                table.push(&[0, 1, 2].map(|k| value(row, k))).unwrap();
            }
            assert_eq!((table.len(), table.is_empty()), (rows, rows == 0));
            for k in 0..3 {
                let found = table.column(k).unwrap().into_iter().map(f64::to_bits);
                let expected = (0..rows).map(|row| value(row, k).to_bits());
                assert!(found.eq(expected), "{rows} rows, column {k}");
            }
            let mut row = 0;
            for part in 0..table.parts() {
                for [c, a] in table
                    .rows_of_part(part, &[2, 0])
                    .unwrap()
                    .iter()
                    .map(|r| [r[0], r[1]])
                {
                    assert_eq!(c.to_bits(), value(row, 2).to_bits());
                    assert_eq!(a.to_bits(), table.value(row, 0).unwrap().to_bits());
                    row += 1;
                }
            }
            assert_eq!(row, rows);
        }
    }
}
