//! The C compilers of this machine, scratch folders and scenes.

use dwell_export::{Precision, Request};
use dwell_scene::PlaneScene;
use dwell_study::ExportRequest;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Every warning that the exported C must not raise.
const FLAGS: [&str; 9] = [
    "-std=c99",
    "-O2",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-pedantic",
    "-Wconversion",
    "-Wdouble-promotion",
    "-Wshadow",
];

/// A folder that is removed with its owner.
pub(crate) struct Scratch(pub(crate) PathBuf);

impl Scratch {
    pub(crate) fn new() -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("dwell-study-export-{}-{count}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    pub(crate) fn write(&self, files: &[(String, String)]) {
        for (path, text) in files {
            std::fs::write(self.0.join(path), text).unwrap();
        }
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        _ = std::fs::remove_dir_all(&self.0);
    }
}

/// A C compiler, if there is one; otherwise the test prints that there is none.
pub(crate) fn c_compiler() -> Option<&'static str> {
    let there = |name: &&str| Command::new(name).arg("--version").output().is_ok();
    let found = ["gcc", "clang"].into_iter().find(there);
    if found.is_none() {
        eprintln!("skipped: neither gcc nor clang is installed");
    }
    found
}

/// Runs a command in a folder; its output, or a panic with what it said.
pub(crate) fn run(folder: &Path, program: &str, arguments: &[&str]) -> String {
    let mut command = Command::new(program);
    let output = command.args(arguments).current_dir(folder).output();
    let output = output.unwrap_or_else(|e| panic!("{program}: {e}"));
    let said = String::from_utf8_lossy(&output.stderr).into_owned();
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(
        output.status.success(),
        "{program} {arguments:?}: {} {said} {text}",
        output.status
    );
    text
}

/// Compiles with every warning an error.
pub(crate) fn compile(folder: &Path, compiler: &str, arguments: &[&str]) {
    let all: Vec<&str> = FLAGS.iter().chain(arguments).copied().collect();
    run(folder, compiler, &all);
}

/// The numbers of a program's output, line by line.
pub(crate) fn numbers(text: &str) -> Vec<Vec<f64>> {
    let line = |line: &str| {
        line.split_whitespace()
            .map(|n| n.parse().unwrap())
            .collect()
    };
    text.lines().map(line).collect()
}

/// The folder of the cases.
pub(crate) fn cases() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation")
}

/// A case.
pub(crate) fn case(name: &str) -> PlaneScene {
    let path = cases().join(name).join("scene.toml");
    let text = std::fs::read_to_string(&path).unwrap();
    PlaneScene::parse(&format!("{name}.toml"), &text).unwrap()
}

/// What is asked for, over the whole range.
pub(crate) fn request(accuracy: f64, precision: Precision) -> ExportRequest {
    ExportRequest {
        exact: false,
        request: Request {
            accuracy,
            precision,
        },
        interval: None,
    }
}
