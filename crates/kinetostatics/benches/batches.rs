//! m, ½m′ and one reaction pair: by hand, one pose at a time, and in batches; then what the number of requested
//! reactions costs. Values are held against each other first; times are ratios of one run.

mod bench;
mod hand_written_general;
mod hand_written_reduced;

use bench::{Case, EVALUATIONS, STEP, Subject, TURN, TURNS, reactions, stop};
use dwell_kinetostatics::{Batch, Exact, Reduced};
use dwell_scene::Scene;
use hand_written_general::General;
use hand_written_reduced::{Body, FourBar, SliderCrank};
use std::f64::consts::TAU;
use std::hint::black_box;
use std::time::Instant;

/// A mechanism three ways: by hand, and by Dwell.
struct Trio {
    name: &'static str,
    hand: Box<dyn Fn(&[f64], &mut [[f64; 4]])>,
    one: Exact,
}

fn main() {
    let trios = [single_dwell(), four_bar(), slider_crank()];
    let golden: Vec<f64> = (0..EVALUATIONS)
        .map(|k| (0.1 + k as f64 * STEP).rem_euclid(TAU))
        .collect();
    for trio in &trios {
        agree(trio, &golden);
    }
    println!("m, m'/2, one reaction pair: ns a pose, of which the least; ratio to the hand");
    println!(
        "{:16}{:>8}{:>16}{:>16}",
        "", "by hand", "one by one", "in batches"
    );
    for trio in &trios {
        let mut by_hand = vec![[0.0; 4]; golden.len()];
        let mut batch = Batch::default();
        let (mut work, mut out) = (trio.one.work(), trio.one.model().coefficients());
        let mut least = [f64::INFINITY; 3];
        for _ in 0..TURNS {
            time(&mut least[0], || {
                (trio.hand)(black_box(&golden), &mut by_hand);
                black_box(&by_hand);
            });
            time(&mut least[1], || {
                for &q in black_box(&golden) {
                    black_box(trio.one.coefficients(q, &mut work, &mut out).is_ok());
                    black_box(&out);
                }
            });
            time(&mut least[2], || {
                trio.one.reduce_all(black_box(&golden), &mut batch);
                black_box(&batch);
            });
        }
        let [hand, one, all] = least;
        println!(
            "{:16}{hand:8.1}{one:9.1}{:7.2}{all:9.1}{:7.2}",
            trio.name,
            one / hand,
            all / hand
        );
    }
}

fn time(least: &mut f64, act: impl FnOnce()) {
    let start = Instant::now();
    act();
    *least = least.min(start.elapsed().as_secs_f64() * 1e9 / EVALUATIONS as f64);
}

fn every(at: impl Fn(f64) -> [f64; 4] + 'static) -> Box<dyn Fn(&[f64], &mut [[f64; 4]])> {
    Box::new(move |q, out| {
        for (&q, out) in q.iter().zip(out) {
            *out = at(q);
        }
    })
}

fn single_dwell() -> Trio {
    let case = Case::read("single-dwell");
    let general = General::new();
    Trio {
        name: "single-dwell",
        one: case.model(&reactions(&case.scene, "slide.normal")),
        hand: every(move |q| general.at(q)),
    }
}

fn body(scene: &Scene, name: &str) -> Body {
    let found = scene.mechanism.bodies.iter().position(|b| b.name == name);
    let mass = found.and_then(|at| scene.masses.get(at));
    let mass = mass.unwrap_or_else(|| stop(&scene.name, name));
    Body {
        mass: mass.mass,
        center: [mass.center.x, mass.center.y],
        inertia: mass.inertia,
    }
}

fn four_bar() -> Trio {
    let case = Case::read("crank-rocker");
    let hand = FourBar {
        bars: [1.0, 3.5, 3.0, 4.0],
        bodies: ["crank", "coupler", "rocker"].map(|name| body(&case.scene, name)),
    };
    Trio {
        name: "four-bar",
        one: case.model(&reactions(&case.scene, "C.x")),
        hand: every(move |q| hand.at(q)),
    }
}

fn slider_crank() -> Trio {
    let case = Case::read("slider-crank");
    let hand = SliderCrank {
        bars: [0.08, 0.28],
        offset: 0.025,
        bodies: ["crank", "rod"].map(|name| body(&case.scene, name)),
        piston: body(&case.scene, "piston").mass,
    };
    Trio {
        name: "slider-crank",
        one: case.model(&reactions(&case.scene, "guide.normal")),
        hand: every(move |q| hand.at(q)),
    }
}

/// Holds all three against each other: the batch against single evaluations to the last bit, both against the
/// hand to rounding.
fn agree(trio: &Trio, q: &[f64]) {
    let mut truth = vec![[0.0; 4]; q.len()];
    (trio.hand)(q, &mut truth);
    let mut batch = Batch::default();
    trio.one.reduce_all(q, &mut batch);
    let (mut work, mut out) = (trio.one.work(), trio.one.model().coefficients());
    let (mut largest, mut apart) = ([0.0_f64; 4], [0.0_f64; 4]);
    for (i, &q) in q.iter().enumerate() {
        let done = trio.one.coefficients(q, &mut work, &mut out);
        done.unwrap_or_else(|e| stop(trio.name, &e.to_string()));
        let one = [out.m, out.half_dm, out.a[0], out.b[0]];
        let all = [batch.m[i], batch.half_dm[i], batch.a[i], batch.b[i]];
        assert_eq!(one, all, "{} at {q}", trio.name);
        for k in 0..4 {
            largest[k] = largest[k].max(truth[i][k].abs());
            apart[k] = apart[k].max((one[k] - truth[i][k]).abs());
        }
    }
    for (name, k) in [("m", 0), ("m'/2", 1), ("a", 2), ("b", 3)] {
        let scaled = apart[k] / largest[k];
        assert!(
            scaled < 1e-12,
            "{}: {name} differs by {scaled:e} of its largest",
            trio.name
        );
    }
}
