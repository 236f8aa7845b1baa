//! Titles and names that try to leave their comment or to be a word of the language.

use super::machine::{export, machine};
use super::toolchain::{Scratch, c_compilers, compile, run};
use dwell_export::{Precision, c_files, rust_files};

#[test]
fn hostile_names_compile() {
    let mut machine = machine(0.02);
    machine.title = "*/ int main(void) { /* ??/\n*??/\r */ \\\n#error \u{202e}".to_owned();
    machine.coordinate = "φ */".to_owned();
    let names = ["int", "INT", "a.b", "a_b", "*/"];
    for (load, name) in machine.loads.iter_mut().zip(names) {
        load.name = name.to_owned();
    }
    machine.reactions[0].0 = "while".to_owned();
    machine.reactions[1].0 = "1′ 2″".to_owned();
    machine.left_out.push("*/ x".to_owned());
    let export = export(machine, 1e-6, Precision::Double);
    for compiler in c_compilers() {
        let scratch = Scratch::new();
        scratch.write(&c_files(&export));
        compile(
            &scratch.0,
            compiler,
            &["-DTEST_MACHINE_SELF_TEST"],
            &["test_machine.c"],
        );
        run(&scratch.0, "./program", &[]);
    }
    let scratch = Scratch::new();
    scratch.write(&rust_files(&export).expect("cells"));
    super::rust::compile_library(&scratch.0);
}

/// Numbers that single precision does not have are refused, and named.
#[test]
fn what_is_too_large_for_floats_is_refused() {
    let mut machine = machine(0.0);
    machine.loads[3].effect = dwell_export::LoadEffect::Input { initial: 1e300 };
    let request = dwell_export::Request {
        accuracy: 1e-5,
        precision: Precision::Float,
    };
    let mut sampler = super::machine::ClosedForms(machine.clone());
    let error = dwell_export::Export::new(machine, request, &mut sampler).unwrap_err();
    assert!(error.to_string().contains("brake"), "{error}");
}
