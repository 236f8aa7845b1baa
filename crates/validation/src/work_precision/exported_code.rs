//! The exported C with a fixed step, as in a controller: errors of the motion, and mean and largest time of a call. It is
//! compiled by a C compiler of this machine.

use super::combination::Errors;
use super::evaluator::Evaluator;
use super::fixed_step::STEP;
use super::reference_solution::ReferenceSolution;
use super::studied_scene::StudiedScene;
use super::subject::Subject;
use dwell_export::{Export, Identifiers, LoadEffect, Precision, Request, c_files};
use dwell_study::{ExportRequest, compute_export};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The measured exports: name, accuracy and precision; the last two are the model's own operations.
const EXPORTS: [(&str, f64, Precision, bool); 4] = [
    ("cells 1e-9, double", 1e-9, Precision::Double, false),
    ("cells 1e-6, float", 1e-6, Precision::Float, false),
    ("operations, double", 1e-9, Precision::Double, true),
    ("operations, float", 1e-6, Precision::Float, true),
];
/// The C compilers that are tried.
const COMPILERS: [&str; 3] = ["cc", "gcc", "clang"];
/// The program around the code.
const DRIVER: &str = include_str!("exported_code.c");

/// The exported code of one accuracy.
#[derive(Debug, Clone, PartialEq)]
pub struct ExportedCode {
    /// Its name.
    pub name: &'static str,
    /// The largest error of its coefficients, relative to the largest value of each.
    pub coefficients: f64,
    /// The errors of a motion with steps of 1 ms, with exact reactions.
    pub errors: Errors,
    /// The mean and the largest time of a call of all coefficients and of a step, in units of one exact evaluation.
    pub times: [[f64; 2]; 2],
}

/// All exports of a motion, or the reason why there are none.
pub(super) fn exported_code<S: StudiedScene>(
    reference: &mut ReferenceSolution<'_, S>,
    exact: &dyn Evaluator,
    subject: &Subject<S>,
    evaluation_time: f64,
) -> Result<Vec<ExportedCode>, String> {
    let scene = &subject.scene;
    if subject.initial_state.y.len() != 2 {
        return Err("it has other states than this motion".to_owned());
    }
    let compiler = COMPILERS.into_iter().find(is_there);
    let compiler = compiler.ok_or("there is no C compiler here")?;
    let mut all = Vec::new();
    let mut reason = None;
    for (name, accuracy, precision, is_exact) in EXPORTS {
        let mut one = || {
            let export = export(scene, accuracy, precision, is_exact)?;
            let (states, times) = run(&export, subject, compiler)?;
            let errors = reference.errors(&states, &mut exact.reactions());
            let in_evaluations = |t: f64| t / evaluation_time;
            Ok::<_, String>(ExportedCode {
                name,
                coefficients: export.measured.errors.max(),
                errors: errors.map_err(|e| super::run::reason(&e))?,
                times: times.map(|pair| pair.map(in_evaluations)),
            })
        };
        match one() {
            Ok(found) => all.push(found),
            Err(error) => reason = reason.or(Some(error)),
        }
    }
    match (all.is_empty(), reason) {
        (true, Some(reason)) => Err(reason),
        _ => Ok(all),
    }
}

fn is_there(compiler: &&str) -> bool {
    let found = Command::new(compiler).arg("--version").output();
    found.is_ok_and(|output| output.status.success())
}

fn export<S: StudiedScene>(
    scene: &S,
    accuracy: f64,
    precision: Precision,
    exact: bool,
) -> Result<Export, String> {
    let asked = ExportRequest {
        request: Request {
            accuracy,
            precision,
        },
        exact,
        interval: None,
    };
    let export = compute_export(scene, &asked).map_err(|e| e.to_string())?;
    let varies = |effect: &LoadEffect| match effect {
        LoadEffect::Input { .. } | LoadEffect::VariableDamper { .. } | LoadEffect::Motor(_) => true,
        LoadEffect::Conservative { .. }
        | LoadEffect::Constant { .. }
        | LoadEffect::Damper { .. } => false,
    };
    let mut loads = export.machine.loads.iter();
    match loads.find(|load| varies(&load.effect)) {
        Some(load) => Err(format!("{} is an input of it", load.name)),
        None => Ok(export),
    }
}

