//! The provenance of the manual: program, compiler, commit, machine.

use std::path::Path;
use std::process::Command;

/// The facts, each with its name.
pub(super) fn facts(folder: &Path) -> [Vec<String>; 4] {
    let threads = std::thread::available_parallelism().map_or(1, usize::from);
    let machine = format!(
        "{}, {} {}, {threads} threads",
        processor().unwrap_or_else(|| "processor unknown".to_owned()),
        std::env::consts::OS,
        std::env::consts::ARCH
    );
    let commit = commit(folder).unwrap_or("unknown: the cases are not in a repository".to_owned());
    [
        ("Program", format!("Dwell {}", env!("CARGO_PKG_VERSION"))),
        ("Compiler", env!("DWELL_COMPILER").to_owned()),
        ("Commit", commit),
        ("Machine", machine),
    ]
    .map(|(name, value)| vec![name.to_owned(), value])
}

/// The commit of the cases' repository, and whether files differ from it.
fn commit(folder: &Path) -> Option<String> {
    let git = |arguments: &[&str]| {
        let output = Command::new("git")
            .arg("-C")
            .arg(folder)
            .args(arguments)
            .output();
        let output = output.ok().filter(|output| output.status.success())?;
        Some(String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let commit = git(&["rev-parse", "HEAD"])?;
    let changed = git(&["status", "--porcelain", "--untracked-files=no"])?;
    Some(if changed.is_empty() {
        commit
    } else {
        format!("{commit}, with changed files")
    })
}

/// The processor's name, if the system states it.
fn processor() -> Option<String> {
    let text = std::fs::read_to_string("/proc/cpuinfo").ok()?;
    let line = text.lines().find(|line| line.starts_with("model name"))?;
    Some(line.split_once(':')?.1.trim().to_owned())
}
