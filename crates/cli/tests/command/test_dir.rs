//! A folder of its own for each test, in which the command is run.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::atomic::{AtomicU32, Ordering};

/// A mechanism without anything special about it.
pub(crate) const FOUR_BAR: &str = include_str!("four-bar.toml");
/// The same whose crank is too long to rotate fully.
pub(crate) const LIMITED: [(&str, &str); 4] = [
    ("B = [0.1, 0]", "B = [0.3, 0]"),
    ("C = [0.35, 0]", "C = [0.2, 0]"),
    ("C = [0.3, 0]", "C = [0.25, 0]"),
    ("periods = 2", "duration = 2"),
];

/// The repository's folder.
pub(crate) fn home() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

/// The four-bar with some of its text replaced, each piece where it stands once.
pub(crate) fn four_bar_with(changes: &[(&str, &str)]) -> String {
    let mut text = FOUR_BAR.to_owned();
    for (old, new) in changes {
        assert_eq!(text.matches(old).count(), 1, "`{old}` once in the scene");
        text = text.replacen(old, new, 1);
    }
    text
}

/// What a run of the command came to.
#[derive(Debug)]
pub(crate) struct Run {
    pub(crate) status: Option<i32>,
    pub(crate) out: String,
    /// Without the lines about its time, which differ from run to run.
    pub(crate) err: String,
    pub(crate) time: Option<String>,
}

/// A folder, removed at the end.
pub(crate) struct TestDir(pub(crate) PathBuf);

impl TestDir {
    pub(crate) fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let number = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("command-{}-{number}", std::process::id());
        let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
        fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    /// Writes a file, making the folders above it.
    pub(crate) fn put(&self, path: &str, bytes: impl AsRef<[u8]>) {
        let path = self.0.join(path);
        fs::create_dir_all(path.parent().unwrap()).unwrap();
        fs::write(path, bytes).unwrap();
    }

    /// The command, in this folder, drawn alike on every machine: no colours, 80 columns, Unicode.
    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_dwell"));
        command
            .args(arguments)
            .current_dir(&self.0)
            .env_clear()
            .envs([("NO_COLOR", "1"), ("LC_ALL", "C.UTF-8"), ("TERM", "xterm")])
            .stdin(Stdio::null());
        command
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Run {
        let done = self.command(arguments).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        let err = text(done.stderr);
        let is_time = |line: &&str| line.starts_with("time: ");
        let is_of_long_run = |line: &&str| line.contains(": running for ");
        Run {
            status: done.status.code(),
            out: text(done.stdout),
            err: err
                .split_inclusive('\n')
                .filter(|line| !is_time(line) && !is_of_long_run(line))
                .collect(),
            time: err.lines().find(is_time).map(str::to_owned),
        }
    }

    /// Every file below the folder with its bytes, and every folder.
    pub(crate) fn contents(&self) -> BTreeMap<String, Option<Vec<u8>>> {
        let mut found = BTreeMap::new();
        let mut open = vec![self.0.clone()];
        while let Some(folder) = open.pop() {
            for entry in fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                let name = path.strip_prefix(&self.0).unwrap();
                let name = name.to_str().unwrap().to_owned();
                if path.is_dir() {
                    found.insert(name, None);
                    open.push(path);
                } else {
                    found.insert(name, Some(fs::read(&path).unwrap()));
                }
            }
        }
        found
    }

    /// The names of the files below a folder, without what the command keeps for itself.
    pub(crate) fn files(&self, below: &str) -> Vec<String> {
        let prefix = format!("{below}/");
        let all = self.contents().into_iter();
        all.filter(|(_, bytes)| bytes.is_some())
            .filter_map(|(name, _)| Some(name.strip_prefix(&prefix)?.to_owned()))
            .filter(|name| !name.starts_with(".dwell/"))
            .collect()
    }
}

impl Drop for TestDir {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}
