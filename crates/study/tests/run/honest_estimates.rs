//! The stated errors of a motion to a required accuracy, compared with a far finer run.

use crate::table::scene;
use dwell_dynamics::Method;
use dwell_findings::RecordedNumber;
use dwell_scene::PlaneScene;
use dwell_study::{
    FreeMotion, MotionSolver, SolverSettings, compute_free_motion, free_motion_page,
};

const SCENES: [&str; 3] = [
    include_str!("four-bar-near-limit.toml"),
    include_str!("three-links.toml"),
    include_str!("six-bar-driven.toml"),
];

fn run(scene: &PlaneScene, solver: MotionSolver) -> FreeMotion {
    compute_free_motion(scene, &solver, &|_| {}).unwrap()
}

/// The numbers that are said of a motion.
fn recorded(scene: &PlaneScene, solver: MotionSolver) -> Vec<RecordedNumber> {
    free_motion_page(scene, &solver, &|_| {}).unwrap().0.numbers
}

fn number(numbers: &[RecordedNumber], name: &str) -> f64 {
    let of = numbers.iter().find(|number| number.name == name);
    of.unwrap_or_else(|| panic!("{name}")).value
}

/// The kinetic energies by row.
fn kinetic(motion: &FreeMotion) -> Vec<f64> {
    let table = &motion.computed.table;
    let column = table
        .columns
        .iter()
        .position(|c| c.name == "energy.kinetic")
        .unwrap();
    table.rows.iter().map(|row| row[column]).collect()
}

/// Speeds at the start times a factor.
fn faster(text: &str, factor: f64) -> String {
    let (before, speeds) = text.split_once("initial-velocity = {").unwrap();
    let (speeds, after) = speeds.split_once('}').unwrap();
    let one = |entry: &str| {
        let (name, value) = entry.split_once('=').unwrap();
        format!("{name}= {}", factor * value.trim().parse::<f64>().unwrap())
    };
    let speeds: Vec<String> = speeds.split(',').map(one).collect();
    format!("{before}initial-velocity = {{{}}}{after}", speeds.join(","))
}

/// The estimated error of the energy is no less than what the run's own balance shows, and than the true error of the kinetic
/// energy; and a run whose estimate is above the required accuracy says so.
#[test]
fn energies_to_an_accuracy_err_by_no_more_than_is_said() {
    for text in SCENES {
        for factor in [1.0, 0.93, 1.06] {
            let scene = scene(&faster(text, factor));
            let settings = SolverSettings {
                method: Method::Dop853,
                rtol: 1e-13,
                atol: 1e-13,
                ..SolverSettings::default()
            };
            let exact = kinetic(&run(&scene, MotionSolver::Settings(settings)));
            let largest = exact.iter().copied().fold(0.0, f64::max);
            for accuracy in [1e-2, 1e-3, 1e-4, 1e-6] {
                let sample_interval = None;
                let solver = MotionSolver::Accuracy {
                    accuracy,
                    sample_interval,
                };
                let (found, numbers) = (run(&scene, solver), recorded(&scene, solver));
                let estimate = number(&numbers, "error.kinetic_energy");
                let balance = number(&numbers, "energy_balance_error");
                let energies = kinetic(&found);
                let pairs = energies.iter().zip(&exact);
                let error = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) / largest;
                let title = &scene.title;
                let what =
                    format!("{title} {factor} {accuracy:e}: {error:e} {balance:e} of {estimate:e}");
                // The finer run errs itself.
                assert!(error <= estimate.max(1e-11), "{what}");
                assert!(balance <= estimate, "{what}");
                let kept = found.estimated_error.unwrap() <= accuracy;
                assert_eq!(kept, found.computed.early_stop.is_none(), "{what}");
                assert!(kept, "{what}");
            }
        }
    }
}
