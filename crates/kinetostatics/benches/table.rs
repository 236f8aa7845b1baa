//! Time of one evaluation of a table, compared with a bare cubic lookup and with the exact model.
//!
//! As in `reduced`, the subjects take turns within one process, each at a new coordinate every time; the
//! ratios are those of the fastest turns. The bare lookup is the least that a table of cubic pieces can do:
//! as many cells as the table has, no whole revolutions to reduce, no ends to check. It gives m and ½m′ (or
//! one of them), to some 1e-6 where the table gives 1e-12.

use dwell_kinetostatics::{ExactModel, Model, ReducedModel, TableDomain, TabulatedModel};
use dwell_scene::PlaneScene;
use std::f64::consts::TAU;
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

/// Evaluations in one turn of a subject, and turns of each.
const EVALUATIONS: usize = 4000;
const ROUNDS: usize = 400;
/// The golden section: an irrational part.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
/// The required accuracy of the tables.
const ACCURACY: f64 = 1e-12;

/// Values and slopes in equal cells, by the coefficients of a cubic in each.
struct Cubic {
    cells: Vec<[f64; 4]>,
    per_cell: f64,
}

impl Cubic {
    fn new(model: &ExactModel, cells: usize) -> Self {
        let (mut workspace, width) = (model.workspace(), TAU / cells as f64);
        let mut at = |i: usize| {
            let q = width * (i % cells) as f64;
            let inertia = model.inertia(q, &mut workspace);
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
    min_ns: f64,
}

impl<'a> Subject<'a> {
    fn new<R>(name: &'static str, mut at: impl FnMut(f64) -> R + 'a) -> Self {
        // Known beforehand: a turn taken off in the loop is a branch that is often guessed wrong, and costs
        // more than a table.
        let coordinate = |i: usize| TAU * (0.1 + GOLDEN * i as f64).fract();
        let coordinates: Vec<f64> = (0..EVALUATIONS).map(coordinate).collect();
        let evaluate = Box::new(move || {
            for &q in &coordinates {
                black_box(at(black_box(q)));
            }
        });
        Self {
            name,
            evaluate,
            min_ns: f64::INFINITY,
        }
    }

    fn run_round(&mut self) {
        let start = Instant::now();
        (self.evaluate)();
        let ns = start.elapsed().as_secs_f64() * 1e9 / EVALUATIONS as f64;
        self.min_ns = self.min_ns.min(ns);
    }
}

fn main() {
    make("crank-rocker");
    make("single-dwell");
    for case in ["single-dwell", "crank-rocker"] {
        measure(case);
    }
}

/// Time to build a table of m and ½m′ alone.
fn make(case: &str) {
    let exact = read(case, false);
    for accuracy in [1e-6, 1e-9, 1e-12] {
        let mut min_us = f64::INFINITY;
        let mut cells = 0;
        let mut bound = 0.0;
        for _ in 0..200 {
            let start = Instant::now();
            let table = TabulatedModel::new(&exact, accuracy, TableDomain::Full);
            let table = black_box(table.unwrap_or_else(|e| stop(&e.to_string())));
            min_us = min_us.min(start.elapsed().as_secs_f64() * 1e6);
            cells = table.cells()[0];
            bound = table.max_bound();
        }
        println!(
            "{case}: m and m'/2 to {accuracy:.0e}: {cells} cells, bound {bound:.1e}, made in {min_us:.0} us"
        );
    }
}

// Long because it lists what is measured.
fn measure(case: &str) {
    let exact = read(case, true);
    let made = Instant::now();
    let table = TabulatedModel::new(&exact, ACCURACY, TableDomain::Full)
        .unwrap_or_else(|e| stop(&e.to_string()));
    let made = made.elapsed().as_secs_f64() * 1e3;
    let cubic = Cubic::new(&exact, table.cells()[0]);
    let difference = agree(&exact, &table, &cubic);

    let (mut workspace, mut exact_workspace) = (exact.workspace(), exact.workspace());
    let (mut out, mut tabulated) = (
        exact.model().coefficient_buffer(),
        exact.model().coefficient_buffer(),
    );
    let mut subjects = [
        Subject::new("bare loop", |q| q),
        Subject::new("bare cubic, m alone", |q| cubic.m(q)),
        Subject::new("bare cubic, m and m'/2", |q| cubic.both(q)),
        Subject::new("table, m and m'/2", |q| table.inertia(q, &mut ())),
        Subject::new("… 1000 revolutions on", |q| {
            table.inertia(q + 1000.0 * TAU, &mut ())
        }),
        Subject::new("table, m, m'/2 and m''/2", |q| {
            table.inertia_derivatives(q, &mut ())
        }),
        Subject::new("table, all coefficients", |q| {
            let done = table.coefficients(q, &mut (), &mut tabulated).is_ok();
            black_box(&tabulated);
            done
        }),
        Subject::new("exact, m and m'/2", |q| exact.inertia(q, &mut workspace)),
        Subject::new("exact, all coefficients", |q| {
            let done = exact
                .coefficients(q, &mut exact_workspace, &mut out)
                .is_ok();
            black_box(&out);
            done
        }),
    ];
    for _ in 0..ROUNDS {
        for subject in &mut subjects {
            subject.run_round();
        }
    }
    let [cells, others, _] = table.cells();
    let [bytes, all] = table.bytes();
    println!(
        "\n{case}: table of {ACCURACY:.0e}, made in {made:.0} ms, bound {:.1e}, met {:.1e} (the cubic: {:.0e})",
        table.max_bound(),
        difference[0],
        difference[1]
    );
    println!(
        "{cells} cells of m and m'/2 in {bytes} bytes; {others} of a and b, {all} bytes in all"
    );
    let [alone, both] = [subjects[1].min_ns, subjects[2].min_ns];
    println!("                               ns   / cubic of m   / cubic of both");
    for Subject {
        name,
        min_ns: least,
        ..
    } in &subjects
    {
        let (one, two) = (least / alone, least / both);
        println!("{name:26}{least:8.1}{one:13.2}{two:16.2}");
    }
}

/// The largest differences from the exact model as parts of the largest value: of the table, of the cubic.
fn agree(exact: &ExactModel, table: &TabulatedModel, cubic: &Cubic) -> [f64; 2] {
    let mut workspace = exact.workspace();
    let (mut largest, mut difference) = ([0.0_f64; 2], [[0.0_f64; 2]; 2]);
    for i in 0..10_000 {
        let q = TAU * (0.1 + GOLDEN * f64::from(i)).fract();
        let reference = exact.inertia(q, &mut workspace);
        let (m, half_dm) = reference.unwrap_or_else(|e| stop(&e.to_string()));
        let found = table.inertia(q, &mut ());
        let found = found.unwrap_or_else(|e| stop(&e.to_string()));
        for (difference, (n, slope)) in difference.iter_mut().zip([found, cubic.both(q)]) {
            difference[0] = difference[0].max((n - m).abs());
            difference[1] = difference[1].max((slope - half_dm).abs());
        }
        largest = [largest[0].max(m), largest[1].max(half_dm.abs())];
    }
    difference.map(|[m, slope]| (m / largest[0]).max(slope / largest[1]))
}

fn read(case: &str, all_reactions: bool) -> ExactModel {
    let home = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    let scene = PlaneScene::read(home.join(case).join("scene.toml"))
        .unwrap_or_else(|e| stop(&e.to_string()));
    let assembly = scene.assembly.to_configuration();
    let reactions = if all_reactions {
        scene.mechanism.reactions()
    } else {
        Vec::new()
    };
    let model = Model::new(&scene.mechanism, &scene.masses, &assembly, &reactions)
        .unwrap_or_else(|e| stop(&e.to_string()));
    ExactModel::new(model).unwrap_or_else(|| stop("it has several actuators"))
}

fn stop(why: &str) -> ! {
    eprintln!("{why}");
    std::process::exit(1)
}
