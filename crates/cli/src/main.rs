//! The `dwell` command: arguments in, files and messages out.
//!
//! Exit status: 0 good, 1 a check failed, 2 bad input (a scene, an argument, a folder that cannot be
//! written).

mod cases;
mod options;
mod validate;

use clap::Parser;
use dwell_findings::all_pass;
use dwell_scene::{Scene, SceneError};
use dwell_study::{Accuracy, Outcome, StudyError};
use miette::{Report, miette};
use options::{Command, Options};
use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    // clap itself exits with 2 on a bad argument, and with 0 for help.
    let options = Options::parse();
    match run(options) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(report) => {
            // A closed standard error is no reason to panic.
            let _ = writeln!(std::io::stderr(), "{report:?}");
            ExitCode::from(2)
        }
    }
}

/// Runs a command; whether all its checks passed.
fn run(options: Options) -> Result<bool, Report> {
    let Options { command, out } = options;
    if let Command::Schema = command {
        print(&dwell_scene::schema())?;
        return Ok(true);
    }
    if out.exists() && !out.is_dir() {
        return Err(miette!(
            help = "name a folder with --out; it is made if it is missing",
            "`{}` is not a folder: no report can be written there",
            out.display()
        ));
    }
    let mut unusable = None;
    let outcome = match &command {
        Command::Check { scene } => told(dwell_study::check(&read(scene)?))?,
        Command::Reduce { scene } => told(dwell_study::reduce(&read(scene)?))?,
        Command::Simulate {
            scene,
            method,
            rtol,
            atol,
        } => {
            let accuracy = Accuracy {
                method: (*method).into(),
                relative: *rtol,
                absolute: atol.unwrap_or(*rtol),
            };
            told(dwell_study::simulate(&read(scene)?, &accuracy))?
        }
        Command::Calibrate { scene, set, period } => {
            let scene = read(scene)?;
            told(dwell_study::calibrate(&scene, set.as_deref(), *period))?
        }
        Command::Validate { cases, folder } => {
            let (outcome, others) = validate::validate(cases, folder)?;
            unusable = others;
            outcome
        }
        // Printed above: it is neither about a scene nor written into a folder.
        Command::Schema => Outcome::default(),
    };
    print(&outcome.summary)?;
    if !outcome.files.is_empty() {
        let written = outcome.files.write(&out).map_err(|e| {
            miette!(
                help = "nothing was written; another folder can be named with --out",
                "{e}"
            )
        })?;
        let shown = written.len().min(12);
        for path in &written[..shown] {
            print(&format!("  {}\n", path.display()))?;
        }
        if written.len() > shown {
            let more = written.len() - shown;
            print(&format!("  and {more} more below {}\n", out.display()))?;
        }
    }
    match unusable {
        // Told last: it is what has to be seen to.
        Some(report) => Err(report),
        None => Ok(all_pass(&outcome.findings)),
    }
}

fn read(path: &Path) -> Result<Scene, Report> {
    Scene::read(path).map_err(Report::new)
}

/// A study's error as a report: a scene's with its text, another one as it is.
fn told<T>(result: Result<T, StudyError>) -> Result<T, Report> {
    result.map_err(|e| Report::new(as_scene_error(e)))
}

fn as_scene_error(error: StudyError) -> SceneError {
    match error {
        StudyError::Scene(scene) => *scene,
        other => plain(other.to_string()),
    }
}

/// An error that points at no place.
fn plain(message: String) -> SceneError {
    SceneError {
        message,
        help: None,
        labels: Vec::new(),
        text: None,
        others: Vec::new(),
    }
}

fn print(text: &str) -> Result<(), Report> {
    match std::io::stdout().write_all(text.as_bytes()) {
        // Whoever reads has seen enough (such as `dwell … | head`).
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.map_err(|e| miette!("cannot print the results: {e}")),
    }
}
