//! What one evaluation of a table costs, against a bare cubic lookup and against the exact model.
//!
//! As in `reduced`, the subjects take turns within one process, each at a new coordinate every time; the
//! ratios are those of the fastest turns. The bare lookup is the least that a table of cubic pieces can do:
//! as many cells as the table has, no turns to take off, no end to look out for; it gives m and ½m′ (or
//! one of them), to some 1e-6 where the table gives 1e-12.

use dwell_kinetostatics::{Exact, Extent, Model, Reduced, Table};
use dwell_scene::Scene;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

/// Evaluations in one turn of a subject, and turns of each.
const EVALUATIONS: usize = 4000;
const TURNS: usize = 400;
/// The golden section: an irrational part.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// What the tables are asked for.
const ACCURACY: f64 = 1e-12;

/// Values and slopes in equal cells, by the coefficients of a cubic in each.
struct Cubic {
    cells: Vec<[f64; 4]>,
    per_cell: f64,
}

impl Cubic {
    fn new(model: &Exact, cells: usize) -> Self {
        let (mut work, width) = (model.work(), TAU / cells as f64);
        let mut at = |i: usize| {
            let q = width * (i % cells) as f64;
            let inertia = model.inertia(q, &mut work);
            inertia.unwrap_or_else(|e| stop(&e.to_string()))
        };
        let cell = |i: usize| {
            let ((m, s), (n, t)) = (at(i), at(i + 1));
            let (s, t, d) = (2.0 * width * s, 2.0 * width * t, n - m);
            [m, s, 3.0 * d - 2.0 * s - t, s + t - 2.0 * d]
        };
        Self {
            cells: (0..cells).map(cell).collect(),
            per_cell: 1.0 / width,
        }
    }

    #[inline]
    fn m(&self, q: f64) -> f64 {
        let part = q * self.per_cell;
        let cell = part as usize;
        let x = part - cell as f64;
        let [c0, c1, c2, c3] = self.cells[cell];
        ((c3 * x + c2) * x + c1) * x + c0
    }

    #[inline]
    fn both(&self, q: f64) -> (f64, f64) {
        let part = q * self.per_cell;
        let cell = part as usize;
        let x = part - cell as f64;
        let [c0, c1, c2, c3] = self.cells[cell];
        let slope = (3.0 * c3 * x + 2.0 * c2) * x + c1;
        (
            ((c3 * x + c2) * x + c1) * x + c0,
            0.5 * slope * self.per_cell,
        )
    }
}

/// One row.
struct Subject<'a> {
    name: &'static str,
    evaluate: Box<dyn FnMut() + 'a>,
    least: f64,
}

impl<'a> Subject<'a> {
    fn new<R>(name: &'static str, mut at: impl FnMut(f64) -> R + 'a) -> Self {
        // Known beforehand: a turn taken off in the loop is a branch that is often guessed wrong, and costs
        // more than a table.
        let place = |i: usize| TAU * (0.1 + GOLDEN * i as f64).fract();
        let places: Vec<f64> = (0..EVALUATIONS).map(place).collect();
        let evaluate = Box::new(move || {
            for &q in &places {
                black_box(at(black_box(q)));
            }
        });
        Self {
            name,
            evaluate,
            least: f64::INFINITY,
        }
    }

    fn take_turn(&mut self) {
        let start = Instant::now();
        (self.evaluate)();
        let ns = start.elapsed().as_secs_f64() * 1e9 / EVALUATIONS as f64;
        self.least = self.least.min(ns);
    }
}

fn main() {
    make("crank-rocker");
    make("single-dwell");
    for case in ["single-dwell", "crank-rocker"] {
        measure(case);
    }
}

/// What making a table of m and ½m′ alone costs.
fn make(case: &str) {
    let exact = read(case, false);
    for accuracy in [1e-6, 1e-9, 1e-12] {
        let mut least = f64::INFINITY;
        let mut cells = 0;
        let mut bound = 0.0;
        for _ in 0..200 {
            let start = Instant::now();
            let table = Table::new(&exact, accuracy, Extent::Whole);
            let table = black_box(table.unwrap_or_else(|e| stop(&e.to_string())));
            least = least.min(start.elapsed().as_secs_f64() * 1e6);
            cells = table.cells()[0];
            bound = table.bound();
        }
        println!(
            "{case}: m and m'/2 to {accuracy:.0e}: {cells} cells, bound {bound:.1e}, made in {least:.0} us"
        );
    }
}

