//! The single-dwell mechanism as a controls engineer takes it: one file, its size, its period and its reaction.

use super::toolchain::{Scratch, c_compiler, case, cases, compile, numbers, request, run};
use dwell_export::{Evaluator, Precision, State, c_files};
use dwell_kinetostatics::ReducedModel;
use dwell_scene::PlaneScene;
use dwell_study::{PreparedScene, compute_export};
use std::f64::consts::TAU;

/// The period of the free motion: by quadrature on the exact model, and by the independent program of the case.
const PERIOD: f64 = 5.419_662_677_06;

const PROGRAM: &str = r#"
#include "single_dwell.h"
#include <stdio.h>
int main(void)
{
    int i, before;
    single_dwell_parameters p;
    single_dwell_inputs in;
    single_dwell_state s;
    single_dwell_motion_terms t;
    single_dwell_reaction_terms r;
    for (i = 0; i <= 720; i++) {
        const double q = 0.5 * i * 3.14159265358979323846 / 180;
        if (single_dwell_coefficients(q, &t, &r) != 0) { return 1; }
        printf("%.17g %.17g %.17g %.17g %.17g\n", q, t.m, t.half_dm, r.a[0], r.b[0]);
    }
    single_dwell_scene(&p, &in, &s);
    for (i = 0; s.periods < 1; i++) {
        const double q = single_dwell_whole_coordinate(&s), q_dot = s.q_dot;
        before = i;
        if (single_dwell_step(&p, &in, 1e-3, &s) != 0) { return 2; }
        if (s.periods == 1) {
            printf("%.17g %.17g %.17g %.17g %.17g\n", before * 1e-3, q, q_dot, single_dwell_whole_coordinate(&s), s.q_dot);
        }
    }
    return 0;
}
"#;

/// The time at which Hermite's cubic over a step of 1 ms passes a value.
fn passage(line: &[f64], value: f64) -> f64 {
    let [t, q0, v0, q1, v1] = line[..] else {
        panic!("five numbers")
    };
    let h = 1e-3;
    let at = |x: f64| {
        let (one, x2, x3) = (1.0 - x, x * x, x * x * x);
        q0 * (1.0 - 3.0 * x2 + 2.0 * x3)
            + q1 * (3.0 * x2 - 2.0 * x3)
            + h * x * one * (v0 * one - v1 * x)
    };
    let (mut low, mut high) = (0.0, 1.0);
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if at(middle) < value {
            low = middle;
        } else {
            high = middle;
        }
    }
    t + h * low
}

#[test]
fn the_c_has_the_exact_coefficients_and_the_period() {
    let Some(compiler) = c_compiler() else { return };
    let scene = case("single-dwell");
    let export = compute_export(&scene, &request(1e-9, Precision::Double)).unwrap();
    let scratch = Scratch::new();
    scratch.write(&c_files(&export));
    scratch.write(&[("main.c".to_owned(), PROGRAM.to_owned())]);
    compile(
        &scratch.0,
        compiler,
        &["single_dwell.c", "main.c", "-o", "program"],
    );
    let lines = numbers(&run(&scratch.0, "./program", &[]));
    let prepared = PreparedScene::new(&scene).unwrap();
    let mut workspace = prepared.model.workspace();
    let mut exact = prepared.model.model().coefficient_buffer();
    let (rows, event) = lines.split_at(721);
    let mut largest = [0.0_f64; 4];
    let mut errors = [0.0_f64; 4];
    for row in rows {
        prepared
            .model
            .coefficients(row[0], &mut workspace, &mut exact)
            .unwrap();
        let exact = [exact.m, exact.half_dm, exact.a[0], exact.b[0]];
        for k in 0..4 {
            largest[k] = largest[k].max(exact[k].abs());
            errors[k] = errors[k].max((row[k + 1] - exact[k]).abs());
        }
    }
    for (error, largest) in errors.iter().zip(largest) {
        assert!(*error <= 1e-9 * largest, "{errors:?} {largest}");
    }
    let period = passage(&event[0], TAU);
    assert!((period - PERIOD).abs() < 1e-10, "{period}");
}

/// Code and constants of motion and reaction, without positions and the self-test: 10 kB at 1e-9 in double, 4 kB at 1e-6 in single precision.
#[test]
fn the_code_is_small() {
    let Some(compiler) = c_compiler() else { return };
    if std::process::Command::new("size")
        .arg("--version")
        .output()
        .is_err()
    {
        eprintln!("skipped: no `size`");
        return;
    }
    let path = cases().join("single-dwell/scene.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let lines = text.lines().filter(|line| !line.starts_with("paths = "));
    let text: Vec<&str> = lines.collect();
    let scene = PlaneScene::parse("single-dwell.toml", &text.join("\n")).unwrap();
    for (accuracy, precision, limit) in [
        (1e-9, Precision::Double, 10_000.0),
        (1e-6, Precision::Float, 4_000.0),
    ] {
        let export = compute_export(&scene, &request(accuracy, precision)).unwrap();
        let scratch = Scratch::new();
        scratch.write(&c_files(&export));
        // For size, as firmware is compiled.
        compile(
            &scratch.0,
            compiler,
            &[
                "-Os",
                "-fno-asynchronous-unwind-tables",
                "-c",
                "single_dwell.c",
            ],
        );
        let text = run(&scratch.0, "size", &["single_dwell.o"]);
        let size: f64 = text
            .lines()
            .nth(1)
            .unwrap()
            .split_whitespace()
            .next()
            .unwrap()
            .parse()
            .unwrap();
        let cells = export.parts.each_ref().map(|part| part.cell_count());
        eprintln!(
            "{accuracy:e} {cells:?} cells, {precision:?}: {size} bytes, {} of them constants",
            export.constant_bytes()
        );
        assert!(size < limit, "{size}");
        assert!(
            export.measured.errors.max()
                <= if precision == Precision::Float {
                    5e-6
                } else {
                    accuracy
                }
        );
    }
}

/// A million steps in single precision keep the energy to 1e-6.
#[test]
fn a_million_float_steps_keep_the_energy() {
    let scene = case("single-dwell");
    let export = compute_export(&scene, &request(1e-6, Precision::Float)).unwrap();
    let twin = Evaluator::<f32>::new(&export.machine, &export.parts, Precision::Float);
    let judge = Evaluator::<f64>::new(&export.machine, &export.parts, Precision::Float);
    let energy = |state: &State<f32>| {
        let both = state.y.iter().zip(&state.carry);
        let y: Vec<f64> = both.map(|(&y, &c)| f64::from(y) - f64::from(c)).collect();
        judge.energies(&y).unwrap()[0]
    };
    let mut state = twin.state(export.machine.initial);
    let before = energy(&state);
    for _ in 0..1_000_000 {
        twin.step(1e-3, &mut state).unwrap();
    }
    let drift = energy(&state) / before - 1.0;
    assert!(state.periods > 180 && drift.abs() < 1e-6, "{drift:e}");
}
