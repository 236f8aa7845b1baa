//! Couplings by a table have no value beyond it: ranges, prescribed and free motions end there.

use crate::table::{Table, analyse, file, scene};
use dwell_study::{
    Analysis, MotionSolver, SolverSettings, StudyError, check, compute_free_motion, no_progress,
};

/// A cam whose table lifts its follower by a half-turn and lowers it by the other.
const CAM: &str = "[bodies.ground]\npoints = { O = [0, 0] }\n[bodies.cam]\npoints = { O = [0, 0] }\nmass = 1\ncenter = [0.1, 0]\ninertia = 0.1\n\
    [bodies.follower]\npoints = { S = [0, 0] }\nmass = 2\ncenter = [0, 0]\ninertia = 0.1\n[joints]\nO = { revolute = [\"ground.O\", \"cam.O\"] }\n\
    S = { prismatic = [\"ground.O\", \"follower.S\"], axis = [0, 1] }\n\
    cam = { coupling = [\"s\", \"phi\"], table = [[0, 0], [1, 0.1], [2, 0.2], [4, 0.1], [6, 0]] }\n\
    [coordinates]\ns = { travel = \"S\" }\n[actuators.phi]\nangle = [\"ground\", \"cam\"]\n[assembly]\nphi = 1\n[loads]\ng = { gravity = [0, -9.81] }\n";

fn message(error: Option<StudyError>) -> (String, Vec<String>) {
    let Some(StudyError::Scene(error)) = error else {
        panic!("no error: {error:?}");
    };
    let labels = error.labelled().into_iter();
    let labels = labels.map(|(text, _)| text.to_owned());
    (error.message.clone(), labels.collect())
}

#[test]
fn a_coupling_has_no_value_beyond_its_table() {
    let table = "table = [[0, 0], [1, 0.1], [2, 0.2], [4, 0.1], [6, 0]]";
    // A prescribed motion that passes the end keeps its rows up to there: phi = 1 + 2 t.
    let prescribed =
        format!("{CAM}[prescribed]\nduration = 4\npoints = 81\nphi = {{ speed = 2 }}\n");
    let result = analyse(&scene(&prescribed), Analysis::Kinetostatics, 81);
    let rows = Table::parse(&file(&result, "-kinetostatics.csv"));
    assert!((rows.column("phi").last().unwrap() - 6.0).abs() < 1e-12);
    let (said, labels) = message(result.early_stop);
    assert!(
        said.contains("table of coupling `cam` ends at phi = 6 rad"),
        "{said}"
    );
    assert!(labels.iter().any(|label| label == table), "{labels:?}");
    // The range of one actuator ends there, and a free motion.
    let checked = check(&scene(&prescribed)).unwrap().summary;
    let ends = "end of the table of `cam` at phi = ";
    let both = [0, 6].map(|end| checked.contains(&format!("{ends}{end} rad")));
    assert_eq!(both, [true; 2], "{checked}");
    let free = |motion: &str| {
        let scene = scene(&format!(
            "{CAM}[motion]\nduration = 9\ninitial-velocity = {motion}\n"
        ));
        let solver = MotionSolver::Settings(SolverSettings::default());
        compute_free_motion(&scene, &solver, &no_progress).unwrap()
    };
    let found = free("30");
    let (said, labels) = message(found.computed.early_stop);
    assert!(
        said.contains("end of the table of `cam` at phi = 6 rad"),
        "{said}"
    );
    assert!(labels.iter().any(|label| label == table), "{labels:?}");
    // Nor is there an assembly beyond.
    let beyond = scene(&CAM.replace("phi = 1\n", "phi = 6.1\n"));
    let (said, _) = message(check(&beyond).err());
    assert!(
        said.contains("table of coupling `cam` has no value at the start"),
        "{said}"
    );
}

#[test]
fn a_motion_of_two_coordinates_ends_where_the_table_of_a_coupling_does() {
    let arm = "[bodies.arm]\npoints = { O = [0, 0] }\nmass = 1\ncenter = [0.1, 0]\ninertia = 0.1\n";
    let two = CAM.replace(
        "[joints]\n",
        &format!("{arm}[joints]\nA = {{ revolute = [\"ground.O\", \"arm.O\"] }}\n"),
    );
    let two = two.replace(
        "[assembly]",
        "[actuators.psi]\nangle = [\"ground\", \"arm\"]\n[assembly]",
    );
    let two = format!("{two}[motion]\nduration = 9\ninitial-velocity = {{ phi = 30, psi = 1 }}\n");
    let solver = MotionSolver::Settings(SolverSettings::default());
    let found = compute_free_motion(&scene(&two), &solver, &no_progress).unwrap();
    let (said, labels) = message(found.computed.early_stop);
    assert!(
        said.contains("the table of coupling `cam` has no value"),
        "{said}"
    );
    assert!(
        labels
            .iter()
            .any(|label| label.starts_with("table = [[0, 0]")),
        "{labels:?}"
    );
}
