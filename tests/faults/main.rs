//! The fault study: deliberate faults, each a wrapper around what is judged, and the independent truths
//! that catch them. `cargo run --release --example faults` writes `reports/faults.png`,
//! `.md` and `.txt`, and fails if a fault in an equation is caught by fewer than two truths.
//!
//! ```text
//! watched      a number that knows the product's line it is in, and slips there
//! operations   every operation of every step slips        ┐
//! reduced      named faults of the reduced model          │  each judged by
//! claims       named faults of states under loads         │  the truths
//! motions      named faults of the equation of motion     ┘
//! ```
//!
//! To add a named fault: a variant, its place in `ALL`, its words and what it does, in one of the last
//! three. A new line of a step needs nothing: its operations are found by evaluating it.
#![allow(
    clippy::expect_used,
    clippy::panic,
    clippy::print_stdout,
    reason = "a study, run by hand"
)]

mod claims;
mod machine;
mod motions;
mod operations;
mod picture;
mod plain;
mod published;
mod reduced;
mod source;
mod standing;
mod steps;
mod study;
mod text;
mod verdict;
mod watched;
mod wrench;

use std::process::ExitCode;

fn main() -> Result<ExitCode, Box<dyn std::error::Error>> {
    let study = study::Study::new();
    let home = study::home();
    let source = source::Source::read(&home, study.slips.iter().map(|s| s.place));
    let functions = steps::by_function(&study.slips, &source);
    let steps = steps::by_step(&study.slips, &source);
    let png = dwell_report::png(&picture::picture(&study, &steps))?;
    let folder = home.join("reports");
    std::fs::create_dir_all(&folder)?;
    std::fs::write(folder.join("faults.png"), png)?;
    std::fs::write(folder.join("faults.txt"), text::text(&study, &functions))?;
    std::fs::write(
        folder.join("faults.md"),
        text::page(&study, &functions, &source),
    )?;
    println!("{}", text::summary(&study));
    let holes = study.holes();
    for hole in &holes {
        println!("HOLE {hole}");
    }
    Ok(if holes.is_empty() {
        ExitCode::SUCCESS
    } else {
        ExitCode::FAILURE
    })
}
