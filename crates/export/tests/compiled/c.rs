//! The exported C: without a warning, without undefined behaviour, with the values of the closed forms.

use super::machine::{self, bare, export, machine};
use super::toolchain::{
    SANITIZE, Scratch, c_compilers, compile, numbers, run, sanitizing_compilers,
};
use dwell_export::{Evaluator, Export, Precision, c_files};

/// Prints the terms, and a motion with its reactions, energies and inverse dynamics.
pub(crate) const PROGRAM: &str = r#"
#include "test_machine.h"
#include <stdio.h>
int main(void)
{
    int i, k;
    test_machine_parameters p;
    test_machine_inputs in;
    test_machine_state s;
    test_machine_motion_terms t;
    test_machine_reaction_terms r;
    test_machine_real xy[2], out[3], e[2], a, f;
    for (i = -200; i <= 400; i++) {
        const test_machine_real q = (test_machine_real)i * (test_machine_real)0.05;
        if (test_machine_coefficients(q, &t, &r) != 0 || test_machine_positions(q, xy) != 0) {
            return 1;
        }
        printf("%.17g %.17g %.17g", (double)q, (double)t.m, (double)t.half_dm);
        for (k = 0; k < 5; k++) { printf(" %.17g", (double)t.w[k]); }
        for (k = 0; k < 3; k++) { printf(" %.17g", (double)r.a[k]); }
        for (k = 0; k < 3; k++) { printf(" %.17g", (double)r.b[k]); }
        for (k = 0; k < 15; k++) { printf(" %.17g", (double)r.c[k]); }
        printf(" %.17g %.17g %.17g\n", (double)xy[0], (double)xy[1], (double)t.v[0]);
    }
    test_machine_scene(&p, &in, &s);
    for (i = 0; i < 3000; i++) {
        if (test_machine_step(&p, &in, (test_machine_real)0.005, &s) != 0) { return 2; }
        if (test_machine_acceleration(&p, &in, &s, &a) != 0) { return 3; }
        if (test_machine_reactions(&p, &in, &s, a, out) != 0) { return 4; }
        if (test_machine_energies(&p, &in, &s, e) != 0) { return 5; }
        if (test_machine_required_force(&p, &in, &s, a, &f) != 0) { return 6; }
        if (i % 100 == 0) {
            printf("%.17g %.17g %d %.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", (double)s.q, (double)s.q_dot, (int)s.periods,
                   (double)a, (double)out[0], (double)out[1], (double)out[2], (double)e[0], (double)e[1], (double)f);
        }
    }
    return 0;
}
"#;

/// The output of the compiled program.
fn printed(export: &Export, compiler: &str, extra: &[&str]) -> Vec<Vec<f64>> {
    let scratch = Scratch::new();
    scratch.write(&c_files(export));
    scratch.write(&[("main.c".to_owned(), PROGRAM.to_owned())]);
    compile(&scratch.0, compiler, extra, &["test_machine.c", "main.c"]);
    numbers(&run(&scratch.0, "./program", &[]))
}

/// The output by the evaluator in Rust, in its own number type.
pub(crate) fn evaluated<R: dwell_numerics::Real>(export: &Export) -> Vec<Vec<f64>> {
    let twin = Evaluator::<R>::new(&export.machine, &export.parts, export.request.precision);
    let mut lines = Vec::new();
    for i in -200..=400 {
        let q = R::of(f64::from(i)) * R::of(0.05);
        let (t, r) = (
            twin.motion_terms(q).unwrap(),
            twin.reaction_terms(q).unwrap(),
        );
        let xy = twin.positions(q).unwrap();
        let first = [q, t.m, t.half_dm].into_iter();
        let rest = [t.w, r.a, r.b, r.c, xy].into_iter().flatten();
        let all = first.chain(rest).chain([t.v[0]]);
        lines.push(all.map(|n| n.to_f64()).collect());
    }
    let mut state = twin.state(export.machine.initial);
    for i in 0..3000 {
        twin.step(R::of(0.005), &mut state).unwrap();
        let a = twin.rates(&state.y).unwrap()[1];
        if i % 100 == 0 {
            let periods = R::of(f64::from(state.periods));
            let mut line = vec![state.y[0], state.y[1], periods, a];
            line.extend(twin.reactions(&state.y, a).unwrap());
            line.extend(twin.energies(&state.y).unwrap());
            line.push(twin.required_force(&state.y, a).unwrap());
            lines.push(line.iter().map(|n| n.to_f64()).collect());
        }
    }
    lines
}

