//! `cargo run --release --example trials -- [--slow] [--seed N]`: faults in every key of a scene, pulses and random machines. Writes
//! `reports/key-faults.txt`, `reports/pulses.*` and `reports/machines.*`, and fails if a finding fails or a key is missed by the checks.
#![allow(clippy::print_stdout, reason = "a study, run by hand")]

use dwell_findings::all_pass;
use dwell_report::OutputFolder;
use dwell_scene::PlaneScene;
use dwell_study::{Outcome, PictureFormat, Pictures, no_progress};
use dwell_trials::{keys, machines, pulses};
use dwell_validation::manual::{KeyFaults, Manual};
use std::error::Error;
use std::path::{Path, PathBuf};
use std::process::{Command, ExitCode};

fn main() -> Result<ExitCode, Box<dyn Error>> {
    let (mut slow, mut seed) = (false, 1);
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        match (argument.as_str(), &mut arguments) {
            ("--slow", _) => slow = true,
            ("--seed", rest) => seed = rest.next().ok_or("--seed needs a number")?.parse()?,
            (other, _) => return Err(format!("`{other}` is neither --slow nor --seed").into()),
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let gaps = plant(&root)?;
    for gap in &gaps {
        println!("MISSED {gap}");
    }
    let long = if slow { "-long" } else { "" };
    let mut outcome = Outcome::default();
    let drawn = pulses::evaluate(pulses::count(slow), seed);
    pulses::add_to(&mut outcome, &drawn, seed, &format!("pulses{long}"))?;
    let drawn = machines::evaluate(machines::count(slow), seed);
    machines::add_to(&mut outcome, &drawn, seed, &format!("machines{long}"))?;
    let outcome = outcome.draw((Pictures::All, PictureFormat::Png), &no_progress)?;
    print!("{}", outcome.summary);
    OutputFolder::open(&root.join("reports"))?.write(&outcome.files)?;
    let passed = gaps.is_empty() && all_pass(&outcome.findings);
    Ok(if passed {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

/// Plants a fault in every key and writes what became of it; what the checks miss.
fn plant(root: &Path) -> Result<Vec<String>, Box<dyn Error>> {
    let folder = root.join("validation");
    let scenes = cases(&folder)?;
    let scenes: Vec<&PlaneScene> = scenes.iter().collect();
    let faults = keys::key_faults(Manual::new(&scenes, &folder).scenes());
    let made = last_commit(root)?;
    KeyFaults { made, faults }.write(&root.join("reports"))?;
    Ok(Manual::new(&scenes, &folder).gaps())
}

/// The scenes of the cases, by name.
fn cases(folder: &Path) -> Result<Vec<PlaneScene>, Box<dyn Error>> {
    let entries = std::fs::read_dir(folder)?.flatten();
    let mut folders: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
    folders.retain(|folder| folder.join("case.toml").is_file());
    folders.sort();
    let read = |folder: &PathBuf| PlaneScene::read(folder.join("scene.toml"));
    Ok(folders.iter().map(read).collect::<Result<_, _>>()?)
}

/// The last commit, with its date.
fn last_commit(root: &Path) -> Result<String, Box<dyn Error>> {
    let mut git = Command::new("git");
    let git = git.args(["log", "-1", "--format=%h, %cs", "--abbrev=8"]);
    let done = git.current_dir(root).output()?;
    Ok(String::from_utf8(done.stdout)?.trim().to_owned())
}