fn measure(case: &str) {
    let exact = read(case, true);
    let made = Instant::now();
    let table = Table::new(&exact, ACCURACY, Extent::Whole);
    let table = table.unwrap_or_else(|e| stop(&e.to_string()));
    let made = made.elapsed().as_secs_f64() * 1e3;
    let cubic = Cubic::new(&exact, table.cells()[0]);
    let off = agree(&exact, &table, &cubic);

    let (mut work, mut exact_work) = (exact.work(), exact.work());
    let (mut out, mut own) = (exact.model().coefficients(), exact.model().coefficients());
    let mut subjects = [
        Subject::new("bare loop", |q| q),
        Subject::new("bare cubic, m alone", |q| cubic.m(q)),
        Subject::new("bare cubic, m and m'/2", |q| cubic.both(q)),
        Subject::new("table, m and m'/2", |q| table.inertia(q, &mut ())),
        Subject::new("… 1000 turns on", |q| {
            table.inertia(q + 1000.0 * TAU, &mut ())
        }),
        Subject::new("table, m, m'/2 and m''/2", |q| table.curvature(q, &mut ())),
        Subject::new("table, all coefficients", |q| {
            let done = table.coefficients(q, &mut (), &mut own).is_ok();
            black_box(&own);
            done
        }),
        Subject::new("exact, m and m'/2", |q| exact.inertia(q, &mut work)),
        Subject::new("exact, all coefficients", |q| {
            let done = exact.coefficients(q, &mut exact_work, &mut out).is_ok();
            black_box(&out);
            done
        }),
    ];
    for _ in 0..TURNS {
        for subject in &mut subjects {
            subject.take_turn();
        }
    }
    let [cells, others, _] = table.cells();
    let [bytes, all] = table.bytes();
    println!(
        "\n{case}: table of {ACCURACY:.0e}, made in {made:.0} ms, bound {:.1e}, met {:.1e} (the cubic: {:.0e})",
        table.bound(),
        off[0],
        off[1]
    );
    println!(
        "{cells} cells of m and m'/2 in {bytes} bytes; {others} of a and b, {all} bytes in all"
    );
    let [alone, both] = [subjects[1].least, subjects[2].least];
    println!("                               ns   / cubic of m   / cubic of both");
    for Subject { name, least, .. } in &subjects {
        let (one, two) = (least / alone, least / both);
        println!("{name:26}{least:8.1}{one:13.2}{two:16.2}");
    }
}

/// The largest differences from the exact model as parts of the largest value: of the table, of the cubic.
fn agree(exact: &Exact, table: &Table, cubic: &Cubic) -> [f64; 2] {
    let mut work = exact.work();
    let (mut largest, mut off) = ([0.0_f64; 2], [[0.0_f64; 2]; 2]);
    for i in 0..10_000 {
        let q = TAU * (0.1 + GOLDEN * f64::from(i)).fract();
        let truth = exact.inertia(q, &mut work);
        let (m, half_dm) = truth.unwrap_or_else(|e| stop(&e.to_string()));
        let found = table.inertia(q, &mut ());
        let found = found.unwrap_or_else(|e| stop(&e.to_string()));
        for (off, (n, slope)) in off.iter_mut().zip([found, cubic.both(q)]) {
            off[0] = off[0].max((n - m).abs());
            off[1] = off[1].max((slope - half_dm).abs());
        }
        largest = [largest[0].max(m), largest[1].max(half_dm.abs())];
    }
    off.map(|[m, slope]| (m / largest[0]).max(slope / largest[1]))
}

fn read(case: &str, loaded: bool) -> Exact {
    let home = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    let scene = Scene::read(home.join(case).join("scene.toml"));
    let scene = scene.unwrap_or_else(|e| stop(&e.to_string()));
    let start = scene.assembly.to_start();
    let reactions = if loaded {
        scene.mechanism.reactions()
    } else {
        Vec::new()
    };
    let model = Model::new(&scene.mechanism, &scene.masses, &start, &reactions);
    let model = model.unwrap_or_else(|e| stop(&e.to_string()));
    Exact::new(model).unwrap_or_else(|| stop("it has several actuators"))
}

fn stop(why: &str) -> ! {
    eprintln!("{why}");
    std::process::exit(1)
}
