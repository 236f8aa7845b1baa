//! m, ½m′ and one reaction pair by hand, one pose at a time and in batches; the time of a pose as a function of the
//! size of the mechanism and of the number of requested reactions. Values are compared and asserted; times are printed
//! as ratios within one run.
//!
//! The subjects take turns, at other coordinates in every turn: unordered (steps of the golden angle), so that the
//! branches of the sine cannot be predicted, and ordered, as in a sweep.

mod bench;
mod closed_form_general;
mod closed_form_reduced;

use bench::{Case, EVALUATIONS, GOLDEN_ANGLE, reactions, stop};
use closed_form_general::General;
use closed_form_reduced::{Body, FourBar, SliderCrank};
use dwell_geometry::{
    Actuator, AssemblyConfiguration, Body as Named, Joint, Mechanism, Reaction, Vec2, vec2,
};
use dwell_kinetostatics::{Batch, ExactModel, Mass, Model, ReducedModel};
use dwell_scene::PlaneScene;
use rayon::ThreadPool;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::hint::black_box;
use std::time::Instant;

/// Turns of each subject.
const ROUNDS: usize = 200;
/// The chains: numbers of four-bars.
const CHAINS: [usize; 7] = [1, 3, 10, 30, 100, 300, 1000];
/// The chains that are compiled, and how many times each.
const COMPILED_CHAINS: [usize; 4] = [100, 1000, 10_000, 100_000];
const COMPILATIONS: usize = 3;

/// By hand: from coordinates to m, ½m′, a and b; one after another where each coordinate has something of the last
/// m, as an integrator's has, or as the processor likes.
type ClosedFormBatch = Box<dyn Fn(&[f64], Option<f64>, &mut [[f64; 4]])>;

/// A mechanism by hand and by Dwell.
struct Comparison {
    name: &'static str,
    closed_form: ClosedFormBatch,
    exact: ExactModel,
}

/// One thread, and all of them.
struct Threads {
    one: ThreadPool,
    all: ThreadPool,
}

fn main() {
    let pool = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        pool.unwrap_or_else(|e| stop("threads", &e.to_string()))
    };
    let threads = Threads {
        one: pool(1),
        all: pool(0),
    };
    let comparisons = [single_dwell(), four_bar(), slider_crank()];
    for comparison in &comparisons {
        agree(comparison, &coordinates(0, false));
    }
    println!(
        "m, m'/2 and one reaction pair: least ns a pose; ratios to the hand (in batches: to both)"
    );
    let count = format!("batches, {} threads", threads.all.current_num_threads());
    println!(
        "{:26}{:^24}{:^25}{:^23}{count:^23}",
        "", "each waits: hand, Dwell", "none waits: hand, Dwell", "batches, 1 thread"
    );
    for comparison in &comparisons {
        for ordered in [false, true] {
            compare(comparison, ordered, &threads);
        }
    }
    chains(&threads.one);
    compilations();
    requested();
}

/// Coordinates over a turn for one turn of the subjects, none of them met before.
fn coordinates(round: usize, ordered: bool) -> Vec<f64> {
    let phase = 0.1 + round as f64 * GOLDEN_ANGLE / 3.0;
    let step = if ordered {
        TAU / EVALUATIONS as f64
    } else {
        GOLDEN_ANGLE
    };
    let all = (0..EVALUATIONS).map(|k| phase + k as f64 * step);
    all.map(|q| q.rem_euclid(TAU)).collect()
}

