//! Kinds of tables of m and ½m′ by size, cost of making and cost of a value: pieces of degree 3 to 9, and
//! the global series evaluated as they stand (Fourier's over a turn, Chebyshev's over a part of it).
//!
//! All of them interpolate ½m′, and m is its integral. All are made as small as they can be with four times their
//! largest error within the accuracy. The library's table is the one of degree 7; these neither reduce whole
//! revolutions nor check their ends.

use dwell_kinetostatics::{ExactModel, Model, ReducedModel, TableDomain, TabulatedModel};
use dwell_scene::PlaneScene;
use std::f64::consts::{PI, TAU};
use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

/// The golden section: an irrational part.
const GOLDEN: f64 = 0.618_033_988_749_894_9;
const EVALUATIONS: usize = 4000;
const ROUNDS: usize = 200;
/// Points at which a table is held against the exact model.
const CHECKED: usize = 4000;

/// A table of m and ½m′.
trait Kind: Sized {
    /// Builds a table of `size` cells or terms over [0, length].
    fn build(exact: &ExactModel, length: f64, size: usize) -> Self;
    fn at(&self, q: f64) -> [f64; 2];
    fn bytes(&self) -> usize;
    /// How the error goes with the size: as its inverse to this power, or as a geometric series.
    const ORDER: Option<f64>;
}

/// Pieces of degree 2N − 1 through values and slopes at N places of a cell; T = 2N + 1.
struct Piecewise<const N: usize, const T: usize> {
    cells: Vec<[[f64; 2]; T]>,
    per_cell: f64,
}

/// The places of Gauss and Lobatto.
fn lobatto_nodes(count: usize) -> Vec<f64> {
    match count {
        2 => vec![-1.0, 1.0],
        3 => vec![-1.0, 0.0, 1.0],
        4 => vec![-1.0, -0.2_f64.sqrt(), 0.2_f64.sqrt(), 1.0],
        _ => vec![
            -1.0,
            -(3.0 / 7.0_f64).sqrt(),
            0.0,
            (3.0 / 7.0_f64).sqrt(),
            1.0,
        ],
    }
}

/// Hermite's polynomial by rising powers, from values and slopes at places.
fn hermite(nodes: &[f64], data: &[[f64; 2]]) -> Vec<f64> {
    let terms = 2 * nodes.len();
    let mut difference: Vec<f64> = (0..terms).map(|i| data[i / 2][0]).collect();
    for order in 1..terms {
        for i in (order..terms).rev() {
            difference[i] = if order == 1 && i % 2 == 1 {
                data[i / 2][1]
            } else {
                let spacing = nodes[i / 2] - nodes[(i - order) / 2];
                (difference[i] - difference[i - 1]) / spacing
            };
        }
    }
    let mut powers = vec![0.0; terms];
    for i in (0..terms).rev() {
        for j in (1..terms).rev() {
            powers[j] = powers[j - 1] - nodes[i / 2] * powers[j];
        }
        powers[0] = difference[i] - nodes[i / 2] * powers[0];
    }
    powers
}

impl<const N: usize, const T: usize> Kind for Piecewise<N, T> {
    const ORDER: Option<f64> = Some(2.0 * N as f64);

    fn build(exact: &ExactModel, length: f64, size: usize) -> Self {
        let (nodes, mut workspace) = (lobatto_nodes(N), exact.workspace());
        let half = 0.5 * length / size as f64;
        let mut m = None;
        let mut left = None;
        let mut cells = Vec::with_capacity(size);
        for cell in 0..size {
            let middle = half * (2 * cell + 1) as f64;
            let mut data = Vec::with_capacity(N);
            for (i, x) in nodes.iter().enumerate() {
                let known = left.filter(|_| i == 0);
                let at = known.unwrap_or_else(|| {
                    let at = exact.inertia_derivatives(middle + half * x, &mut workspace);
                    at.unwrap_or_else(|e| stop(&e.to_string()))
                });
                left = Some(at);
                m.get_or_insert(at.m);
                data.push([at.half_dm, at.half_ddm * half]);
            }
            let mut coefficients = [[0.0; 2]; T];
            for (j, g) in hermite(&nodes, &data).into_iter().enumerate() {
                coefficients[j][1] = g;
                coefficients[j + 1][0] = 2.0 * half * g / (j + 1) as f64;
            }
            let sum = |x: f64| coefficients.iter().rev().fold(0.0, |s, c| s * x + c[0]);
            let (below, above) = (sum(-1.0), sum(1.0));
            // Put together from the left end.
            let start = m.unwrap_or_default() - below;
            m = Some(start + above);
            coefficients[0][0] = start;
            cells.push(coefficients);
        }
        Self {
            cells,
            per_cell: size as f64 / length,
        }
    }

