//! Checks of an existing file of a sweep: SQLite reads many damaged files without an error.
//!
//! The pages are checked by SQLite, the definitions of the tables and the scene by comparison, and each row by its
//! checksum, its index and its inputs, which follow from the index.

use crate::sweep::compute::{Design, Row, Shard};
use crate::sweep::store::StoreFault;
use rusqlite::Connection;
use sha2::{Digest, Sha256};

/// What to do about a damaged file.
const REMEDY: &str = "move it, and its points are computed again";

/// The points that a file may hold.
#[derive(Clone, Copy)]
pub(crate) struct ExpectedPoints<'a> {
    pub(crate) design: &'a Design,
    /// `None` for the whole study.
    pub(crate) shard: Option<Shard>,
}

impl ExpectedPoints<'_> {
    /// Checks a row as it was stored, with its checksum.
    pub(crate) fn check(&self, row: &Row, stored: i64) -> Result<(), StoreFault> {
        let index = row.index;
        let damaged = |fault: &str| {
            let fault = format!("the row of point {index} is damaged ({fault}): {REMEDY}");
            Err(StoreFault::Reason(fault))
        };
        if checksum(row) != stored {
            return damaged("its checksum differs");
        }
        let in_shard = self.shard.is_none_or(|shard| shard.contains(index));
        if index >= self.design.points || !in_shard {
            return damaged("the study has no such point");
        }
        // Zeros are stored without a sign.
        let inputs = self.design.values(index);
        let same = |(a, b): (&f64, &f64)| a == b || a.is_nan() && b.is_nan();
        match inputs.iter().zip(&row.inputs).all(same) {
            true => Ok(()),
            false => damaged("its inputs are those of another point"),
        }
    }
}

/// The first 8 bytes of the SHA-256 of a row: index, inputs, results and message.
pub(crate) fn checksum(row: &Row) -> i64 {
    let mut digest = Sha256::new();
    digest.update(row.index.to_le_bytes());
    for value in row.inputs.iter().chain(&row.result.values) {
        // SQLite keeps neither the sign of a zero nor the payload of a NaN.
        let stored = match value.is_nan() {
            true => f64::NAN,
            false => value + 0.0,
        };
        digest.update(stored.to_bits().to_le_bytes());
    }
    if let Some(message) = &row.result.message {
        digest.update(message.as_bytes());
    }
    let digest = digest.finalize();
    let mut first = [0; 8];
    first.copy_from_slice(&digest[..8]);
    i64::from_le_bytes(first)
}

/// Checks the pages of a file, and that its tables are defined as `definitions` say, by name.
pub(crate) fn check_file(
    connection: &Connection,
    definitions: &[(&str, String)],
) -> Result<(), StoreFault> {
    let result: String = connection.query_row("PRAGMA quick_check(1)", (), |row| row.get(0))?;
    if result != "ok" {
        return Err(damage(&result));
    }
    let mut statement = connection.prepare("SELECT name, sql FROM sqlite_schema ORDER BY rowid")?;
    let rows = statement.query_map((), |row| Ok((row.get(0)?, row.get(1)?)))?;
    let found: Vec<(String, String)> = rows.collect::<Result<_, _>>()?;
    let same = found.len() == definitions.len()
        && found
            .iter()
            .zip(definitions)
            .all(|(a, b)| a.0 == b.0 && a.1 == b.1);
    match same {
        true => Ok(()),
        false => Err(damage("its tables are not those of this study")),
    }
}

/// A file that is damaged, and what to do.
pub(crate) fn damage(fault: &str) -> StoreFault {
    StoreFault::Reason(format!("the file is damaged ({fault}): {REMEDY}"))
}
