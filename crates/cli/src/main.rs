//! The `dwell` command: it reads a scene, runs one study of it, writes the files and prints the summary.
//!
//! Exit status: 0 success, 1 a check failed or a motion ended early, 2 invalid input (a scene, an argument, a folder that cannot be
//! written).

mod cases;
mod former;
mod instants;
mod long_runs;
mod options;
mod times;
mod validate;

use clap::{CommandFactory as _, FromArgMatches as _};
use dwell_findings::all_pass;
use dwell_report::{Files, OutputFolder, ReportError};
use dwell_scene::{Scene, SceneError};
use dwell_study::{
    Analysis, MotionSolver, Outcome, ParameterSweep, PictureFormat, PictureSpan, Pictures,
    SolverSettings, Step, StudyError, TableRequest, TrajectoryOutcome, no_progress,
};
use dwell_validation::ValidationError;
use indicatif::{ProgressBar, ProgressStyle};
use long_runs::LongRunLines;
use miette::{Report, miette};
use options::{Command, Options, TrajectoryArgs};
use std::io::Write as _;
use std::path::Path;
use std::process::ExitCode;
use std::time::Duration;
use times::Times;

fn main() -> ExitCode {
    // clap itself exits with 2 on a bad argument, and with 0 for help.
    let (arguments, notes) = former::with_current_names(std::env::args_os());
    notes.iter().for_each(|note| print_note(note));
    let matches = Options::command().get_matches_from(arguments);
    let options = Options::from_arg_matches(&matches).unwrap_or_else(|e| e.exit());
    match run(options, matches.subcommand_name().unwrap_or_default()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(report) => {
            print_note(&format!("{report:?}"));
            ExitCode::from(2)
        }
    }
}

/// Runs a command of this name, and returns whether all its checks passed.
fn run(options: Options, name: &str) -> Result<bool, Report> {
    let Options {
        command,
        out,
        pictures,
        picture_format,
    } = options;
    let mut times = Times::new();
    if let Command::Schema = command {
        print(&dwell_scene::schema())?;
        return Ok(true);
    }
    let folder = open_folder(&command, &out)?;
    let bar = progress_bar();
    let lines = LongRunLines::new(name, &bar);
    let (outcome, early_stop, failures) = match &command {
        Command::Validate {
            cases,
            folder,
            slow,
            seed,
        } => {
            let (outcome, failures) = validate::validate(cases, folder, (*slow, *seed), &bar)?;
            times.add("checking");
            let outcome = draw_validation(outcome, picture_format)?;
            times.add("drawing");
            (outcome, None, failures)
        }
        study => {
            let done = run_study(study, &out, &bar);
            times.add("computing");
            let done = done.and_then(|done| draw_study(done, (pictures, picture_format), &bar));
            times.add("drawing");
            bar.finish_and_clear();
            let (outcome, early_stop) = done.map_err(|e| Report::new(as_scene_error(e)))?;
            (outcome, early_stop, None)
        }
    };
    // No line follows the results.
    drop(lines);
    print(&outcome.summary)?;
    if let Some(folder) = folder {
        write_files(&outcome.files, folder, &out)?;
    }
    times.add("writing");
    print_note(&times.text());
    let ended_early = early_stop.is_some();
    if let Some(reason) = early_stop {
        print_note(&format!("{:?}", Report::new(as_scene_error(reason))));
    }
    match failures {
        // Printed last, so that it is not overlooked.
        Some(report) => Err(report),
        None => Ok(!ended_early && all_pass(&outcome.findings)),
    }
}

/// Draws the pictures of a study that are wanted.
fn draw_study(
    done: TrajectoryOutcome,
    wanted: (Pictures, PictureFormat),
    bar: &ProgressBar,
) -> Result<(Outcome, Option<StudyError>), StudyError> {
    bar.set_position(0);
    let outcome = done.outcome.draw(wanted, &|step| show_step(bar, step))?;
    Ok((outcome, done.early_stop))
}

