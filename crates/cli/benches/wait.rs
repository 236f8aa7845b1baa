//! How long the command takes from its start to its last file, and where the time goes: without pictures, with the main
//! ones and with all; and how much memory many rows take.
//!
//! `cargo bench -p dwell-cli --bench wait`. The times are the least and the median of some runs of the program; nothing
//! is asserted about them.
#![allow(clippy::print_stdout, reason = "a benchmark prints")]

use std::error::Error;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Instant;

/// Runs of a command.
const RUNS: usize = 15;
/// Positions of the run with many rows, and how often its memory is looked at.
const MANY_ROWS: &str = "1000000";
const POLLING_MS: u64 = 20;

fn case(name: &str) -> PathBuf {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");
    Path::new(root).join(name).join("scene.toml")
}

/// The command on a case, with its files in a folder.
fn command(arguments: &[&str], scene: &str, out: &Path) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_dwell"));
    command
        .arg(arguments[0])
        .arg(case(scene))
        .args(&arguments[1..]);
    command.arg("--out").arg(out).stdout(Stdio::null());
    command
}

/// The seconds of a run, and what it says of them.
fn run(arguments: &[&str], scene: &str, out: &Path) -> Result<(f64, String), Box<dyn Error>> {
    let started = Instant::now();
    let output = command(arguments, scene, out).output()?;
    let seconds = started.elapsed().as_secs_f64();
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into());
    }
    let said = String::from_utf8_lossy(&output.stderr);
    let time = said.lines().find(|line| line.starts_with("time: "));
    Ok((seconds, time.unwrap_or_default().to_owned()))
}

/// The largest resident memory of a run, MB, where the system tells it.
fn memory(arguments: &[&str], scene: &str, out: &Path) -> Result<Option<f64>, Box<dyn Error>> {
    let mut child = command(arguments, scene, out)
        .stderr(Stdio::null())
        .spawn()?;
    let status = PathBuf::from(format!("/proc/{}/status", child.id()));
    let mut largest = None;
    while child.try_wait()?.is_none() {
        if let Ok(text) = fs::read_to_string(&status) {
            let peak = text.lines().find_map(|line| line.strip_prefix("VmHWM:"));
            let kilobytes =
                peak.and_then(|peak| peak.split_whitespace().next()?.parse::<f64>().ok());
            largest = kilobytes.map(|kilobytes| kilobytes / 1e3).or(largest);
        }
        std::thread::sleep(std::time::Duration::from_millis(POLLING_MS));
    }
    Ok(largest)
}

fn main() -> Result<(), Box<dyn Error>> {
    let out = std::env::temp_dir().join(format!("dwell-wait-{}", std::process::id()));
    println!("ms from start to end, least and median of {RUNS} runs; and what the fastest says");
    for (study, scene) in [
        ("simulate", "single-dwell"),
        ("kinematics", "four-bar"),
        ("kinetostatics", "jansen"),
        ("reduce", "single-dwell"),
    ] {
        for pictures in ["none", "main", "all"] {
            let arguments = [study, "--pictures", pictures];
            let runs = (0..RUNS).map(|_| run(&arguments, scene, &out));
            let mut runs = runs.collect::<Result<Vec<_>, _>>()?;
            runs.sort_by(|(one, _), (other, _)| one.total_cmp(other));
            let [least, median] = [0, RUNS / 2].map(|k| 1e3 * runs[k].0);
            let name = format!("{study} {scene} --pictures {pictures}");
            println!("{name:<44} {least:6.0} {median:6.0}   {}", runs[0].1);
        }
    }
    let arguments = ["kinetostatics", "--pictures", "none", "--points", MANY_ROWS];
    let peak = memory(&arguments, "jansen", &out)?;
    let peak = peak.map_or("not known".to_owned(), |peak| format!("{peak:.0} MB"));
    println!("kinetostatics jansen --points {MANY_ROWS}: peak memory {peak}");
    fs::remove_dir_all(&out)?;
    Ok(())
}
