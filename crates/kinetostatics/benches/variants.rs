//! Time of a variant whose numbers are filled into one structure: m, ½m′ and a reaction over the turn, the mean of the
//! period and all extremes. It is compared with the positions alone of a four-bar with NumPy, in batches of 1000 at 200
//! poses, in the same run. The first argument is a Python that has NumPy, `python3` unless given.

mod bench;

use bench::{Case, stop};
use dwell_kinetostatics::Model;
use dwell_kinetostatics::variants::VariantModel;
use dwell_scene::PlaneScene;
use std::hint::black_box;
use std::io::{BufRead, BufReader, Write};
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::Instant;

/// Variants of a turn of a subject, and turns of each subject.
const VARIANTS: usize = 1000;
const ROUNDS: usize = 40;
/// Largest relative change of a number.
const DEVIATION: f64 = 0.02;

/// The variants of a mechanism.
struct Subject {
    name: &'static str,
    structure: VariantModel,
    numbers: Vec<Vec<f64>>,
    times: Vec<f64>,
}

impl Subject {
    fn new(case: &'static str, reaction: &str) -> Self {
        let scene = without_loads(Case::read(case).scene);
        let all = scene.mechanism.reactions();
        let mut named = all.into_iter();
        let reaction = named.find(|r| scene.mechanism.reaction_name(*r) == reaction);
        let reaction = reaction.unwrap_or_else(|| stop(case, "no such reaction"));
        let typical = variant(&scene, 0);
        let start = typical.assembly.to_configuration();
        let model = Model::new(&typical.mechanism, &typical.masses, &start, &[reaction])
            .unwrap_or_else(|e| stop(case, &e.to_string()));
        let structure = VariantModel::new(model);
        let structure = structure.unwrap_or_else(|| stop(case, "no structure for variants"));
        let numbers = (1..=VARIANTS).map(|k| {
            let scene = variant(&scene, k);
            let numbers = structure.numbers(&scene.mechanism, &scene.masses, &[]);
            numbers.unwrap_or_else(|| stop(case, "another structure"))
        });
        Self {
            name: case,
            numbers: numbers.collect(),
            structure,
            times: Vec::new(),
        }
    }

    fn run_round(&mut self) {
        let start = Instant::now();
        let mut fill = |k: usize, to: &mut [f64]| {
            to.copy_from_slice(&self.numbers[k]);
            0.0
        };
        let mut complete = 0;
        self.structure
            .turns(0..VARIANTS, &mut fill, &mut |_, variant| {
                complete += usize::from(black_box(variant).is_some());
            });
        self.times
            .push(start.elapsed().as_secs_f64() / VARIANTS as f64 * 1e6);
        assert_eq!(complete, VARIANTS, "{}", self.name);
    }
}

/// The scene without its loads and prescribed motion.
fn without_loads(scene: PlaneScene) -> PlaneScene {
    let text = scene.source.inner();
    let Some((before, _)) = text.split_once("[prescribed]") else {
        return scene;
    };
    let reread = PlaneScene::parse(&scene.name, before);
    reread.unwrap_or_else(|e| stop(&scene.name, &e.to_string()))
}

/// All numbers of the bodies changed a little, each by a golden sequence of its own.
fn variant(scene: &PlaneScene, number: usize) -> PlaneScene {
    let paths = scene.number_paths();
    let changed = paths.iter().enumerate().map(|(k, path)| {
        let phase =
            ((1 + number + 7919 * k) as f64 * bench::GOLDEN_ANGLE / std::f64::consts::TAU).fract();
        let value = scene
            .value(path)
            .unwrap_or_else(|e| stop(path, &e.to_string()));
        (
            path.as_str(),
            value * (1.0 + DEVIATION * (2.0 * phase - 1.0)),
        )
    });
    let changed: Vec<(&str, f64)> = changed.collect();
    let scene = scene.with_values(&changed);
    scene.unwrap_or_else(|e| stop("variant", &e.to_string()))
}

/// The four-bar with NumPy.
struct NumPy {
    child: Child,
    ask: ChildStdin,
    answers: BufReader<ChildStdout>,
}

impl NumPy {
    /// `None` if that Python does not start or has no NumPy.
    fn start(python: &str) -> Option<Self> {
        let script = concat!(env!("CARGO_MANIFEST_DIR"), "/benches/four_bar_positions.py");
        let mut command = Command::new(python);
        let threads = ["OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"].map(|name| (name, "1"));
        let piped = command.arg(script).envs(threads).stdin(Stdio::piped());
        let mut child = piped.stdout(Stdio::piped()).spawn().ok()?;
        let (ask, answers) = (child.stdin.take()?, BufReader::new(child.stdout.take()?));
        Some(Self {
            child,
            ask,
            answers,
        })
    }

    /// In a loop over the poses, and in one operation over all.
    fn run_round(&mut self) -> Option<[f64; 2]> {
        writeln!(self.ask).ok()?;
        let mut line = String::new();
        self.answers.read_line(&mut line).ok()?;
        let mut times = line.split_whitespace().map(str::parse);
        Some([times.next()?.ok()?, times.next()?.ok()?])
    }

    fn finish(mut self) {
        drop(self.ask);
        let _ = self.child.wait();
    }
}

fn fastest(times: &[f64]) -> f64 {
    times.iter().copied().fold(f64::INFINITY, f64::min)
}

fn main() {
    let given = std::env::args().skip(1).find(|arg| !arg.starts_with("--"));
    let python = given.unwrap_or_else(|| "python3".to_owned());
    let mut subjects = [
        Subject::new("single-dwell", "slide.normal"),
        Subject::new("crank-rocker", "C.x"),
        Subject::new("watt-six-bar", "G.x"),
    ];
    let mut numpy = NumPy::start(&python);
    let mut numpy_times = [Vec::new(), Vec::new()];
    for _ in 0..ROUNDS {
        subjects.iter_mut().for_each(Subject::run_round);
        if let Some(times) = numpy.as_mut().and_then(NumPy::run_round) {
            numpy_times
                .iter_mut()
                .zip(times)
                .for_each(|(all, time)| all.push(time));
        }
    }
    if let Some(numpy) = numpy {
        numpy.finish();
    }
    let [reference, at_once] = numpy_times.each_ref().map(|times| fastest(times));
    println!("us a variant (fastest of {ROUNDS} rounds of {VARIANTS}), and against NumPy");
    if numpy_times[0].is_empty() {
        println!("{python} has no NumPy: no comparison");
    } else {
        for (name, time) in [("pose by pose", reference), ("at once", at_once)] {
            let name = format!("NumPy, four-bar positions, {name}");
            println!("{name:40} {time:6.2}   {:4.2}", time / reference);
        }
    }
    for subject in &subjects {
        let time = fastest(&subject.times);
        println!("{:40} {time:6.2}   {:4.2}", subject.name, time / reference);
    }
}
