//! The program, run as a process in a temporary folder of its own.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU64, Ordering};

/// The folder of a run's results, in its temporary folder.
const OUT: &str = "out";
/// The scene's file there.
const SCENE: &str = "scene.toml";

/// The program whose files are checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Program {
    path: PathBuf,
}

impl Program {
    /// The program of this file.
    pub fn at(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into() }
    }

    /// The program that is running.
    ///
    /// # Errors
    /// The system's reason why its file is not known.
    pub fn running() -> io::Result<Self> {
        std::env::current_exe().map(Self::at)
    }

    /// Runs `COMMAND SCENE ARGUMENTS…` for a scene's text. Pictures are not drawn, and the files are named `NAME-…`.
    ///
    /// # Errors
    /// Why it could not be run, or its files not be read. Whatever status it ends with is no error.
    pub(crate) fn run(&self, request: &Request<'_>) -> Result<WrittenRun, String> {
        let folder = TemporaryFolder::new().map_err(|e| format!("no temporary folder: {e}"))?;
        let failed = |e: io::Error| format!("`{request}` cannot be run: {e}");
        for (name, contents) in [(SCENE, request.scene)].iter().chain(request.inputs) {
            fs::write(folder.path.join(name), contents).map_err(failed)?;
        }
        let output = Command::new(&self.path)
            .args([request.command, SCENE])
            .args(request.arguments)
            .args(["--name", request.name, "--out", OUT, "--pictures", "none"])
            .current_dir(&folder.path)
            // The cases already run side by side.
            .env("RAYON_NUM_THREADS", "1")
            .env("NO_COLOR", "1")
            .stdin(Stdio::null())
            .output()
            .map_err(failed)?;
        let mut files = BTreeMap::new();
        read_folder(&folder.path.join(OUT), "", &mut files).map_err(failed)?;
        Ok(WrittenRun {
            request: request.to_string(),
            name: request.name.to_owned(),
            status: output.status.code(),
            stdout: String::from_utf8_lossy(&output.stdout).into_owned(),
            stderr: String::from_utf8_lossy(&output.stderr).into_owned(),
            files,
        })
    }
}

/// What is run.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Request<'a> {
    pub(crate) command: &'a str,
    /// The text of the scene, and the name of its files.
    pub(crate) scene: &'a str,
    pub(crate) name: &'a str,
    pub(crate) arguments: &'a [&'a str],
    /// Other files beside the scene: name and text.
    pub(crate) inputs: &'a [(&'a str, &'a str)],
}

impl std::fmt::Display for Request<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "dwell {} {}", self.command, self.name)?;
        self.arguments.iter().try_for_each(|a| write!(f, " {a}"))
    }
}

/// What a run has left: its status, what it printed, and its files by their names relative to its folder.
#[derive(Debug, Clone, Default, PartialEq)]
pub(crate) struct WrittenRun {
    /// The command line, for messages.
    pub(crate) request: String,
    pub(crate) name: String,
    /// None where a signal has ended it.
    pub(crate) status: Option<i32>,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
    pub(crate) files: BTreeMap<String, Vec<u8>>,
}

impl WrittenRun {
    /// Itself, if its status is one of these.
    ///
    /// # Errors
    /// The command line, its status and the first lines of what it printed on standard error.
    pub(crate) fn with_status(self, allowed: &[i32]) -> Result<Self, String> {
        match self.status {
            Some(status) if allowed.contains(&status) => Ok(self),
            status => {
                let ended = status.map_or("a signal".to_owned(), |s| format!("status {s}"));
                let lines: Vec<&str> = self.stderr.lines().take(3).map(str::trim).collect();
                Err(format!(
                    "`{}` ended with {ended}: {}",
                    self.request,
                    lines.join(" ")
                ))
            }
        }
    }

    /// The bytes of `NAME-SUFFIX`.
    ///
    /// # Errors
    /// That there is no such file, and which there are.
    pub(crate) fn file(&self, suffix: &str) -> Result<&[u8], String> {
        let wanted = format!("{}-{suffix}", self.name);
        let file = self.files.get(&wanted).map(Vec::as_slice);
        file.ok_or_else(|| {
            let all: Vec<&str> = self.files.keys().map(String::as_str).collect();
            let all = all.join(", ");
            format!("`{}` wrote no {wanted}, but {all}", self.request)
        })
    }

    /// The text of `NAME-SUFFIX`.
    ///
    /// # Errors
    /// As [`file`](Self::file), or that it is no UTF-8.
    pub(crate) fn text(&self, suffix: &str) -> Result<&str, String> {
        std::str::from_utf8(self.file(suffix)?)
            .map_err(|e| format!("`{}`: {suffix} is no text: {e}", self.request))
    }
}

/// All files of a folder and of those in it, by path with `/`.
fn read_folder(
    folder: &Path,
    prefix: &str,
    files: &mut BTreeMap<String, Vec<u8>>,
) -> io::Result<()> {
    let entries = match fs::read_dir(folder) {
        Err(e) if e.kind() == io::ErrorKind::NotFound => return Ok(()),
        entries => entries?,
    };
    for entry in entries {
        let entry = entry?;
        let name = format!("{prefix}{}", entry.file_name().to_string_lossy());
        if entry.file_type()?.is_dir() {
            read_folder(&entry.path(), &format!("{name}/"), files)?;
        } else {
            files.insert(name, fs::read(entry.path())?);
        }
    }
    Ok(())
}

/// A folder that is removed with all its files when it is dropped.
struct TemporaryFolder {
    path: PathBuf,
}

impl TemporaryFolder {
    fn new() -> io::Result<Self> {
        static COUNT: AtomicU64 = AtomicU64::new(0);
        loop {
            let number = COUNT.fetch_add(1, Ordering::Relaxed);
            let name = format!("dwell-written-{}-{number}", std::process::id());
            let path = std::env::temp_dir().join(name);
            match fs::create_dir(&path) {
                Ok(()) => return Ok(Self { path }),
                Err(e) if e.kind() == io::ErrorKind::AlreadyExists => {}
                Err(e) => return Err(e),
            }
        }
    }
}

impl Drop for TemporaryFolder {
    fn drop(&mut self) {
        // What cannot be removed stays in the system's folder for temporary files.
        let _ = fs::remove_dir_all(&self.path);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_program_that_is_not_there_is_an_error_with_the_command_line() {
        let program = Program::at("/no/such/program");
        let request = Request {
            command: "check",
            name: "bar",
            arguments: &["--points", "3"],
            ..Request::default()
        };
        let error = program.run(&request).unwrap_err();
        let start = "`dwell check bar --points 3` cannot be run";
        assert!(error.starts_with(start), "{error}");
    }

    #[test]
    fn a_status_that_is_not_allowed_is_an_error_with_what_was_printed() {
        let run = WrittenRun {
            request: "dwell cycle bar".to_owned(),
            status: Some(2),
            stderr: "  × no cycle\n  help: none".to_owned(),
            ..WrittenRun::default()
        };
        let error = run.with_status(&[0, 1]).unwrap_err();
        assert_eq!(
            error,
            "`dwell cycle bar` ended with status 2: × no cycle help: none"
        );
    }
}
