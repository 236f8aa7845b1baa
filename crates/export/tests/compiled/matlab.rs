//! The functions of MATLAB, run by Octave where it is installed.

use super::c::{assert_close, evaluated};
use super::machine::{export, machine};
use super::toolchain::{Scratch, numbers, run};
use dwell_export::{Precision, matlab_files};

const PROGRAM: &str = "
q = (-200:400)' * 0.05;
out = test_machine(q);
all = [q out.m out.half_dm out.w out.a out.b reshape(out.c, numel(q), []) out.xy out.v(:,1)];
for k = 1:rows(all)
  printf('%.17g ', all(k,:));
  printf('\\n');
end
dy = test_machine_rates(0, [0.3; 1.0]);
printf('%.17g ', dy);
printf('\\n');
";

#[test]
fn octave_has_the_same_values() {
    let there = std::process::Command::new("octave-cli")
        .arg("--version")
        .output();
    if there.is_err() {
        eprintln!("skipped: octave-cli is not installed");
        return;
    }
    let export = export(machine(0.0), 1e-9, Precision::Double);
    let scratch = Scratch::new();
    for (path, bytes) in matlab_files(&export).expect("cells") {
        std::fs::write(scratch.0.join(path), bytes).unwrap();
    }
    std::fs::write(scratch.0.join("program.m"), PROGRAM).unwrap();
    let text = run(
        &scratch.0,
        "octave-cli",
        &["--norc", "--quiet", "program.m"],
    );
    let lines = numbers(&text);
    let (rows, rates) = lines.split_at(601);
    // Horner's scheme rounds otherwise than Estrin's, and revolutions are subtracted in one part.
    assert_close(rows, &evaluated::<f64>(&export)[..601], 1e-12);
    let twin =
        dwell_export::Evaluator::<f64>::new(&export.machine, &export.parts, Precision::Double);
    let exact = twin.rates(&[0.3, 1.0]).unwrap();
    assert_close(rates, &[exact], 1e-8);
}