fn compare(comparison: &Comparison, ordered: bool, threads: &Threads) {
    let exact = &comparison.exact;
    let mut closed_form_values = vec![[0.0; 4]; EVALUATIONS];
    let (mut batch, mut workspace) = (Batch::default(), exact.workspace());
    let mut out = exact.model().coefficient_buffer();
    let mut min_ns = [f64::INFINITY; 6];
    for round in 0..ROUNDS {
        let q = coordinates(round, ordered);
        for latency_bound in [true, false] {
            // Nothing, but the processor does not know.
            let part = latency_bound.then(|| black_box(0.0));
            let at = usize::from(!latency_bound);
            time(&mut min_ns[at], || {
                (comparison.closed_form)(black_box(&q), part, &mut closed_form_values);
                black_box(&closed_form_values);
            });
            time(&mut min_ns[2 + at], || {
                for &q in black_box(&q) {
                    let q = part.map_or(q, |part| q + part * out.m);
                    black_box(exact.coefficients(q, &mut workspace, &mut out).is_ok());
                    black_box(&out);
                }
            });
        }
        for (pool, min_ns) in [&threads.one, &threads.all]
            .into_iter()
            .zip(&mut min_ns[4..])
        {
            pool.install(|| {
                time(min_ns, || {
                    exact.reduce_batch(black_box(&q), &mut batch);
                    black_box(&batch);
                });
            });
        }
    }
    print_row(comparison.name, ordered, min_ns);
}

/// Prints times in ns, each with its ratio to the time of the closed form.
fn print_row(name: &str, ordered: bool, min_ns: [f64; 6]) {
    let [
        closed_form_latency,
        closed_form_throughput,
        latency,
        throughput,
        lanes,
        all,
    ] = min_ns;
    let order = if ordered { "in order" } else { "in no order" };
    print!("{name:14}{order:12}");
    print!(
        "{closed_form_latency:8.1}{latency:9.1}{:7.2}",
        latency / closed_form_latency
    );
    print!(
        "{closed_form_throughput:9.1}{throughput:9.1}{:7.2}",
        throughput / closed_form_throughput
    );
    for ns in [lanes, all] {
        print!(
            "{ns:9.1}{:7.2}{:7.2}",
            ns / closed_form_latency,
            ns / closed_form_throughput
        );
    }
    println!();
}

fn time(min_ns: &mut f64, evaluate: impl FnOnce()) {
    let start = Instant::now();
    evaluate();
    *min_ns = min_ns.min(start.elapsed().as_secs_f64() * 1e9 / EVALUATIONS as f64);
}

/// IFToMM's A02: N four-bars in a row, all links 1 m and 1 kg. Its m is (4 N + 1)/3, whatever the angle.
fn chain(n: usize) -> ExactModel {
    let pin = |bodies: [usize; 2], points| Joint::revolute("pin", bodies, points);
    let tip = vec2(1.0, 0.0);
    let mut joints = vec![pin([0, 1], [Vec2::ZERO; 2])];
    for i in 1..=n {
        let [before, coupler, link] = [2 * i - 1, 2 * i, 2 * i + 1];
        joints.extend([
            pin([before, coupler], [tip, Vec2::ZERO]),
            pin([coupler, link], [tip, tip]),
            pin([0, link], [vec2(i as f64, 0.0), Vec2::ZERO]),
        ]);
    }
    let mechanism = Mechanism {
        bodies: (0..2 * n + 2).map(|_| Named::named("link")).collect(),
        joints,
        actuators: vec![Actuator::angle("theta", [0, 1])],
        ..Mechanism::default()
    };
    let bar = Mass::uniform_bar(1.0, 1.0);
    let assembly = AssemblyConfiguration {
        q: vec![FRAC_PI_2],
        initial_guess: (0..2 * n + 2)
            .map(|b| Some(if b % 2 == 1 { FRAC_PI_2 } else { 0.0 }))
            .collect(),
        ..AssemblyConfiguration::default()
    };
    let model = Model::new(&mechanism, &vec![bar; 2 * n + 2], &assembly, &[])
        .unwrap_or_else(|e| stop("chain", &e.to_string()));
    ExactModel::new(model).unwrap_or_else(|| stop("chain", "it has several actuators"))
}

