//! The `dwell` command: it reads a scene, runs one study of it, writes the files and prints the summary.
//!
//! Exit status: 0 success, 1 a check failed or a motion ended early, 2 invalid input (a scene, an argument, a folder that cannot be
//! written).

mod cases;
mod former;
mod options;
mod validate;

use clap::Parser;
use dwell_findings::all_pass;
use dwell_scene::{Scene, SceneError};
use dwell_study::{
    Analysis as Run, Outcome, ParameterSweep, Progress, SolverSettings, Step, StudyError,
    TableRequest, TrajectoryOutcome,
};
use dwell_validation::ValidationError;
use indicatif::{ProgressBar, ProgressStyle};
use miette::{Report, miette};
use options::{Command, Options, TrajectoryArgs};
use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    // clap itself exits with 2 on a bad argument, and with 0 for help.
    let (arguments, notes) = former::with_current_names(std::env::args_os());
    for note in notes {
        // A closed standard error is no reason to panic.
        let _ = writeln!(std::io::stderr(), "{note}");
    }
    let options = Options::parse_from(arguments);
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

/// Runs a command, and returns whether all its checks passed.
fn run(options: Options) -> Result<bool, Report> {
    let Options { command, out } = options;
    if let Command::Schema = command {
        print(&dwell_scene::schema())?;
        return Ok(true);
    }
    if out.exists() && !out.is_dir() {
        return Err(miette!(
            help = "give a folder with --out; it is created if it does not exist",
            "`{}` is not a folder, so no report can be written there",
            out.display()
        ));
    }
    let mut failures = None;
    let mut early_stop = None;
    let outcome = match &command {
        Command::Check { scene } => report_errors(dwell_study::check(&read(scene)?))?,
        Command::Reduce {
            scene,
            table_accuracy,
            accuracy,
            from,
            to,
        } => {
            let tabulation = table_accuracy.or(*accuracy).map(|accuracy| TableRequest {
                accuracy,
                interval: from.zip(*to),
                required: table_accuracy.is_some(),
            });
            report_errors(dwell_study::reduce(&read(scene)?, tabulation))?
        }
        Command::Simulate {
            scene,
            method,
            rtol,
            atol,
            max_step,
            accuracy,
            sample_interval,
        } => {
            let settings = SolverSettings {
                method: *method,
                rtol: *rtol,
                atol: atol.unwrap_or(*rtol),
                max_step: *max_step,
                sample_interval: *sample_interval,
            };
            let scene = read(scene)?;
            let simulate = |progress: Progress<'_>| match *accuracy {
                Some(accuracy) => {
                    dwell_study::simulate_to_accuracy(&scene, accuracy, *sample_interval, progress)
                }
                None => dwell_study::simulate(&scene, &settings, progress),
            };
            run_until_stop(simulate, &mut early_stop)?
        }
        Command::Cycle {
            scene,
            fluctuation,
            method,
            rtol,
        } => {
            let settings = SolverSettings {
                method: *method,
                rtol: *rtol,
                atol: *rtol,
                ..SolverSettings::default()
            };
            report_errors(dwell_study::cycle(&read(scene)?, &settings, *fluctuation))?
        }
        Command::WorkPrecision { scene } => {
            let scene = read(scene)?;
            report_errors(with_progress(|progress| {
                dwell_validation::work_precision(&scene, progress)
            }))?
        }
        Command::Equilibria { scene } => report_errors(dwell_study::equilibria(&read(scene)?))?,
        Command::Linearise { scene, about } => {
            report_errors(dwell_study::linearise(&read(scene)?, *about))?
        }
        Command::Symbolic {
            scene,
            format,
            reaction,
        } => {
            let scene = read(scene)?;
            report_errors(dwell_study::symbolic(&scene, *format, reaction.as_deref()))?
        }
        Command::Kinematics(trajectory) => {
            run_trajectory(trajectory, Run::Kinematics, &mut early_stop)?
        }
        Command::Statics(trajectory) => run_trajectory(trajectory, Run::Statics, &mut early_stop)?,
        Command::Kinetostatics(trajectory) => {
            run_trajectory(trajectory, Run::Kinetostatics, &mut early_stop)?
        }
        Command::Calibrate {
            scene,
            parameter,
            period,
        } => {
            let scene = read(scene)?;
            if let Some(path) = parameter {
                note_former_path(&scene, path);
            }
            report_errors(dwell_study::calibrate(
                &scene,
                parameter.as_deref(),
                *period,
            ))?
        }
        Command::Sweep {
            scene,
            vary,
            samples,
            seed,
            results,
            shard,
            export,
        } => {
            let scene = read(scene)?;
            for axis in vary {
                let path = axis.split(['=', '~', '±']).next().unwrap_or_default();
                note_former_path(&scene, path.trim());
            }
            let sweep = ParameterSweep {
                vary,
                samples: *samples,
                seed: *seed,
                requests: results,
                shard: *shard,
                export: *export,
                folder: &out,
            };
            report_errors(with_progress(|progress| {
                dwell_study::sweep(&scene, &sweep, progress)
            }))?
        }
        Command::Validate {
            cases,
            folder,
            slow,
        } => {
            let (outcome, failed) = validate::validate(cases, folder, *slow)?;
            failures = failed;
            outcome
        }
        // Printed above: it needs neither a scene nor a folder.
        Command::Schema => Outcome::default(),
    };
    print(&outcome.summary)?;
    if !outcome.files.is_empty() {
        let written = outcome.files.write(&out).map_err(|e| {
            miette!(
                help = "no file was written; choose another folder with --out",
                "{e}"
            )
        })?;
        let shown = written.len().min(12);
        for path in &written[..shown] {
            print(&format!("  {}\n", path.display()))?;
        }
        if written.len() > shown {
            let rest = written.len() - shown;
            print(&format!("  and {rest} more below {}\n", out.display()))?;
        }
    }
    if let Some(reason) = &early_stop {
        // A closed standard error is no reason to panic.
        let _ = writeln!(std::io::stderr(), "{reason:?}");
    }
    match failures {
        // Printed last, so that it is not overlooked.
        Some(report) => Err(report),
        None => Ok(early_stop.is_none() && all_pass(&outcome.findings)),
    }
}

