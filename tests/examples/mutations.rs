//! The mutation study: `cargo run --release --example mutations` writes `reports/mutations.png`, `.md` and `.txt`, the same of
//! mechanisms in space to `mutations-space`, and fails if fewer than two checks detect a fault in an equation. `-- space` runs that part alone.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a study, run by hand"
)]

use dwell_tests::fixtures::repository_root;
use dwell_tests::mutations::{figure, report, source, space, study, tallies};
use std::process::ExitCode;

/// The step of an evaluation that a function of a file belongs to.
type StepOf = fn(&str, &str) -> Option<(usize, &'static str)>;

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let only_space = std::env::args().nth(1).is_some_and(|part| part == "space");
    let mut complete = true;
    if !only_space {
        complete &= write(&study::Study::new(), tallies::evaluation_step)?;
    }
    let in_space = space::study::run(&space::study::scenes());
    complete &= write(&in_space, space::steps::evaluation_step)?;
    Ok(if complete {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}

/// Writes a study; false where it has gaps.
fn write(study: &study::Study, step_of: StepOf) -> Result<bool, Box<dyn std::error::Error>> {
    let root = repository_root();
    let source =
        source::SourceFiles::read(&root, study.operation_results.iter().map(|s| s.operation));
    let functions = tallies::by_function(&study.operation_results, &source);
    let steps = tallies::by_step(&study.operation_results, &source, step_of);
    let png = dwell_report::png(&figure::figure(study, &steps))?;
    let folder = root.join("reports");
    std::fs::create_dir_all(&folder)?;
    let path = |ending: &str| folder.join(format!("{}.{ending}", study.name));
    std::fs::write(path("png"), png)?;
    std::fs::write(path("txt"), report::text(study, &functions))?;
    std::fs::write(path("md"), report::markdown(study, &functions, &source))?;
    println!("{}", report::summary(study));
    let gaps = study.gaps();
    for gap in &gaps {
        println!("HOLE {gap}");
    }
    Ok(gaps.is_empty())
}