    #[inline(always)]
    fn at(&self, q: f64) -> [f64; 2] {
        let part = q * self.per_cell;
        // A 32-bit number is one instruction from and to a float.
        let cell = (part as i32).min(self.cells.len() as i32 - 1);
        let x = 2.0 * (part - f64::from(cell)) - 1.0;
        let c = &self.cells[cell as usize];
        let x2 = x * x;
        let [mut m, mut slope] = c[T - 1];
        for i in (0..N).rev() {
            let ([m0, s0], [m1, s1]) = (c[2 * i], c[2 * i + 1]);
            m = m * x2 + (m0 + m1 * x);
            slope = slope * x2 + (s0 + s1 * x);
        }
        [m, slope]
    }

    fn bytes(&self) -> usize {
        std::mem::size_of_val(self.cells.as_slice())
    }
}

/// A series over a turn: coefficients of e^ikq, of m and of ½m′.
struct Fourier {
    terms: Vec<[[f64; 2]; 2]>,
}

impl Kind for Fourier {
    const ORDER: Option<f64> = None;

    fn build(exact: &ExactModel, length: f64, size: usize) -> Self {
        let (mut workspace, points) = (exact.workspace(), 2 * size);
        let at = |i: usize| {
            let m = exact.inertia(length * i as f64 / points as f64, &mut workspace);
            m.unwrap_or_else(|e| stop(&e.to_string())).0
        };
        let samples: Vec<f64> = (0..points).map(at).collect();
        let phases: Vec<(f64, f64)> = (0..points)
            .map(|i| (TAU * i as f64 / points as f64).sin_cos())
            .collect();
        let term = |k: usize| {
            let mut sum = [0.0; 2];
            for (i, m) in samples.iter().enumerate() {
                let (sin, cos) = phases[i * k % points];
                sum = [sum[0] + m * cos, sum[1] - m * sin];
            }
            let scale = if k == 0 { 1.0 } else { 2.0 } / points as f64;
            let [re, im] = sum.map(|s| s * scale);
            let half = 0.5 * k as f64;
            [[re, im], [-half * im, half * re]]
        };
        Self {
            terms: (0..size).map(term).collect(),
        }
    }

    fn at(&self, q: f64) -> [f64; 2] {
        let (sin, cos) = q.sin_cos();
        let mut sums = [[0.0; 2]; 2];
        for term in self.terms.iter().rev() {
            for (sum, term) in sums.iter_mut().zip(term) {
                let [re, im] = *sum;
                *sum = [re * cos - im * sin + term[0], re * sin + im * cos + term[1]];
            }
        }
        sums.map(|sum| sum[0])
    }

    fn bytes(&self) -> usize {
        std::mem::size_of_val(self.terms.as_slice())
    }
}

/// A series of Chebyshev's polynomials: coefficients of m and ½m′.
struct Chebyshev {
    terms: Vec<[f64; 2]>,
    length: f64,
}

impl Kind for Chebyshev {
    const ORDER: Option<f64> = None;

    fn build(exact: &ExactModel, length: f64, size: usize) -> Self {
        let mut workspace = exact.workspace();
        let angle = |i: usize| PI * (i as f64 + 0.5) / size as f64;
        let at = |i: usize| {
            let both = exact.inertia(0.5 * length * (1.0 + angle(i).cos()), &mut workspace);
            both.unwrap_or_else(|e| stop(&e.to_string()))
        };
        let samples: Vec<(f64, f64)> = (0..size).map(at).collect();
        let term = |k: usize| {
            let mut sum = [0.0; 2];
            for (i, (m, slope)) in samples.iter().enumerate() {
                let cos = (k as f64 * angle(i)).cos();
                sum = [sum[0] + m * cos, sum[1] + slope * cos];
            }
            sum.map(|s| s * if k == 0 { 1.0 } else { 2.0 } / size as f64)
        };
        Self {
            terms: (0..size).map(term).collect(),
            length,
        }
    }

    fn at(&self, q: f64) -> [f64; 2] {
        let x = 2.0 * q / self.length - 1.0;
        let (mut one, mut two) = ([0.0; 2], [0.0; 2]);
        for term in self.terms.iter().skip(1).rev() {
            let next = [0, 1].map(|k: usize| 2.0 * x * one[k] - two[k] + term[k]);
            (two, one) = (one, next);
        }
        [0, 1].map(|k: usize| x * one[k] - two[k] + self.terms[0][k])
    }

    fn bytes(&self) -> usize {
        std::mem::size_of_val(self.terms.as_slice())
    }
}

/// The exact model at points off every grid, and the largest values.
struct Reference {
    at: Vec<(f64, [f64; 2])>,
    largest: [f64; 2],
}

impl Reference {
    fn new(exact: &ExactModel, length: f64) -> Self {
        let mut workspace = exact.workspace();
        let mut largest = [0.0_f64; 2];
        let mut at = Vec::new();
        for i in 0..CHECKED {
            let q = length * (0.1 + GOLDEN * i as f64).fract();
            let both = exact.inertia(q, &mut workspace);
            let (m, slope) = both.unwrap_or_else(|e| stop(&e.to_string()));
            largest = [largest[0].max(m.abs()), largest[1].max(slope.abs())];
            at.push((q, [m, slope]));
        }
        Self { at, largest }
    }

