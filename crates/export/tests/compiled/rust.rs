//! The exported crate: compiled without the standard library, with the bits of its twin.

use super::c::{assert_same_bits, evaluated};
use super::machine::{bare, export, machine};
use super::toolchain::{Scratch, numbers, run};
use dwell_export::{Precision, rust_files};
use std::path::Path;

const PROGRAM: &str = r#"
use test_machine::*;
fn main() {
    for i in -200..=400 {
        let q = i as Real * 0.05;
        let (t, r, xy) = (motion_terms(q).unwrap(), reaction_terms(q).unwrap(), positions(q).unwrap());
        let mut line = vec![q, t.m, t.half_dm];
        line.extend(t.w.iter().chain(&r.a).chain(&r.b).chain(r.c.iter().flatten()).chain(&xy));
        line.push(t.v[0]);
        print(&line);
    }
    let (p, inputs, mut s) = scene();
    for i in 0..3000 {
        step(&p, &inputs, 0.005, &mut s).unwrap();
        let a = acceleration(&p, &inputs, &s).unwrap();
        if i % 100 == 0 {
            let mut line = vec![s.q, s.q_dot, s.periods as Real, a];
            line.extend(reactions(&p, &inputs, &s, a).unwrap());
            line.extend(energies(&p, &inputs, &s).unwrap());
            line.push(required_force(&p, &inputs, &s, a).unwrap());
            print(&line);
        }
    }
}
fn print(line: &[Real]) {
    let line: Vec<String> = line.iter().map(|n| format!("{:e}", *n as f64)).collect();
    println!("{}", line.join(" "));
}
"#;

/// Compiles the exported library with every warning an error.
pub(crate) fn compile_library(folder: &Path) {
    let source = "test_machine/src/lib.rs";
    run(
        folder,
        "rustc",
        &[
            "--edition",
            "2021",
            "-O",
            "-D",
            "warnings",
            "--crate-type",
            "rlib",
            source,
        ],
    );
}

#[test]
fn the_crate_is_its_twin_bit_for_bit() {
    for (inductance, precision) in [(0.0, Precision::Double), (0.02, Precision::Float)] {
        let export = export(machine(inductance), 1e-6, precision);
        let scratch = Scratch::new();
        scratch.write(&rust_files(&export).expect("cells"));
        scratch.write(&[("main.rs".to_owned(), PROGRAM.to_owned())]);
        compile_library(&scratch.0);
        run(
            &scratch.0,
            "rustc",
            &[
                "--edition",
                "2021",
                "-O",
                "main.rs",
                "--extern",
                "test_machine=liblib.rlib",
            ],
        );
        let found = numbers(&run(&scratch.0, "./main", &[]));
        match precision {
            Precision::Double => assert_same_bits(&found, &evaluated::<f64>(&export)),
            Precision::Float => assert_same_bits(&found, &evaluated::<f32>(&export)),
        }
    }
}

#[test]
fn its_own_test_passes() {
    for machine in [machine(0.02), bare()] {
        let export = export(machine, 1e-9, Precision::Double);
        let scratch = Scratch::new();
        scratch.write(&rust_files(&export).expect("cells"));
        let source = "test_machine/src/lib.rs";
        run(
            &scratch.0,
            "rustc",
            &[
                "--edition",
                "2021",
                "-O",
                "-D",
                "warnings",
                "--test",
                source,
                "-o",
                "tests",
            ],
        );
        run(&scratch.0, "./tests", &[]);
    }
}
