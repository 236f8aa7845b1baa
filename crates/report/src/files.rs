//! Files of a report: gathered in memory, written at the end, each whole or not at all.

use crate::error::ReportError;
use crate::table::TableExport as _;
use crate::table::{Table, TableFormat};
use std::collections::BTreeMap;
use std::fs;
use std::io;
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

    /// Writes the files below `folder`, making folders where they are missing, and returns the paths.
    ///
    /// All files are written under temporary names beside their targets first, and renamed when every one is
    /// complete. A reader therefore never meets half a file, and a full disk or a target that is a folder leaves
    /// everything as it was. Only if the system refuses a rename after that are the files before it new already.
    ///
    /// # Errors
    ///
    /// [`ReportError::File`] with the path and the system's reason. Temporary files, and folders made for them, are removed.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
        let mut staged = Staged::default();
        for (path, bytes) in &self.files {
            staged.stage(&folder.join(path), bytes)?;
        }
        staged.commit()
    }
}

/// Files under temporary names; dropped before they are committed, they vanish.
#[derive(Debug, Default)]
struct Staged {
    /// Temporary name and target.
    files: Vec<(PathBuf, PathBuf)>,
    /// Folders that did not exist before, outer ones first.
    folders: Vec<PathBuf>,
}

fn file_error(path: &Path) -> impl FnOnce(io::Error) -> ReportError {
    let path = path.to_owned();
    move |source| ReportError::File { path, source }
}

impl Staged {
    fn stage(&mut self, target: &Path, bytes: &[u8]) -> Result<(), ReportError> {
        // Renaming onto a folder would fail too, but only after others have been renamed.
        if target.is_dir() {
            return Err(file_error(target)(io::ErrorKind::IsADirectory.into()));
        }
        let (Some(parent), Some(name)) = (target.parent(), target.file_name()) else {
            return Err(file_error(target)(io::ErrorKind::InvalidFilename.into()));
        };
        self.create_folder(parent)?;
        let mut hidden = std::ffi::OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}-{}.tmp", std::process::id(), self.files.len()));
        let temporary = target.with_file_name(hidden);
        // Recorded before it exists, so that a file of which only a part could be written is removed too.
        self.files.push((temporary.clone(), target.to_owned()));
        fs::write(&temporary, bytes).map_err(file_error(target))
    }

    /// Makes a folder and those above it, remembering which are new.
    fn create_folder(&mut self, folder: &Path) -> Result<(), ReportError> {
        let is_missing = |f: &&Path| !f.as_os_str().is_empty() && !f.exists();
        let missing: Vec<&Path> = folder.ancestors().take_while(is_missing).collect();
        for folder in missing.into_iter().rev() {
            match fs::create_dir(folder) {
                Ok(()) => self.folders.push(folder.to_owned()),
                // Another writer was faster.
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists && folder.is_dir() => {}
                Err(e) => return Err(file_error(folder)(e)),
            }
        }
        Ok(())
    }

    fn commit(mut self) -> Result<Vec<PathBuf>, ReportError> {
        let mut written = Vec::with_capacity(self.files.len());
        for (temporary, target) in &self.files {
            fs::rename(temporary, target).map_err(file_error(target))?;
            written.push(target.clone());
        }
        self.files.clear();
        self.folders.clear();
        Ok(written)
    }
}

impl Drop for Staged {
    fn drop(&mut self) {
        // What has been renamed is no longer there, and folders that are in use stay: both refusals are wanted.
        for (temporary, _) in &self.files {
            let _ = fs::remove_file(temporary);
        }
        for folder in self.folders.iter().rev() {
            let _ = fs::remove_dir(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicU32, Ordering};

    /// A folder of its own for each test, removed at the end.
    struct TestFolder(PathBuf);

    impl TestFolder {
        fn new() -> Self {
            static COUNT: AtomicU32 = AtomicU32::new(0);
            let number = COUNT.fetch_add(1, Ordering::Relaxed);
            let folder =
                std::env::temp_dir().join(format!("dwell-files-{}-{number}", std::process::id()));
            fs::create_dir_all(&folder).unwrap();
            Self(folder)
        }

        /// Everything below the folder, relative to it.
        fn contents(&self) -> Vec<PathBuf> {
            let mut found = Vec::new();
            let mut open = vec![self.0.clone()];
            while let Some(folder) = open.pop() {
                for entry in fs::read_dir(folder).unwrap() {
                    let path = entry.unwrap().path();
                    if path.is_dir() {
                        open.push(path.clone());
                    }
                    found.push(path.strip_prefix(&self.0).unwrap().to_owned());
                }
            }
            found.sort();
            found
        }
    }

    impl Drop for TestFolder {
        fn drop(&mut self) {
            let _ = fs::remove_dir_all(&self.0);
        }
    }

    #[test]
    fn files_arrive_whole_and_alone() {
        let folder = TestFolder::new();
        fs::write(folder.0.join("a.txt"), "old").unwrap();
        let mut files = Files::new();
        files.add("a.txt", "new");
        let mut others = Files::new();
        others.add("m.csv", vec![0_u8; 100_000]);
        files.extend("tables/deep", others);
        assert_eq!(files.write(&folder.0).unwrap().len(), 2);
        assert_eq!(fs::read(folder.0.join("a.txt")).unwrap(), b"new");
        assert_eq!(
            fs::read(folder.0.join("tables/deep/m.csv")).unwrap().len(),
            100_000
        );
        let expected = ["a.txt", "tables", "tables/deep", "tables/deep/m.csv"];
        assert_eq!(folder.contents(), expected.map(PathBuf::from));
    }

    #[test]
    fn a_target_that_is_a_folder_leaves_everything_as_it_was() {
        let folder = TestFolder::new();
        fs::write(folder.0.join("a.txt"), "old").unwrap();
        fs::create_dir(folder.0.join("z.png")).unwrap();
        let before = folder.contents();
        let mut files = Files::new();
        files.add("a.txt", "new");
        files.add("fresh/b.txt", "new");
        files.add("z.png", "new");
        let error = files.write(&folder.0).unwrap_err();
        assert!(matches!(&error, ReportError::File { path, .. } if path.ends_with("z.png")));
        assert!(
            error.to_string().contains("z.png") && error.to_string().contains("directory"),
            "{error}"
        );
        assert_eq!(folder.contents(), before);
        assert_eq!(fs::read(folder.0.join("a.txt")).unwrap(), b"old");
    }

    #[test]
    fn a_file_where_a_folder_is_needed_is_named() {
        let folder = TestFolder::new();
        fs::write(folder.0.join("tables"), "in the way").unwrap();
        let mut files = Files::new();
        files.add("a.txt", "new");
        files.add("tables/m.csv", "new");
        let error = files.write(&folder.0).unwrap_err();
        assert!(
            matches!(&error, ReportError::File { path, .. } if path.starts_with(folder.0.join("tables")))
        );
        assert_eq!(folder.contents(), [PathBuf::from("tables")]);
    }

    #[test]
    fn a_rename_that_fails_late_still_clears_up() {
        let folder = TestFolder::new();
        let target = folder.0.join("late.txt");
        let mut staged = Staged::default();
        staged.stage(&target, b"new").unwrap();
        fs::create_dir(&target).unwrap();
        assert!(staged.commit().is_err());
        assert_eq!(folder.contents(), [PathBuf::from("late.txt")]);
    }
}