    fn error(&self, kind: &impl Kind) -> f64 {
        let mut max_error = 0.0_f64;
        for (q, reference) in &self.at {
            let tabulated = kind.at(*q);
            for k in 0..2 {
                max_error = max_error.max((tabulated[k] - reference[k]).abs() / self.largest[k]);
            }
        }
        max_error
    }
}

/// The smallest size that keeps the accuracy.
fn smallest<K: Kind>(
    exact: &ExactModel,
    reference: &Reference,
    length: f64,
    accuracy: f64,
) -> usize {
    let enough = |size: usize| 4.0 * reference.error(&K::build(exact, length, size)) <= accuracy;
    let (mut below, mut size) = (1, 4);
    while !enough(size) {
        if size > 20_000 {
            stop("no size reaches the accuracy");
        }
        (below, size) = (size, 2 * size);
    }
    while size - below > 1 + size / 100 {
        let middle = below + (size - below) / 2;
        if enough(middle) {
            size = middle;
        } else {
            below = middle;
        }
    }
    size
}

/// The coordinates are known beforehand: a turn taken off in the loop is a branch that is often guessed wrong.
fn nanoseconds<R>(length: f64, mut at: impl FnMut(f64) -> R) -> f64 {
    let coordinate = |i: usize| length * (0.1 + GOLDEN * i as f64).fract();
    let coordinates: Vec<f64> = (0..EVALUATIONS).map(coordinate).collect();
    let mut min_ns = f64::INFINITY;
    for _ in 0..ROUNDS {
        let start = Instant::now();
        for &q in &coordinates {
            black_box(at(black_box(q)));
        }
        min_ns = min_ns.min(start.elapsed().as_secs_f64() * 1e9 / EVALUATIONS as f64);
    }
    min_ns
}

fn microseconds<R>(mut make: impl FnMut() -> R) -> f64 {
    let mut min_us = f64::INFINITY;
    for _ in 0..50 {
        let start = Instant::now();
        black_box(make());
        min_us = min_us.min(start.elapsed().as_secs_f64() * 1e6);
    }
    min_us
}

fn row<K: Kind>(name: &str, exact: &ExactModel, reference: &Reference, length: f64, accuracy: f64) {
    let size = smallest::<K>(exact, reference, length, accuracy);
    let made = microseconds(|| K::build(exact, length, size));
    let kind = K::build(exact, length, size);
    let cost = nanoseconds(length, |q| kind.at(q));
    let unit = if K::ORDER.is_some() { "cells" } else { "terms" };
    println!(
        "{name:24}{accuracy:8.0e}{size:7} {unit}{:9} bytes{made:9.0} us{cost:9.1} ns",
        kind.bytes()
    );
}

fn main() {
    for (case, length) in [
        ("crank-rocker", TAU),
        ("single-dwell", TAU),
        ("crank-rocker", 2.0),
    ] {
        let exact = read(case);
        let reference = Reference::new(&exact, length);
        println!("\n{case}, from 0 to {length:.3} rad");
        for accuracy in [1e-6, 1e-9, 1e-12] {
            row::<Piecewise<2, 5>>("pieces of degree 3", &exact, &reference, length, accuracy);
            row::<Piecewise<3, 7>>("pieces of degree 5", &exact, &reference, length, accuracy);
            row::<Piecewise<4, 9>>("pieces of degree 7", &exact, &reference, length, accuracy);
            row::<Piecewise<5, 11>>("pieces of degree 9", &exact, &reference, length, accuracy);
            if length == TAU {
                row::<Fourier>("Fourier's series", &exact, &reference, length, accuracy);
            } else {
                row::<Chebyshev>("Chebyshev's series", &exact, &reference, length, accuracy);
            }
            library(&exact, length, accuracy);
        }
    }
}

fn library(exact: &ExactModel, length: f64, accuracy: f64) {
    let domain = if length == TAU {
        TableDomain::Full
    } else {
        TableDomain::Between(0.0, length)
    };
    let make =
        || TabulatedModel::new(exact, accuracy, domain).unwrap_or_else(|e| stop(&e.to_string()));
    let (made, table) = (microseconds(make), make());
    let cost = nanoseconds(length, |q| table.inertia(q, &mut ()));
    println!(
        "{:24}{accuracy:8.0e}{:7} cells{:9} bytes{made:9.0} us{cost:9.1} ns",
        "the library's, checked",
        table.cells()[0],
        table.bytes()[0],
    );
}

fn read(case: &str) -> ExactModel {
    let home = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    let scene = PlaneScene::read(home.join(case).join("scene.toml"))
        .unwrap_or_else(|e| stop(&e.to_string()));
    let assembly = scene.assembly.to_configuration();
    let model = Model::new(&scene.mechanism, &scene.masses, &assembly, &[])
        .unwrap_or_else(|e| stop(&e.to_string()));
    ExactModel::new(model).unwrap_or_else(|| stop("it has several actuators"))
}

fn stop(why: &str) -> ! {
    eprintln!("{why}");
    std::process::exit(1)
}
