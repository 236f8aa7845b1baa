//! Times of exported C and of the table in Rust, one after the other in one run, as ratios: `cargo bench -p dwell-study --bench
//! export`. Nothing is asserted.
#![allow(clippy::unwrap_used, clippy::panic, reason = "a benchmark")]

use dwell_export::{Precision, Request, c_files};
use dwell_kinetostatics::{ReducedModel, TableDomain, TabulatedModel};
use dwell_scene::PlaneScene;
use dwell_study::{ExportRequest, PreparedScene, compute_export};
use std::hint::black_box;
use std::path::Path;
use std::process::Command;
use std::time::Instant;

const CALLS: usize = 2_000_000;
const ROUNDS: usize = 7;

/// Times of one call of the coefficients and of one step, ns.
const PROGRAM: &str = r#"
#include "single_dwell.h"
#include <stdio.h>
#include <time.h>
int main(void)
{
    single_dwell_parameters p;
    single_dwell_inputs in;
    single_dwell_state s;
    single_dwell_motion_terms t;
    single_dwell_reaction_terms r;
    double q = 0.1, sum = 0;
    clock_t begin;
    int i;
    begin = clock();
    for (i = 0; i < CALLS; i++) {
        if (single_dwell_coefficients((single_dwell_real)q, &t, &r) != 0) { return 1; }
        sum += (double)(t.m + t.half_dm + r.a[0] + r.b[0]);
        q += 0.7;
        if (q > 6) { q -= 6; }
    }
    printf("%g ", (double)(clock() - begin) / CLOCKS_PER_SEC / CALLS * 1e9);
    single_dwell_scene(&p, &in, &s);
    begin = clock();
    for (i = 0; i < CALLS; i++) {
        if (single_dwell_step(&p, &in, (single_dwell_real)1e-3, &s) != 0) { return 2; }
    }
    printf("%g %g\n", (double)(clock() - begin) / CLOCKS_PER_SEC / CALLS * 1e9, sum);
    return 0;
}
"#;

fn main() {
    let home =
        Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation/single-dwell/scene.toml");
    let text = std::fs::read_to_string(home).unwrap();
    let scene = PlaneScene::parse("single-dwell.toml", &text).unwrap();
    let prepared = PreparedScene::new(&scene).unwrap();
    for (name, accuracy, precision) in [
        ("double, 1e-9", 1e-9, Precision::Double),
        ("float, 1e-6", 1e-6, Precision::Float),
    ] {
        let table = TabulatedModel::new(&prepared.model, accuracy, TableDomain::Full).unwrap();
        let request = Request {
            accuracy,
            precision,
        };
        let asked = ExportRequest {
            exact: false,
            request,
            interval: None,
        };
        let export = compute_export(&scene, &asked).unwrap();
        let folder =
            std::env::temp_dir().join(format!("dwell-bench-export-{}", std::process::id()));
        std::fs::create_dir_all(&folder).unwrap();
        for (path, text) in c_files(&export) {
            std::fs::write(folder.join(path), text).unwrap();
        }
        std::fs::write(folder.join("main.c"), PROGRAM).unwrap();
        let define = format!("-DCALLS={CALLS}");
        let status = Command::new("cc")
            .args([
                "-std=c99",
                "-O2",
                &define,
                "single_dwell.c",
                "main.c",
                "-o",
                "program",
            ])
            .current_dir(&folder)
            .status();
        if !status.is_ok_and(|status| status.success()) {
            println!("no C compiler: nothing is compared");
            return;
        }
        let least = times(&table, &folder);
        std::fs::remove_dir_all(&folder).unwrap();
        let [rust, c, step] = least;
        println!(
            "{name}: coefficients {:.2} times the table in Rust, a step {:.1} times its own coefficients ({rust:.0}, {c:.0}, {step:.0} ns)",
            c / rust,
            step / c
        );
    }
}

/// The least times of a call in Rust, a call in C and a step, ns.
fn times(table: &TabulatedModel, folder: &Path) -> [f64; 3] {
    let mut least = [f64::INFINITY; 3];
    for _ in 0..ROUNDS {
        least[0] = least[0].min(time_of(table));
        let output = Command::new(folder.join("program")).output().unwrap();
        let text = String::from_utf8(output.stdout).unwrap();
        let times: Vec<f64> = text
            .split_whitespace()
            .map(|n| n.parse().unwrap())
            .collect();
        least[1] = least[1].min(times[0]);
        least[2] = least[2].min(times[1]);
    }
    least
}

/// One call of the table's coefficients, ns.
fn time_of(table: &TabulatedModel) -> f64 {
    let mut out = dwell_kinetostatics::Coefficients {
        a: vec![0.0],
        b: vec![0.0],
        ..Default::default()
    };
    let (mut q, mut sum) = (0.1, 0.0);
    let begin = Instant::now();
    for _ in 0..CALLS {
        table.coefficients(black_box(q), &mut (), &mut out).unwrap();
        sum += out.m + out.half_dm + out.a[0] + out.b[0];
        q += 0.7;
        if q > 6.0 {
            q -= 6.0;
        }
    }
    black_box(sum);
    begin.elapsed().as_secs_f64() / CALLS as f64 * 1e9
}