/// A folder that is removed with its owner.
struct Scratch(PathBuf);

impl Drop for Scratch {
    fn drop(&mut self) {
        // If this fails, the files remain in the system's temporary folder.
        _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The states at the subject's times, and the mean and largest times of a call, s: of all coefficients and of a step.
type Ran = (Vec<Vec<f64>>, [[f64; 2]; 2]);

fn run<S: StudiedScene>(
    export: &Export,
    subject: &Subject<S>,
    compiler: &str,
) -> Result<Ran, String> {
    static COUNT: AtomicUsize = AtomicUsize::new(0);
    let number = COUNT.fetch_add(1, Ordering::Relaxed);
    let name = format!("dwell-exported-code-{}-{number}", std::process::id());
    let folder = Scratch(std::env::temp_dir().join(name));
    let failed = |what: &str, why: &dyn std::fmt::Display| format!("{what} failed: {why}");
    std::fs::create_dir_all(&folder.0).map_err(|e| failed("writing it", &e))?;
    let [header, source] = c_files(export);
    let main = driver(export, subject);
    let files = [&header, &source, &("main.c".to_owned(), main)];
    for (path, text) in files {
        std::fs::write(folder.0.join(path), text).map_err(|e| failed("writing it", &e))?;
    }
    let flags = ["-std=gnu99", "-O2", "main.c", &source.0, "-lm", "-o", "run"];
    output(Command::new(compiler).args(flags), &folder.0)
        .map_err(|e| failed("compiling it", &e))?;
    let program = folder.0.join("run");
    let text = output(&mut Command::new(program), &folder.0).map_err(|e| failed("its run", &e))?;
    let numbers: Vec<f64> = text.split_whitespace().flat_map(str::parse).collect();
    let states = 2 * subject.times.len();
    if numbers.len() != states + 4 {
        return Err("it leaves its range".to_owned());
    }
    let [coefficients, worst, step, worst_step] = [0, 1, 2, 3].map(|k| numbers[states + k]);
    let pairs = numbers[..states].chunks(2).map(<[f64]>::to_vec);
    Ok((pairs.collect(), [[coefficients, worst], [step, worst_step]]))
}

fn output(command: &mut Command, folder: &Path) -> Result<String, String> {
    let output = command
        .current_dir(folder)
        .output()
        .map_err(|e| e.to_string())?;
    if output.status.success() {
        Ok(String::from_utf8_lossy(&output.stdout).into_owned())
    } else {
        Err(String::from_utf8_lossy(&output.stderr).into_owned())
    }
}

/// The program: the motion through the subject's times, then the times of the calls.
fn driver<S: StudiedScene>(export: &Export, subject: &Subject<S>) -> String {
    let names = Identifiers::new(&export.machine);
    let times: Vec<String> = subject.times.iter().map(|t| format!("{t:e}")).collect();
    let coefficients = if export.machine.reactions.is_empty() {
        "@p@_motion_terms_at(state.q, &motion)"
    } else {
        "@p@_coefficients(state.q, &motion, &reactions)"
    };
    let reactions = if export.machine.reactions.is_empty() {
        ""
    } else {
        "static @p@_reaction_terms reactions;"
    };
    let state = subject.reduced_state();
    DRIVER
        .replace("@coefficients@", coefficients)
        .replace("@reactions@", reactions)
        .replace("@p@", &names.prefix)
        .replace("@U@", &names.capitals)
        .replace("@times@", &times.join(", "))
        .replace("@count@", &subject.times.len().to_string())
        .replace("@step@", &format!("{STEP:e}"))
        .replace("@q@", &format!("{:e}", state.q))
        .replace("@q_dot@", &format!("{:e}", state.q_dot))
}
