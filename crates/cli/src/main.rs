//! The `dwell` command: it reads a scene, runs one study of it, writes the files and prints the summary.
//!
//! Exit status: 0 success, 1 a check failed or a motion ended early, 2 invalid input (a scene, an argument, a folder that cannot be
//! written).

mod cases;
mod export;
mod exported_runs;
mod former;
mod gradient;
mod import;
mod init;
mod instants;
mod interface;
mod interrupt;
mod long_runs;
mod optimise;
mod options;
mod reduction;
mod simulation;
mod studies;
mod sweep;
mod times;
mod validate;
mod values;
mod view;

use clap::{CommandFactory as _, FromArgMatches as _};
use dwell_findings::all_pass;
use dwell_report::{Files, OutputFolder, ReportError};
use dwell_scene::{Scene, SceneError, SceneFile};
use dwell_study::{
    CommandResult, Outcome, PictureFormat, Pictures, Shard, Step, StudyError, TrajectoryOutcome,
    add_page, add_summary, no_progress,
};
use dwell_validation::ValidationError;
use indicatif::{ProgressBar, ProgressStyle};
use long_runs::LongRunLines;
use miette::{Report, miette};
use options::{Command, Options, STANDARD_INPUT, STANDARD_INPUT_NAME};
use reduction::ReduceArgs;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::Duration;
use sweep::SweepArgs;
use times::Times;

fn main() -> ExitCode {
    // clap itself exits with 2 on a bad argument, and with 0 for help.
    let matches = Options::command()
        .try_get_matches()
        .unwrap_or_else(|error| former::with_current_name(error).exit());
    let options = Options::from_arg_matches(&matches).unwrap_or_else(|e| e.exit());
    match run(&options, matches.subcommand_name().unwrap_or_default()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(report) => {
            print_note(&format!("{report:?}"));
            ExitCode::from(2)
        }
    }
}

/// Runs a command, and returns whether all its checks passed.
// Long, because each command that does not study one scene has an arm.
fn run(options: &Options, name: &str) -> Result<bool, Report> {
    let Options { command, .. } = options;
    let mut times = Times::new();
    match command {
        Command::Schema => return print(&dwell_scene::schema()).map(|()| true),
        Command::Import(arguments) => {
            let written = import::write(arguments, &options.out, options.name.as_deref());
            return written.map(|()| true);
        }
        Command::Init { scene } => return init::write(scene).map(|()| true),
        _ => {}
    }
    let folder = open_folder(options)?;
    if let Command::View { scene, page } = command {
        return view::write(options, scene, page.as_deref(), folder).map(|()| true);
    }
    let bar = progress_bar();
    let lines = LongRunLines::new(name, &bar);
    let done = match command {
        Command::Validate {
            cases,
            folder,
            slow,
        } => {
            let (outcome, failures) = validate::validate(cases, folder, *slow, &bar)?;
            times.add("checking");
            let outcome = draw_validation(outcome, options.picture_format)?;
            times.add("drawing");
            Done {
                outcome,
                failures,
                ..Done::default()
            }
        }
        Command::Reduce(
            arguments @ ReduceArgs {
                runs: Some(runs), ..
            },
        ) => {
            let done = exported_runs::reduce(options, arguments, runs, &mut times);
            bar.finish_and_clear();
            done.map_err(|e| Report::new(SceneError::from(e)))?
        }
        study => {
            let progress = |step: Step<'_>| show_step(&bar, step);
            let done = read(options, study, &bar);
            let done = done.and_then(|scene| {
                if matches!(study, Command::Optimise(_)) {
                    interrupt::keep_best_so_far();
                }
                let done = studies::run(study, &scene, &options.out, &progress);
                times.add("computing");
                let TrajectoryOutcome {
                    outcome,
                    early_stop,
                } = done?;
                bar.set_position(0);
                let wanted = (options.pictures, options.picture_format);
                let outcome = outcome.draw(wanted, &progress)?;
                Ok(Done {
                    outcome,
                    early_stop: early_stop.map(SceneError::from),
                    scene: Some(SceneFile::clone(&scene)),
                    ..Done::default()
                })
            });
            times.add("drawing");
            bar.finish_and_clear();
            done.map_err(|e| Report::new(SceneError::from(e)))?
        }
    };
    // No progress line may follow the results.
    drop(lines);
    finish(done, options, name, folder, times)
}

/// The result of a command.
#[derive(Default)]
struct Done {
    outcome: Outcome,
    /// The scene file, if the command studies one.
    scene: Option<SceneFile>,
    /// The name of the results, if the command studies exported tables.
    exported: Option<String>,
    /// The reason why a trajectory ended early.
    early_stop: Option<SceneError>,
    /// The cases that could not be validated.
    failures: Option<SceneError>,
}

