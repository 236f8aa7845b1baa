//! The compilers of this machine, and scratch folders.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Every warning that the exported C must not raise.
pub(crate) const FLAGS: [&str; 10] = [
    "-std=c99",
    "-O2",
    "-Wall",
    "-Wextra",
    "-Werror",
    "-pedantic",
    "-Wconversion",
    "-Wdouble-promotion",
    "-Wshadow",
    "-ffp-contract=off",
];

/// A folder that is removed with its owner.
pub(crate) struct Scratch(pub(crate) PathBuf);

impl Scratch {
    pub(crate) fn new() -> Self {
        static COUNT: AtomicUsize = AtomicUsize::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let name = format!("dwell-export-{}-{count}", std::process::id());
        let folder = std::env::temp_dir().join(name);
        std::fs::create_dir_all(&folder).unwrap();
        Self(folder)
    }

    pub(crate) fn write(&self, files: &[(String, String)]) {
        for (path, text) in files {
            let path = self.0.join(path);
            std::fs::create_dir_all(path.parent().unwrap()).unwrap();
            std::fs::write(path, text).unwrap();
        }
    }
}

impl Drop for Scratch {
    fn drop(&mut self) {
        _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The available C compilers; without one the test prints that there is none.
pub(crate) fn c_compilers() -> Vec<&'static str> {
    let there = |name: &&str| Command::new(name).arg("--version").output().is_ok();
    let found: Vec<_> = ["gcc", "clang"].into_iter().filter(there).collect();
    if found.is_empty() {
        eprintln!("skipped: neither gcc nor clang is installed");
    }
    found
}

/// Undefined behaviour and wrong addresses end a program.
pub(crate) const SANITIZE: [&str; 2] =
    ["-fsanitize=undefined,address", "-fno-sanitize-recover=all"];

/// The compilers whose libraries for sanitizers are installed, too.
pub(crate) fn sanitizing_compilers() -> Vec<&'static str> {
    let scratch = Scratch::new();
    scratch.write(&[(
        "empty.c".to_owned(),
        "int main(void) { return 0; }\n".to_owned(),
    )]);
    let links = |compiler: &&str| {
        let mut command = Command::new(compiler);
        let command = command.args(SANITIZE).args(["empty.c", "-o", "empty"]);
        let output = command.current_dir(&scratch.0).output();
        let there = output.is_ok_and(|output| output.status.success());
        if !there {
            eprintln!("skipped: {compiler} has no sanitizers here");
        }
        there
    };
    c_compilers().into_iter().filter(links).collect()
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

/// Compiles C sources into `program`.
pub(crate) fn compile(folder: &Path, compiler: &str, extra: &[&str], sources: &[&str]) {
    let mut arguments = FLAGS.to_vec();
    arguments.extend(extra);
    arguments.extend(sources);
    arguments.extend(["-o", "program"]);
    run(folder, compiler, &arguments);
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