/// Analyses a scene along its trajectory; if that ends early, `early_stop` holds the reason.
fn run_trajectory(
    arguments: &TrajectoryArgs,
    run: Run,
    early_stop: &mut Option<Report>,
) -> Result<Outcome, Report> {
    let scene = read(&arguments.scene)?;
    let points = arguments.points.map(|n| n as usize);
    run_until_stop(
        |progress| dwell_study::analyse_trajectory(&scene, run, points, progress),
        early_stop,
    )
}

/// Runs a study of a trajectory with a progress bar; if the trajectory ends early, `early_stop` holds the reason.
fn run_until_stop(
    run: impl FnOnce(Progress<'_>) -> Result<TrajectoryOutcome, StudyError>,
    early_stop: &mut Option<Report>,
) -> Result<Outcome, Report> {
    let done = report_errors(with_progress(run))?;
    *early_stop = done.early_stop.map(|e| Report::new(as_scene_error(e)));
    Ok(done.outcome)
}

/// Runs a long study with a progress bar.
fn with_progress<T>(run: impl FnOnce(Progress<'_>) -> T) -> T {
    let bar = progress_bar();
    let progress = |step: Step<'_>| {
        bar.set_length(step.total as u64);
        bar.set_message(step.done.to_owned());
        bar.inc(1);
    };
    let done = run(&progress);
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
    let scene = Scene::read(path).map_err(Report::new)?;
    print_warnings(&scene);
    Ok(scene)
}

/// Shows on standard error which former names the scene uses; the exit status does not change.
fn print_warnings(scene: &Scene) {
    for warning in &scene.warnings {
        // A closed standard error is no reason to panic.
        let _ = writeln!(std::io::stderr(), "{:?}", Report::new(warning.clone()));
    }
}

/// Says on standard error that the path of a number has a former name of a key.
fn note_former_path(scene: &Scene, path: &str) {
    if let Some(current) = scene.renamed_path(path) {
        let _ = writeln!(std::io::stderr(), "note: {path} is now {current}");
    }
}

/// A study's error as a report: an error of the scene shows the place in its text.
fn report_errors<T>(result: Result<T, StudyError>) -> Result<T, Report> {
    result.map_err(|e| Report::new(as_scene_error(e)))
}

fn validation_error(error: ValidationError) -> SceneError {
    match error {
        ValidationError::Study(error) => as_scene_error(error),
        other => error_without_location(other.to_string()),
    }
}

fn as_scene_error(error: StudyError) -> SceneError {
    match error {
        StudyError::Scene(scene) => *scene,
        StudyError::Sweep(sweep) => SceneError {
            help: sweep.help(),
            ..error_without_location(sweep.to_string())
        },
        other => error_without_location(other.to_string()),
    }
}

/// An error that refers to no part of the scene.
fn error_without_location(message: String) -> SceneError {
    SceneError {
        message,
        help: None,
        labels: Vec::new(),
        text: None,
        related: Vec::new(),
    }
}

fn print(text: &str) -> Result<(), Report> {
    match std::io::stdout().write_all(text.as_bytes()) {
        // The reader closed the pipe, as in `dwell … | head`.
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.map_err(|e| miette!("cannot print the results: {e}")),
    }
}
