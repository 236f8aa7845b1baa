//! Files of a report: gathered in memory, written at the end.

use crate::error::ReportError;
use crate::table::TableExport as _;
use crate::table::{Table, TableFormat};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Files by their path relative to a folder that is chosen when they are written.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Files {
    files: BTreeMap<PathBuf, Vec<u8>>,
}

impl Files {
    /// No files.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file; one of the same path is replaced.
    pub fn add(&mut self, path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) {
        self.files.insert(path.into(), bytes.into());
    }

    /// Adds a table in some formats: `stem.csv`, `stem.npz`.
    ///
    /// # Errors
    ///
    /// As [`Table::csv`] and [`Table::npz`].
    pub fn add_table(
        &mut self,
        stem: &str,
        table: &Table,
        formats: &[TableFormat],
    ) -> Result<(), ReportError> {
        for format in formats {
            let bytes = match format {
                TableFormat::Csv => table.csv()?.into_bytes(),
                TableFormat::Npz => table.npz()?,
            };
            self.add(format!("{stem}.{}", format.extension()), bytes);
        }
        Ok(())
    }

    /// Takes over the files of another set, under a folder of their own (or none, if it is empty).
    pub fn extend(&mut self, folder: impl AsRef<Path>, others: Self) {
        for (path, bytes) in others.files {
            self.files.insert(folder.as_ref().join(path), bytes);
        }
    }

    /// Paths and contents, in the order of the paths.
    pub fn iter(&self) -> impl Iterator<Item = (&Path, &[u8])> {
        self.files
            .iter()
            .map(|(path, bytes)| (path.as_path(), bytes.as_slice()))
    }

    /// Number of files.
    pub fn len(&self) -> usize {
        self.files.len()
    }

    /// Whether there is no file.
    pub fn is_empty(&self) -> bool {
        self.files.is_empty()
    }
}
