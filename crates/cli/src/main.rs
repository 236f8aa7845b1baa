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
use dwell_study::{
    Accuracy, Command as Run, Followed, Outcome, Progress, Step, StudyError, Sweep, Tabulation,
};
use indicatif::{ProgressBar, ProgressStyle};
use miette::{Report, miette};
use options::{Along, Command, Options};
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
    let mut stopped = None;
    let outcome = match &command {
        Command::Check { scene } => told(dwell_study::check(&read(scene)?))?,
        Command::Reduce {
            scene,
            table,
            accuracy,
            from,
            to,
        } => {
            let tabulation = table.or(*accuracy).map(|accuracy| Tabulation {
                accuracy,
                between: from.zip(*to),
                demanded: table.is_some(),
            });
            told(dwell_study::reduce(&read(scene)?, tabulation))?
        }
        Command::Simulate {
            scene,
            method,
            rtol,
            atol,
            max_step,
            accuracy: wanted,
            every,
        } => {
            let accuracy = Accuracy {
                method: (*method).into(),
                relative: *rtol,
                absolute: atol.unwrap_or(*rtol),
                longest: *max_step,
                every: *every,
            };
            let scene = read(scene)?;
            let simulate = |heard: Progress<'_>| match *wanted {
                Some(wanted) => dwell_study::simulate_within(&scene, wanted, *every, heard),
                None => dwell_study::simulate(&scene, &accuracy, heard),
            };
            followed(simulate, &mut stopped)?
        }
        Command::Cycle {
            scene,
            fluctuation,
            method,
            rtol,
        } => {
            let accuracy = Accuracy {
                method: (*method).into(),
                relative: *rtol,
                absolute: *rtol,
                ..Accuracy::default()
            };
            told(dwell_study::cycle(&read(scene)?, &accuracy, *fluctuation))?
        }
        Command::Tradeoff { scene } => {
            let scene = read(scene)?;
            told(heard(|heard| dwell_study::tradeoff(&scene, heard)))?
        }
        Command::Equilibria { scene } => told(dwell_study::equilibria(&read(scene)?))?,
        Command::Linearise { scene, at } => {
            told(dwell_study::linearise(&read(scene)?, (*at).into()))?
        }
        Command::Symbolic {
            scene,
            to,
            reaction,
        } => {
            let scene = read(scene)?;
            told(dwell_study::symbolic(
                &scene,
                (*to).into(),
                reaction.as_deref(),
            ))?
        }
        Command::Kinematics(along) => follow(along, Run::Kinematics, &mut stopped)?,
        Command::Statics(along) => follow(along, Run::Statics, &mut stopped)?,
        Command::Kinetostatics(along) => follow(along, Run::Kinetostatics, &mut stopped)?,
        Command::Calibrate { scene, set, period } => {
            let scene = read(scene)?;
            told(dwell_study::calibrate(&scene, set.as_deref(), *period))?
        }
        Command::Sweep {
            scene,
            vary,
            samples,
            seed,
            want,
            shard,
            export,
        } => {
            let scene = read(scene)?;
            let sweep = Sweep {
                vary,
                samples: *samples,
                seed: *seed,
                want,
                shard: *shard,
                export: export.map(Into::into),
                folder: &out,
            };
            told(heard(|heard| dwell_study::sweep(&scene, &sweep, heard)))?
        }
        Command::Validate {
            cases,
            folder,
            long,
        } => {
            let (outcome, others) = validate::validate(cases, folder, *long)?;
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
    if let Some(reason) = &stopped {
        // A closed standard error is no reason to panic.
        let _ = writeln!(std::io::stderr(), "{reason:?}");
    }
    match unusable {
        // Told last: it is what has to be seen to.
        Some(report) => Err(report),
        None => Ok(stopped.is_none() && all_pass(&outcome.findings)),
    }
}

/// Follows a scene along its way; if that ends early, `stopped` says why.
fn follow(along: &Along, run: Run, stopped: &mut Option<Report>) -> Result<Outcome, Report> {
    let scene = read(&along.scene)?;
    let points = along.points.map(|n| n as usize);
    followed(
        |heard| dwell_study::run(&scene, run, points, heard),
        stopped,
    )
}

/// Shows the progress of what is followed; if it ends early, `stopped` says why.
fn followed(
    run: impl FnOnce(Progress<'_>) -> Result<Followed, StudyError>,
    stopped: &mut Option<Report>,
) -> Result<Outcome, Report> {
    let followed = told(heard(run))?;
    *stopped = followed.stopped.map(|e| Report::new(as_scene_error(e)));
    Ok(followed.outcome)
}

/// Long work, with its progress shown.
fn heard<T>(run: impl FnOnce(Progress<'_>) -> T) -> T {
    let bar = progress_bar();
    let heard = |step: Step<'_>| {
        bar.set_length(step.total as u64);
        bar.set_message(step.done.to_owned());
        bar.inc(1);
    };
    let done = run(&heard);
    bar.finish_and_clear();
    done
}

fn progress_bar() -> ProgressBar {
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}") {
        bar.set_style(style);
    }
    bar
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
        StudyError::Sweep(sweep) => SceneError {
            help: sweep.help(),
            ..plain(sweep.to_string())
        },
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