/// Draws all pictures of a validation. Its pages show those in pixels.
fn draw_validation(outcome: Outcome, format: PictureFormat) -> Result<Outcome, Report> {
    let format = match format {
        PictureFormat::Svg => PictureFormat::Both,
        format => format,
    };
    let drawn = outcome.draw((Pictures::All, format), &no_progress);
    drawn.map_err(|e| Report::new(as_scene_error(e)))
}

/// Runs a study of one scene: one arm for each command, so longer than a screen.
fn run_study(
    command: &Command,
    out: &Path,
    bar: &ProgressBar,
) -> Result<TrajectoryOutcome, StudyError> {
    let progress = |step: Step<'_>| show_step(bar, step);
    let outcome = match command {
        Command::Check { scene } => dwell_study::check(&read(scene, bar)?)?,
        Command::Reduce {
            scene,
            table_accuracy,
            accuracy,
            points,
            from,
            to,
        } => {
            let points = points.map(|n| n as usize);
            let tabulation = table_accuracy.or(*accuracy).map(|accuracy| TableRequest {
                accuracy,
                interval: from.zip(*to),
                required: table_accuracy.is_some(),
            });
            dwell_study::reduce(&read(scene, bar)?, points, tabulation)?
        }
        Command::Simulate {
            scene,
            method,
            rtol,
            atol,
            max_step,
            accuracy,
            sample_interval,
            times,
            from,
            to,
        } => {
            let solver = match *accuracy {
                Some(accuracy) => MotionSolver::Accuracy {
                    accuracy,
                    sample_interval: *sample_interval,
                },
                None => MotionSolver::Settings(SolverSettings {
                    method: *method,
                    rtol: *rtol,
                    atol: atol.unwrap_or(*rtol),
                    max_step: *max_step,
                    sample_interval: *sample_interval,
                }),
            };
            let scene = read(scene, bar)?;
            let times = times.as_deref().map(instants::read).transpose()?;
            let span = PictureSpan {
                from: *from,
                to: *to,
            };
            return dwell_study::simulate_within(
                &scene,
                &solver,
                times.as_deref(),
                span,
                &progress,
            );
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
            return dwell_study::cycle(&read(scene, bar)?, &settings, *fluctuation);
        }
        Command::WorkPrecision { scene } => {
            let scene = read(scene, bar)?;
            dwell_validation::work_precision(&scene, &progress)?
        }
        Command::Equilibria { scene } => dwell_study::equilibria(&read(scene, bar)?)?,
        Command::Linearise { scene, about } => dwell_study::linearise(&read(scene, bar)?, *about)?,
        Command::Runs { scene, points } => {
            let points = points.map(|n| n as usize);
            return dwell_study::unit_runs(&read(scene, bar)?, points, &progress);
        }
        Command::Symbolic {
            scene,
            format,
            reaction,
        } => dwell_study::symbolic(&read(scene, bar)?, *format, reaction.as_deref())?,
        Command::Kinematics(arguments) => {
            return run_trajectory(arguments, Analysis::Kinematics, bar);
        }
        Command::Statics(arguments) => return run_trajectory(arguments, Analysis::Statics, bar),
        Command::Kinetostatics(arguments) => {
            return run_trajectory(arguments, Analysis::Kinetostatics, bar);
        }
        Command::Calibrate {
            scene,
            parameter,
            period,
        } => {
            let scene = read(scene, bar)?;
            if let Some(path) = parameter {
                note_former_path(&scene, path);
            }
            dwell_study::calibrate(&scene, parameter.as_deref(), *period)?
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
            let scene = read(scene, bar)?;
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
                folder: out,
            };
            dwell_study::sweep(&scene, &sweep, &progress)?
        }
        // They are no studies of a scene.
        Command::Validate { .. } | Command::Schema => Outcome::default(),
    };
    let early_stop = None;
    Ok(TrajectoryOutcome {
        outcome,
        early_stop,
    })
}

