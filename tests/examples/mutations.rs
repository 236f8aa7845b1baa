//! The mutation study: `cargo run --release --example mutations` writes `reports/mutations.png`, `.md` and `.txt`, and
//! fails if fewer than two checks detect a fault in an equation.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a study, run by hand"
)]

use dwell_tests::fixtures::repository_root;
use dwell_tests::mutations::{figure, report, source, study, tallies};
use std::process::ExitCode;

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let study = study::Study::new();
    let root = repository_root();
    let source =
        source::SourceFiles::read(&root, study.operation_results.iter().map(|s| s.operation));
    let functions = tallies::by_function(&study.operation_results, &source);
    let steps = tallies::by_step(&study.operation_results, &source);
    let png = dwell_report::png(&figure::figure(&study, &steps))?;
    let folder = root.join("reports");
    std::fs::create_dir_all(&folder)?;
    std::fs::write(folder.join("mutations.png"), png)?;
    std::fs::write(
        folder.join("mutations.txt"),
        report::text(&study, &functions),
    )?;
    std::fs::write(
        folder.join("mutations.md"),
        report::markdown(&study, &functions, &source),
    )?;
    println!("{}", report::summary(&study));
    let gaps = study.gaps();
    for gap in &gaps {
        println!("HOLE {gap}");
    }
    Ok(if gaps.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}