/// Time per group in chains of increasing length.
fn chains(thread: &ThreadPool) {
    println!("\nm and m'/2 of a chain of N four-bars (A02): least ns a group");
    println!("{:>8}{:>16}{:>16}", "N", "one by one", "in batches");
    for n in CHAINS {
        let exact = chain(n);
        let (mut workspace, mut batch) = (exact.workspace(), Batch::default());
        let count = (EVALUATIONS / n).max(64);
        let mut min_ns = [f64::INFINITY; 2];
        for round in 0..ROUNDS / 10 {
            // Clear of the flat positions, where it is singular.
            let at =
                |k: usize| 0.5 + 2.0 * ((k + round * count) as f64 * GOLDEN_ANGLE / TAU).fract();
            let q: Vec<f64> = (0..count).map(at).collect();
            let part = EVALUATIONS as f64 / (count * n) as f64;
            let mut spent = [f64::INFINITY; 2];
            time(&mut spent[0], || {
                for &q in black_box(&q) {
                    black_box(exact.inertia(q, &mut workspace).is_ok());
                }
            });
            thread.install(|| {
                time(&mut spent[1], || {
                    exact.reduce_batch(black_box(&q), &mut batch);
                });
            });
            for (min_ns, spent) in min_ns.iter_mut().zip(spent) {
                *min_ns = min_ns.min(spent * part);
            }
            let m = (4.0 * n as f64 + 1.0) / 3.0;
            for (k, &q) in q.iter().enumerate() {
                let one = exact.inertia(q, &mut workspace).ok();
                assert_eq!(one, Some((batch.m[k], batch.half_dm[k])), "{n} at {q}");
                // A rounding of a link is handed on N times, divided by sin q each time.
                let [difference, slope] = [batch.m[k] - m, batch.half_dm[k]].map(|v| v.abs() / m);
                assert!(
                    difference < 1e-11 && slope < 1e-11,
                    "{n} at {q}: {difference:e} {slope:e}"
                );
            }
        }
        println!("{n:8}{:16.1}{:16.1}", min_ns[0], min_ns[1]);
    }
}

/// Time to describe and compile chains of four-bars of increasing length.
fn compilations() {
    println!("\nA chain of N four-bars (A02) compiled: least s, and us a four-bar");
    for n in COMPILED_CHAINS {
        let spent = (0..COMPILATIONS).map(|_| {
            let start = Instant::now();
            black_box(chain(n));
            start.elapsed().as_secs_f64()
        });
        let min = spent.fold(f64::INFINITY, f64::min);
        println!("{n:8}{min:12.4}{:12.1}", min / n as f64 * 1e6);
    }
}

/// Time of requested reactions of the single-dwell. The values are the same to the last bit for any number of them.
fn requested() {
    let case = Case::read("single-dwell");
    let all_reactions = case.scene.mechanism.reactions();
    let models = [0, 1, 4, all_reactions.len()].map(|count| {
        let some: Vec<Reaction> = all_reactions[all_reactions.len() - count..].to_vec();
        case.model(&some)
    });
    let mut workspaces = models.each_ref().map(|model| model.workspace());
    let mut outs = models
        .each_ref()
        .map(|model| model.model().coefficient_buffer());
    let mut min_ns = [f64::INFINITY; 4];
    for round in 0..ROUNDS {
        let q = coordinates(round, false);
        for (i, model) in models.iter().enumerate() {
            time(&mut min_ns[i], || {
                for &q in black_box(&q) {
                    black_box(
                        model
                            .coefficients(q, &mut workspaces[i], &mut outs[i])
                            .is_ok(),
                    );
                    black_box(&outs[i]);
                }
            });
        }
        let [.., all] = &outs;
        for out in &outs {
            let from = all.a.len() - out.a.len();
            assert_eq!((out.m, out.half_dm), (all.m, all.half_dm));
            assert_eq!((&out.a[..], &out.b[..]), (&all.a[from..], &all.b[from..]));
        }
    }
    println!("\nsingle-dwell, by requested reactions: least ns a pose, ratio to none");
    for (model, ns) in models.iter().zip(min_ns) {
        println!("{:8}{ns:16.1}{:16.2}", model.reactions(), ns / min_ns[0]);
    }
}

