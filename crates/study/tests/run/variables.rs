//! A name in `variables` is right for every analysis or for none.

use crate::table::{PENDULUM, case, scene};
use dwell_scene::PlaneScene;
use dwell_study::{
    Analysis, OperatingPoint, SolverSettings, StudyError, analyse_trajectory, check,
    compute_closed_form, compute_cycle, compute_equilibria, compute_linearisation,
    compute_reduction, compute_sweep, find_value, no_progress, simulate,
};

/// A pendulum whose pin has a motor, with all that any analysis needs, which requests one variable.
fn requesting(variable: &str) -> PlaneScene {
    scene(&format!(
        "{PENDULUM}[drives]\nmotor = {{ motor = \"phi\", voltage = 24, torque-constant = 0.5, \
         resistance = 1.2, inductance = 0.002 }}\n[motion]\nduration = 0.1\n\
         [coordinate-sweep]\nphi = [0, 1]\n[requests]\nvariables = [\"{variable}\"]\n"
    ))
}

/// The error of each analysis of a scene, without its result.
fn analyses(scene: &PlaneScene) -> Vec<(&'static str, Result<(), StudyError>)> {
    let trajectory = |analysis| analyse_trajectory(scene, analysis, None, &no_progress).map(drop);
    let settings = SolverSettings::default();
    let vary = ["bar.mass=1,2".to_owned()];
    let start = OperatingPoint::InitialState;
    vec![
        ("check", check(scene).map(drop)),
        ("kinematics", trajectory(Analysis::Kinematics)),
        ("statics", trajectory(Analysis::Statics)),
        (
            "simulate",
            simulate(scene, &settings, &no_progress).map(drop),
        ),
        ("reduce", compute_reduction(scene, Some(5)).map(drop)),
        ("cycle", compute_cycle(scene, &settings, None).map(drop)),
        ("equilibria", compute_equilibria(scene).map(drop)),
        ("linearise", compute_linearisation(scene, start).map(drop)),
        ("symbolic", compute_closed_form(scene, None).map(drop)),
        (
            "sweep",
            compute_sweep(scene, &vary, None, 0, &[], &no_progress).map(drop),
        ),
        ("calibrate", find_value(scene, "bar.mass", 1.0).map(drop)),
    ]
}

#[test]
fn a_misspelt_variable_is_an_error_of_every_analysis() {
    let mut messages = Vec::new();
    for (command, found) in analyses(&requesting("bar.angel")) {
        let Err(StudyError::Scene(error)) = found else {
            panic!("{command}: {found:?}");
        };
        let error = &error.errors()[0];
        messages.push((command, error.message.clone(), error.help.clone()));
    }
    for (command, message, help) in &messages {
        assert_eq!(message, "there is no column `bar.angel`", "{command}");
        assert!(
            help.as_ref().unwrap().contains("bar.angle"),
            "{command}: {help:?}"
        );
    }
}

/// The columns of a drive and the energies of a motion belong to `simulate` alone, and are no mistake elsewhere.
#[test]
fn a_variable_of_another_analysis_is_no_error() {
    for variable in [
        "bar.angle",
        "motor.power",
        "motor.current",
        "motor.work",
        "energy.kinetic",
    ] {
        for (command, found) in analyses(&requesting(variable)) {
            // Of a pendulum with a motor: no steady cycle need exist, and it has no period.
            let missing = matches!(&found, Err(error) if error.to_string().contains("column"));
            assert!(!missing, "{command}, {variable}: {found:?}");
            if !["cycle", "calibrate"].contains(&command) {
                assert!(found.is_ok(), "{command}, {variable}: {found:?}");
            }
        }
    }
    let simulated = simulate(
        &requesting("motor.current"),
        &SolverSettings::default(),
        &no_progress,
    );
    let files = simulated.unwrap().outcome.files;
    let (_, table) = files
        .iter()
        .find(|(path, _)| path.ends_with("test-motion.csv"))
        .unwrap();
    let header = std::str::from_utf8(table).unwrap().lines().next().unwrap();
    assert_eq!(header, "t [s],phi [rad],motor.current [A]");
    // Without `variables` nothing is looked up.
    assert!(compute_reduction(&case("four-bar"), Some(5)).is_ok());
}