/// The compiler's code and its Rust twin are the same operations in the same order: the same bits.
#[test]
fn c_is_its_twin_bit_for_bit() {
    for compiler in c_compilers() {
        for inductance in [0.0, 0.02] {
            let double = export(machine(inductance), 1e-9, Precision::Double);
            assert_same_bits(&printed(&double, compiler, &[]), &evaluated::<f64>(&double));
            let float = export(machine(inductance), 1e-6, Precision::Float);
            assert_same_bits(&printed(&float, compiler, &[]), &evaluated::<f32>(&float));
        }
    }
}

pub(crate) fn assert_same_bits(found: &[Vec<f64>], expected: &[Vec<f64>]) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(found.len(), expected.len());
        for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
            // Zero has two signs.
            assert!(found == expected, "number {k}: {found:e} {expected:e}");
        }
    }
}

/// The same numbers within a part of one plus their size.
pub(crate) fn assert_close(found: &[Vec<f64>], expected: &[Vec<f64>], allowed: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert_eq!(found.len(), expected.len());
        for (k, (found, expected)) in found.iter().zip(expected).enumerate() {
            let difference = (found - expected).abs();
            assert!(
                difference <= allowed * (1.0 + expected.abs()),
                "number {k}: {found} {expected}"
            );
        }
    }
}

/// Every function is within the accuracy asked for of its closed form, over several revolutions.
#[test]
fn functions_are_within_their_accuracy() {
    for accuracy in [1e-6, 1e-9, 1e-12] {
        let export = export(machine(0.0), accuracy, Precision::Double);
        assert!(
            export.measured.errors.max() <= accuracy,
            "{:?}",
            export.measured.errors
        );
        // Rounding of q: its last digit is up to 4e-15 at 20 rad.
        let allowed = |scale: f64| (accuracy + 1e-13) * scale;
        for line in evaluated::<f64>(&export).iter().take(601) {
            let q = line[0];
            let [m, half_dm] = machine::inertia(q);
            let [v, half_dv] = machine::potential(q);
            let mut exact = vec![q, m, half_dm, -2.0 * half_dv];
            exact.extend((1..5).map(|load| machine::w(load, q)));
            exact.extend((0..3).map(|k| machine::a(k, q)));
            exact.extend((0..3).map(|k| machine::b(k, q)));
            exact.extend((0..5).flat_map(|load| (0..3).map(move |k| machine::c(load, k, q))));
            exact.extend([machine::position(0, q), machine::position(1, q), v]);
            for (k, (found, exact)) in line.iter().zip(&exact).enumerate() {
                assert!(
                    (found - exact).abs() <= allowed(1.5),
                    "number {k} at {q}: {found} {exact}"
                );
            }
        }
    }
}

/// Undefined behaviour, addresses and the self-test; and the bare machine, whose loads, reactions and points are none.
#[test]
fn the_self_test_passes_under_sanitizers() {
    for compiler in sanitizing_compilers() {
        for (machine, precision) in [
            (machine(0.0), Precision::Double),
            (machine(0.02), Precision::Float),
            (bare(), Precision::Double),
            (bare(), Precision::Float),
        ] {
            let export = export(machine, 1e-6, precision);
            let scratch = Scratch::new();
            scratch.write(&c_files(&export));
            let mut extra = vec!["-DTEST_MACHINE_SELF_TEST"];
            extra.extend(SANITIZE);
            compile(&scratch.0, compiler, &extra, &["test_machine.c"]);
            run(&scratch.0, "./program", &[]);
        }
    }
}

