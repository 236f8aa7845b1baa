//! Columns by the names that they had before they were renamed.

use crate::table::{Table, WEIGHTS, analyse, file, scene};
use dwell_study::Analysis;

fn run(variables: &str) -> (Table, String) {
    let requests = format!("[requests]\nvariables = [{variables}]");
    let scene = scene(&WEIGHTS.replace("[requests]", &requests));
    let result = analyse(&scene, Analysis::Kinetostatics, 5);
    let table = Table::parse(&file(&result, "-kinetostatics.csv"));
    (table, result.outcome.summary)
}

#[test]
fn former_names_give_the_same_columns_and_a_note() {
    let former = r#""phi.speed", "crank.speed", "rocker.advantage", "rocker.pole", "frame", "balance.dE/dt""#;
    let current = r#""phi.velocity", "crank.angular_velocity", "rocker.mechanical_advantage", "rocker.velocity_pole", "shaking", "power.kinetic""#;
    let ((by_former, notes), (by_current, silence)) = (run(former), run(current));
    assert_eq!(by_former.names, by_current.names);
    assert!(
        notes.contains("note: `phi.speed` is now called `phi.velocity`\n"),
        "{notes}"
    );
    assert_eq!(notes.matches("is now called").count(), 6, "{notes}");
    assert!(!silence.contains("is now called"), "{silence}");
}