/// Analyses a scene along its trajectory.
fn run_trajectory(
    arguments: &TrajectoryArgs,
    analysis: Analysis,
    bar: &ProgressBar,
) -> Result<TrajectoryOutcome, StudyError> {
    let scene = read(&arguments.scene, bar)?;
    let points = arguments.points.map(|n| n as usize);
    let progress = |step: Step<'_>| show_step(bar, step);
    let span = PictureSpan {
        from: arguments.from,
        to: arguments.to,
    };
    dwell_study::analyse_trajectory_within(&scene, analysis, points, span, &progress)
}

/// The folder of the results, tested before the work; none for a command that writes nothing.
fn open_folder(command: &Command, out: &Path) -> Result<Option<OutputFolder>, Report> {
    if let Command::Check { .. } = command {
        return Ok(None);
    }
    if out.exists() && !out.is_dir() {
        return Err(miette!(
            help = "give a folder with --out; it is created if it does not exist",
            "`{}` is not a folder, so no report can be written there",
            out.display()
        ));
    }
    let mut folder = OutputFolder::open(out).map_err(|e| unwritten(&e))?;
    if let Some(scene) = command.scene() {
        folder
            .reserve(&Scene::name_of_file(scene), scene)
            .map_err(|e| unwritten(&e))?;
    }
    Ok(Some(folder))
}

fn unwritten(error: &ReportError) -> Report {
    let help = "no file was written; choose another folder with --out";
    miette!(help = help, "{error}")
}

/// Writes the files, and prints the paths of the first.
fn write_files(files: &Files, folder: OutputFolder, out: &Path) -> Result<(), Report> {
    if files.is_empty() {
        return Ok(());
    }
    let written = folder.write(files).map_err(|e| unwritten(&e))?;
    let shown = written.len().min(12);
    for path in &written[..shown] {
        print(&format!("  {}\n", path.display()))?;
    }
    match written.len() - shown {
        0 => Ok(()),
        rest => print(&format!("  and {rest} more below {}\n", out.display())),
    }
}

/// Shows a step of a long study.
fn show_step(bar: &ProgressBar, step: Step<'_>) {
    bar.set_length(step.total as u64);
    bar.set_message(step.done.to_owned());
    bar.inc(1);
}

fn progress_bar() -> ProgressBar {
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} {elapsed} {msg}") {
        bar.set_style(style);
    }
    bar
}

fn read(path: &Path, bar: &ProgressBar) -> Result<Scene, StudyError> {
    let scene = Scene::read(path)?;
    print_warnings(&scene);
    // From now on a terminal shows every second that the study goes on.
    bar.enable_steady_tick(Duration::from_secs(1));
    Ok(scene)
}

/// Shows on standard error which former names the scene uses; the exit status does not change.
fn print_warnings(scene: &Scene) {
    for warning in &scene.warnings {
        print_note(&format!("{:?}", Report::new(warning.clone())));
    }
}

/// Says on standard error that the path of a number has a former name of a key.
fn note_former_path(scene: &Scene, path: &str) {
    if let Some(current) = scene.renamed_path(path) {
        print_note(&format!("note: {path} is now {current}"));
    }
}

/// Prints a line on standard error.
fn print_note(text: &str) {
    // A closed standard error is no reason to panic.
    let _ = writeln!(std::io::stderr(), "{text}");
}

fn validation_error(error: ValidationError) -> SceneError {
    match error {
        ValidationError::Study(error) => as_scene_error(error),
        other => SceneError::without_labels(other.to_string(), None),
    }
}

fn as_scene_error(error: StudyError) -> SceneError {
    match error {
        StudyError::Scene(scene) => *scene,
        StudyError::Sweep(sweep) => SceneError::without_labels(sweep.to_string(), sweep.help()),
        other => SceneError::without_labels(other.to_string(), None),
    }
}

fn print(text: &str) -> Result<(), Report> {
    match std::io::stdout().write_all(text.as_bytes()) {
        // The reader closed the pipe, as in `dwell … | head`.
        Err(e) if e.kind() == std::io::ErrorKind::BrokenPipe => Ok(()),
        other => other.map_err(|e| miette!("cannot print the results: {e}")),
    }
}