/// Prints and writes the results, and returns whether all checks passed.
fn finish(
    mut done: Done,
    options: &Options,
    name: &str,
    folder: OutputFolder,
    mut times: Times,
) -> Result<bool, Report> {
    let passed = done.early_stop.is_none() && all_pass(&done.outcome.findings);
    let status = match (&done.failures, passed) {
        (Some(_), _) => 2,
        (None, passed) => u8::from(!passed),
    };
    let errors = done.early_stop.iter().chain(&done.failures).cloned();
    let of_scene = done.scene.as_ref().map(|scene| scene.name.as_str());
    let results = of_scene.or(done.exported.as_deref());
    let stem = results_stem(&options.command, name, results);
    let result = CommandResult {
        command: name,
        scene: done.scene.as_ref(),
        path: &format!("{stem}.json"),
        status,
        errors: &errors.collect::<Vec<_>>(),
    };
    // If no case could be validated, there are no files.
    if status < 2 || !done.outcome.files.is_empty() {
        let page = match (options.html, &options.command) {
            // Its pages are written already.
            (_, Command::Validate { .. }) | (false, _) => Ok(()),
            (true, _) => add_page(&mut done.outcome, &result, &format!("{stem}.html")),
        };
        let added = page.and_then(|()| add_summary(&mut done.outcome, &result));
        added.map_err(|e| Report::new(SceneError::from(e)))?;
    }
    print(&done.outcome.summary)?;
    write_files(&done.outcome.files, folder, &options.out)?;
    times.add("writing");
    print_note(&times.text());
    if let Some(reason) = done.early_stop {
        print_note(&format!("{:?}", Report::new(reason)));
    }
    match done.failures {
        // Printed last, so that it is not overlooked.
        Some(error) => Err(Report::new(error)),
        None => Ok(passed),
    }
}

/// Draws all pictures of a validation. Its pages show the PNG files.
fn draw_validation(outcome: Outcome, format: PictureFormat) -> Result<Outcome, Report> {
    let format = match format {
        PictureFormat::Svg => PictureFormat::Both,
        format => format,
    };
    let drawn = outcome.draw((Pictures::All, format), &no_progress);
    drawn.map_err(|e| Report::new(SceneError::from(e)))
}

/// The paths of summary and page in the output folder, without extension. Each shard of a sweep has its own, and so have tolerances.
fn results_stem(command: &Command, name: &str, results: Option<&str>) -> String {
    let of_scene = results.map_or(String::new(), |results| format!("{results}-"));
    let part = match command {
        Command::Sweep(SweepArgs {
            shard: Some(Shard { part, of }),
            ..
        }) => format!("-{part}-of-{of}"),
        Command::Gradient(given) if given.is_of_tolerances() => "-tolerance".to_owned(),
        _ => String::new(),
    };
    format!("{of_scene}{name}{part}")
}

/// The output folder, tested before the computation.
fn open_folder(options: &Options) -> Result<OutputFolder, Report> {
    let out = &options.out;
    if out.exists() && !out.is_dir() {
        return Err(miette!(
            help = "give a folder with --out; it is created if it does not exist",
            "`{}` is not a folder, so no report can be written there",
            out.display()
        ));
    }
    let mut folder = OutputFolder::open(out).map_err(|e| unwritten(&e))?;
    let source = match &options.command {
        Command::Reduce(ReduceArgs {
            runs: Some(runs), ..
        }) => {
            let first = runs.first().map(PathBuf::as_path);
            first.map(|first| (exported_runs::name(options, runs), first))
        }
        command => command
            .scene()
            .map(|scene| (scene_name(options, scene), scene)),
    };
    if let Some((name, source)) = source {
        folder.reserve(&name, source).map_err(|e| unwritten(&e))?;
    }
    Ok(folder)
}

/// The name of the scene in a file or on standard input.
fn scene_name(options: &Options, scene: &Path) -> String {
    match &options.name {
        Some(name) => name.clone(),
        None if scene == Path::new(STANDARD_INPUT) => STANDARD_INPUT_NAME.to_owned(),
        None => Scene::name_of_file(scene),
    }
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

/// Shows the progress of a long study.
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

/// Reads the scene of a command.
fn read(options: &Options, command: &Command, bar: &ProgressBar) -> Result<Scene, StudyError> {
    let path = command.scene().unwrap_or_else(|| Path::new(STANDARD_INPUT));
    let scene = if path == Path::new(STANDARD_INPUT) {
        Scene::read_from(std::io::stdin().lock(), STANDARD_INPUT_NAME, "<stdin>")?
    } else {
        Scene::read(path)?
    };
    let scene = scene.named(scene_name(options, path));
    print_warnings(&scene);
    // From now on a terminal is updated every second.
    bar.enable_steady_tick(Duration::from_secs(1));
    Ok(scene)
}

/// Shows the warnings of a scene on standard error; the exit status does not change.
fn print_warnings(scene: &SceneFile) {
    for warning in &scene.warnings {
        print_note(&format!("{:?}", Report::new(warning.clone())));
    }
}

/// Prints a line on standard error.
pub(crate) fn print_note(text: &str) {
    // A closed standard error is no reason to panic.
    let _ = writeln!(std::io::stderr(), "{text}");
}

fn validation_error(error: ValidationError) -> SceneError {
    match error {
        ValidationError::Study(error) => error.into(),
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
