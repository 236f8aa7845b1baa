//! Runs the program as a user does: as a process, with a scene in its own folder, to which it writes its files.

use super::read_files::{add_parquet_rows, csv_rows, npz_rows};
use super::rows::Rows;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// The program, and a folder for the scenes and files of one case, which is removed at the end.
#[derive(Debug)]
pub(crate) struct Program {
    path: PathBuf,
    folder: PathBuf,
}

/// The results of a process.
#[derive(Debug, Clone)]
pub(crate) struct Run {
    pub(crate) printed: String,
    pub(crate) messages: String,
    folder: PathBuf,
    name: String,
}

impl Program {
    /// The program at a path, with a folder for a case.
    pub(crate) fn new(path: &Path, case: &str) -> Self {
        let folder = format!("dwell-written-{}-{case}", std::process::id());
        Self {
            path: path.to_owned(),
            folder: std::env::temp_dir().join(folder),
        }
    }

    /// Runs a command on a scene under a name; the files go to the folder of that name. Why it cannot, in words.
    pub(crate) fn run(&self, name: &str, scene: &str, arguments: &[&str]) -> Result<Run, String> {
        // A name of the scene may hold what separates folders.
        let name = name.replace(['/', '\\'], "_");
        let folder = self.folder.join(&name);
        fs::create_dir_all(&folder).map_err(|e| format!("no folder for the files: {e}"))?;
        let file = self.folder.join(format!("{name}.toml"));
        fs::write(&file, scene).map_err(|e| e.to_string())?;
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
        let output = process.env("RAYON_NUM_THREADS", "1").output();
        let output = output.map_err(|e| e.to_string())?;
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        // With status 1 there are results with a reservation; otherwise none.
        if !matches!(output.status.code(), Some(0 | 1)) {
            return Err(format!(
                "`{command}` of {name} ended with {}: {}",
                output.status,
                text(&output.stderr).trim()
            ));
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
    /// The path of the file or folder `NAME-END`.
    fn path(&self, end: &str) -> PathBuf {
        self.folder.join(format!("{}{end}", self.name))
    }

    /// Why a file cannot be read.
    fn fault(&self, end: &str, why: &dyn std::fmt::Display) -> String {
        format!("{}{end}: {why}; {}", self.name, self.messages.trim())
    }

    /// The text of a file `NAME-END`; why it cannot be read.
    pub(crate) fn text(&self, end: &str) -> Result<String, String> {
        fs::read_to_string(self.path(end)).map_err(|e| self.fault(end, &e))
    }

    /// The columns of a CSV file.
    pub(crate) fn csv(&self, end: &str) -> Result<Rows, String> {
        csv_rows(&self.text(end)?)
            .ok_or_else(|| format!("{}{end} is no table of numbers", self.name))
    }

    /// The columns of an NPZ file.
    pub(crate) fn npz(&self, end: &str) -> Result<Rows, String> {
        let bytes = fs::read(self.path(end)).map_err(|e| self.fault(end, &e))?;
        npz_rows(&bytes).ok_or_else(|| format!("{}{end} is no archive of arrays", self.name))
    }

    /// The columns of numbers of the Parquet files in a folder; the units in brackets are not part of the names.
    pub(crate) fn parquet(&self, end: &str) -> Result<Rows, String> {
        let entries = fs::read_dir(self.path(end)).map_err(|e| self.fault(end, &e))?;
        let paths = entries.filter_map(|entry| Some(entry.ok()?.path()));
        let is_part = |path: &PathBuf| path.extension().is_some_and(|end| end == "parquet");
        let mut parts: Vec<PathBuf> = paths.filter(is_part).collect();
        parts.sort();
        let mut rows = Rows::default();
        for part in parts {
            add_parquet_rows(&part, &mut rows).map_err(|e| self.fault(end, &e))?;
        }
        Ok(rows)
    }

    /// The summary for programs.
    pub(crate) fn json(&self, end: &str) -> Result<serde_json::Value, String> {
        serde_json::from_str(&self.text(end)?).map_err(|e| format!("{}{end}: {e}", self.name))
    }
}