/// A changed constant is found by the self-test: any coefficient of any cell it visits.
#[test]
fn the_self_test_finds_a_wrong_constant() {
    for compiler in c_compilers() {
        let export = export(bare(), 1e-9, Precision::Double);
        let mut wrong = export.clone();
        let stride = wrong.parts[0].stride();
        for cell in wrong.parts[0].cells.chunks_exact_mut(stride) {
            // ½m′ at the middle, by a millionth.
            cell[4] += 1e-6;
        }
        let scratch = Scratch::new();
        scratch.write(&c_files(&wrong));
        compile(
            &scratch.0,
            compiler,
            &["-DTEST_MACHINE_SELF_TEST"],
            &["test_machine.c"],
        );
        let status = std::process::Command::new(scratch.0.join("program"))
            .status()
            .unwrap();
        assert_eq!(status.code(), Some(10), "the number of m, its integral");
    }
}

/// Invalid coordinates give a status and zeros, and the state is not changed.
#[test]
fn bad_numbers_give_a_status() {
    let program = r#"
#include "test_machine.h"
int main(void)
{
    test_machine_parameters p;
    test_machine_inputs in;
    test_machine_state s, before;
    test_machine_motion_terms t;
    test_machine_real zero = 0, a = 7, out[3], e[2], f = 7;
    const test_machine_real nan = zero / zero, inf = 1 / zero;
    if (test_machine_motion_terms_at(nan, &t) != TEST_MACHINE_NOT_FINITE || t.m != 0 || t.w[4] != 0) { return 1; }
    if (test_machine_motion_terms_at(-inf, &t) != TEST_MACHINE_NOT_FINITE) { return 2; }
    if (test_machine_motion_terms_at(1e30, &t) != TEST_MACHINE_OUT_OF_RANGE) { return 3; }
    test_machine_scene(&p, &in, &s);
    before = s;
    in.load_brake = nan;
    if (test_machine_acceleration(&p, &in, &s, &a) != TEST_MACHINE_NOT_FINITE || a != 0) { return 4; }
    if (test_machine_step(&p, &in, 1, &s) != TEST_MACHINE_NOT_FINITE || s.q != before.q || s.q_dot != before.q_dot) { return 5; }
    if (test_machine_reactions(&p, &in, &s, nan, out) != TEST_MACHINE_NOT_FINITE || out[1] != 0) { return 6; }
    if (test_machine_required_force(&p, &in, &s, 1, &f) != TEST_MACHINE_NOT_FINITE || f != 0) { return 7; }
    test_machine_scene(&p, &in, &s);
    s.q_dot = inf;
    if (test_machine_energies(&p, &in, &s, e) != TEST_MACHINE_NOT_FINITE || e[0] != 0) { return 8; }
    test_machine_scene(&p, &in, &s);
    p.added_inertia = -100;
    if (test_machine_step(&p, &in, 1, &s) != TEST_MACHINE_NO_INERTIA) { return 9; }
    test_machine_scene(&p, &in, &s);
    if (test_machine_step(&p, &in, nan, &s) != TEST_MACHINE_NOT_FINITE) { return 10; }
    return 0;
}
"#;
    for compiler in sanitizing_compilers() {
        let export = export(machine(0.0), 1e-6, Precision::Double);
        let scratch = Scratch::new();
        scratch.write(&c_files(&export));
        scratch.write(&[("main.c".to_owned(), program.to_owned())]);
        let extra = [SANITIZE[0], SANITIZE[1], "-Wno-div-by-zero"];
        compile(&scratch.0, compiler, &extra, &["test_machine.c", "main.c"]);
        run(&scratch.0, "./program", &[]);
    }
}
