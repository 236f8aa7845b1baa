//! Runs the program as a user does: a process, a scene in a folder of its own, and the files that it leaves there.

use super::read_files::{add_parquet_rows, csv_rows, npz_rows, sqlite_rows};
use super::rows::Rows;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The program, and a folder for the scenes and files of one case, which is removed at the end.
#[derive(Debug)]
pub(crate) struct Program {
    path: PathBuf,
    folder: PathBuf,
}

/// What a process left.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub(crate) printed: String,
    pub(crate) messages: String,
    folder: PathBuf,
    name: String,
}

impl Program {
    /// The program at a path, with a new folder for a case.
    pub(crate) fn new(path: &Path, case: &str) -> io::Result<Self> {
        let folder =
            std::env::temp_dir().join(format!("dwell-written-{}-{case}", std::process::id()));
        fs::create_dir_all(&folder)?;
        Ok(Self {
            path: path.to_owned(),
            folder,
        })
    }

    /// Runs a command on a scene under a name; the files go to the folder of that name.
    pub(crate) fn run(&self, name: &str, scene: &str, arguments: &[&str]) -> io::Result<Run> {
        // A name of the scene may hold what separates folders.
        let name = name.replace(['/', '\\'], "_");
        let folder = self.folder.join(&name);
        fs::create_dir_all(&folder)?;
        let file = self.folder.join(format!("{name}.toml"));
        fs::write(&file, scene)?;
        let (command, options) = arguments.split_first().unwrap_or((&"check", &[]));
        let mut process = Command::new(&self.path);
        process
            .arg(command)
            .arg(&file)
            .args(options)
            .arg("--out")
            .arg(&folder);
        if !matches!(*command, "symbolic" | "check") {
            process.args(["--pictures", "none"]);
        }
        // A process of each case is enough: cases run at once.
        let output = process.env("RAYON_NUM_THREADS", "1").output()?;
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        // With status 1 there are results with a reservation; otherwise none.
        if !matches!(output.status.code(), Some(0 | 1)) {
            let message = format!(
                "`{command}` of {name} ended with {}: {}",
                output.status,
                text(&output.stderr).trim()
            );
            return Err(io::Error::other(message));
        }
        Ok(Run {
            printed: text(&output.stdout),
            messages: text(&output.stderr),
            folder,
            name,
        })
    }
}

impl Drop for Program {
    fn drop(&mut self) {
        // A folder that cannot be removed stays among the system's temporary files.
        let _ = fs::remove_dir_all(&self.folder);
    }
}

impl Run {
    /// The text of a file `NAME-END`; why it cannot be read.
    pub(crate) fn text(&self, end: &str) -> Result<String, String> {
        let file = format!("{}{end}", self.name);
        fs::read_to_string(self.folder.join(&file))
            .map_err(|e| format!("{file}: {e}; {}", self.messages.trim()))
    }

    /// The columns of a CSV file.
    pub(crate) fn csv(&self, end: &str) -> Result<Rows, String> {
        csv_rows(&self.text(end)?)
            .ok_or_else(|| format!("{}{end} is no table of numbers", self.name))
    }

    /// The columns of an NPZ file.
    pub(crate) fn npz(&self, end: &str) -> Result<Rows, String> {
        let file = format!("{}{end}", self.name);
        let bytes = fs::read(self.folder.join(&file))
            .map_err(|e| format!("{file}: {e}; {}", self.messages.trim()))?;
        npz_rows(&bytes).ok_or_else(|| format!("{file} is no archive of arrays"))
    }

    /// The columns of numbers of a table of an SQLite file; the units in brackets are not part of the names.
    pub(crate) fn sqlite(&self, end: &str, table: &str) -> Result<Rows, String> {
        let file = format!("{}{end}", self.name);
        sqlite_rows(&self.folder.join(&file), table).map_err(|e| format!("{file}: {e}"))
    }

    /// The columns of numbers of the Parquet files in a folder.
    pub(crate) fn parquet(&self, end: &str) -> Result<Rows, String> {
        let folder = format!("{}{end}", self.name);
        let fault = |e: &dyn std::fmt::Display| format!("{folder}: {e}; {}", self.messages.trim());
        let entries = fs::read_dir(self.folder.join(&folder)).map_err(|e| fault(&e))?;
        let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
        let is_part = |path: &PathBuf| path.extension().is_some_and(|end| end == "parquet");
        let mut parts: Vec<PathBuf> = paths.filter(is_part).collect();
        parts.sort();
        let mut rows = Rows::default();
        for part in parts {
            add_parquet_rows(&part, &mut rows).map_err(|e| fault(&e))?;
        }
        Ok(rows)
    }

    /// The summary for programs.
    pub(crate) fn json(&self, end: &str) -> Result<serde_json::Value, String> {
        serde_json::from_str(&self.text(end)?).map_err(|e| format!("{}{end}: {e}", self.name))
    }
}