fn batch_of(at: impl Fn(f64) -> [f64; 4] + 'static) -> ClosedFormBatch {
    Box::new(move |q, part, out| match part {
        Some(part) => {
            let mut last = 0.0;
            for (&q, out) in q.iter().zip(out) {
                *out = at(q + part * last);
                last = out[0];
            }
        }
        None => {
            for (&q, out) in q.iter().zip(out) {
                *out = at(q);
            }
        }
    })
}

fn single_dwell() -> Comparison {
    let case = Case::read("single-dwell");
    let general = General::new();
    Comparison {
        name: "single-dwell",
        exact: case.model(&reactions(&case.scene, "slide.normal")),
        closed_form: batch_of(move |q| general.at(q)),
    }
}

fn body(scene: &PlaneScene, name: &str) -> Body {
    let found = scene.mechanism.bodies.iter().position(|b| b.name == name);
    let mass = found.and_then(|at| scene.masses.get(at));
    let mass = mass.unwrap_or_else(|| stop(&scene.name, name));
    Body {
        mass: mass.mass,
        center: [mass.center.x, mass.center.y],
        inertia: mass.inertia,
    }
}

fn four_bar() -> Comparison {
    let case = Case::read("crank-rocker");
    let closed_form = FourBar {
        bars: [1.0, 3.5, 3.0, 4.0],
        bodies: ["crank", "coupler", "rocker"].map(|name| body(&case.scene, name)),
    };
    Comparison {
        name: "four-bar",
        exact: case.model(&reactions(&case.scene, "C.x")),
        closed_form: batch_of(move |q| closed_form.at(q)),
    }
}

fn slider_crank() -> Comparison {
    let case = Case::read("slider-crank");
    let closed_form = SliderCrank {
        bars: [0.08, 0.28],
        offset: 0.025,
        bodies: ["crank", "rod"].map(|name| body(&case.scene, name)),
        piston: body(&case.scene, "piston").mass,
    };
    Comparison {
        name: "slider-crank",
        exact: case.model(&reactions(&case.scene, "guide.normal")),
        closed_form: batch_of(move |q| closed_form.at(q)),
    }
}

/// Holds all against each other: the batch against single evaluations to the last bit, both against the
/// hand to rounding.
fn agree(comparison: &Comparison, q: &[f64]) {
    let mut reference = vec![[0.0; 4]; q.len()];
    (comparison.closed_form)(q, None, &mut reference);
    let mut batch = Batch::default();
    comparison.exact.reduce_batch(q, &mut batch);
    let (mut workspace, mut out) = (
        comparison.exact.workspace(),
        comparison.exact.model().coefficient_buffer(),
    );
    let (mut largest, mut difference) = ([0.0_f64; 4], [0.0_f64; 4]);
    for (i, &q) in q.iter().enumerate() {
        let done = comparison.exact.coefficients(q, &mut workspace, &mut out);
        done.unwrap_or_else(|e| stop(comparison.name, &e.to_string()));
        let one = [out.m, out.half_dm, out.a[0], out.b[0]];
        let all = [batch.m[i], batch.half_dm[i], batch.a[i], batch.b[i]];
        assert_eq!(one, all, "{} at {q}", comparison.name);
        for k in 0..4 {
            largest[k] = largest[k].max(reference[i][k].abs());
            difference[k] = difference[k].max((one[k] - reference[i][k]).abs());
        }
    }
    for (name, k) in [("m", 0), ("m'/2", 1), ("a", 2), ("b", 3)] {
        let scaled = difference[k] / largest[k];
        assert!(
            scaled < 1e-12,
            "{}: {name} differs by {scaled:e} of its largest",
            comparison.name
        );
    }
}
