//! The sources of FMUs: compiled without a warning into libraries with every function of the standard.

use super::machine::{bare, export, machine};
use super::toolchain::{FLAGS, Scratch, c_compilers, run};
use dwell_export::{FmiVersion, Precision, fmu_files};

/// Functions of the interfaces: FMI 2.0.3 with both kinds, and FMI 3.0 with all three.
const FUNCTIONS: [(FmiVersion, &str, usize); 2] = [
    (FmiVersion::Two, " T fmi2", 44),
    (FmiVersion::Three, " T fmi3", 75),
];

#[test]
fn the_libraries_have_every_function() {
    for compiler in c_compilers() {
        for machine in [machine(0.02), bare()] {
            for (version, symbol, functions) in FUNCTIONS {
                let export = export(machine.clone(), 1e-9, Precision::Double);
                let files = fmu_files(&export, version, "");
                let scratch = Scratch::new();
                scratch.write(&files.texts);
                let sources: Vec<String> = files
                    .sources
                    .iter()
                    .map(|name| format!("sources/{name}"))
                    .collect();
                let mut arguments = FLAGS.to_vec();
                arguments.extend([
                    "-fPIC",
                    "-shared",
                    "-fvisibility=hidden",
                    "-o",
                    "library.so",
                ]);
                arguments.extend(sources.iter().map(String::as_str));
                run(&scratch.0, compiler, &arguments);
                if std::process::Command::new("nm")
                    .arg("--version")
                    .output()
                    .is_ok()
                {
                    let text = run(&scratch.0, "nm", &["-D", "library.so"]);
                    let found = text.lines().filter(|line| line.contains(symbol)).count();
                    assert_eq!(found, functions, "{text}");
                }
            }
        }
    }
}
