//! Files of a report, collected in memory and written at the end. Long tables are written from their temporary files.

use crate::error::ReportError;
use crate::long_export::LongExport;
use crate::markdown::Document;
use crate::table::TableExport as _;
use crate::table::{Table, TableFormat};
use dwell_findings::LongTable;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Files by their path relative to a folder that is chosen when they are written.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Files {
    files: BTreeMap<PathBuf, Content>,
}

/// The content of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Content {
    /// These bytes.
    Bytes(Vec<u8>),
    /// These bytes, of a file that others refer to: one that exists is not replaced.
    Kept(Vec<u8>),
    /// A table that is not in memory.
    LongTable(LongExport),
}

impl Content {
    /// Writes a new file.
    pub(crate) fn write(&self, file: &mut File) -> io::Result<()> {
        match self {
            Self::Bytes(bytes) | Self::Kept(bytes) => file.write_all(bytes),
            Self::LongTable(table) => table.write(file).map_err(io::Error::other),
        }
    }
}

impl Files {
    /// No files.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a file; one of the same path is replaced.
    pub fn add(&mut self, path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) {
        let content = Content::Bytes(bytes.into());
        self.files.insert(path.into(), content);
    }

    /// Adds a file that another one refers to. One that exists is not replaced; with other bytes it is an error.
    pub fn add_kept(&mut self, path: impl Into<PathBuf>, bytes: impl Into<Vec<u8>>) {
        let content = Content::Kept(bytes.into());
        self.files.insert(path.into(), content);
    }

    /// Adds a document as `stem.md` and `stem.html`.
    pub fn add_document(&mut self, stem: &str, document: &Document) {
        self.add(format!("{stem}.md"), document.markdown());
        self.add(format!("{stem}.html"), document.html());
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

    /// Adds some columns of a long table in some formats: the same files as [`add_table`](Self::add_table) makes.
    pub fn add_long_table(
        &mut self,
        stem: &str,
        table: &Arc<LongTable>,
        columns: &[usize],
        formats: &[TableFormat],
    ) {
        for &format in formats {
            let export = LongExport::new(table, columns, format);
            let path = format!("{stem}.{}", format.extension());
            self.files.insert(path.into(), Content::LongTable(export));
        }
    }

    /// Moves the files of another set into this one, into `folder` (or none, if it is empty).
    pub fn extend(&mut self, folder: impl AsRef<Path>, others: Self) {
        for (path, bytes) in others.files {
            self.files.insert(folder.as_ref().join(path), bytes);
        }
    }

    /// Paths and contents, in the order of the paths; without long tables, whose contents are made while they are
    /// written.
    pub fn iter(&self) -> impl Iterator<Item = (&Path, &[u8])> {
        self.contents().filter_map(|(path, content)| match content {
            Content::Bytes(bytes) | Content::Kept(bytes) => Some((path, bytes.as_slice())),
            Content::LongTable(_) => None,
        })
    }

    /// All paths, in their order.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        self.files.keys().map(PathBuf::as_path)
    }

    /// All paths and contents.
    pub(crate) fn contents(&self) -> impl Iterator<Item = (&Path, &Content)> {
        self.files
            .iter()
            .map(|(path, content)| (path.as_path(), content))
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
