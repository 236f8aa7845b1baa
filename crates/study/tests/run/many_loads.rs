//! Many loads: they do what fewer do, and the works of more than 32 are one sum.

use crate::table::{PENDULUM, Table, largest, scene};
use dwell_dynamics::Method;
use dwell_study::{SolverSettings, TrajectoryOutcome, simulate, simulate_to_accuracy};

/// The pendulum under a number of equal torques, whose sum does not depend on it.
fn pendulum(count: usize) -> String {
    let torque = |k: usize| {
        format!("push{k} = {{ torque = \"bar\", magnitude = \"0.5 * cos(3 * t) / {count}\" }}\n")
    };
    let torques: String = (0..count).map(torque).collect();
    format!("{PENDULUM}{torques}[motion]\ninitial-coordinate = 0.4\nduration = 2\n")
}

/// The table of a motion.
fn table(found: &TrajectoryOutcome) -> Table {
    let mut files = found.outcome.files.iter();
    let csv = files.find(|(path, _)| path.to_string_lossy().ends_with("-motion.csv"));
    Table::parse(std::str::from_utf8(csv.unwrap().1).unwrap())
}

/// By an implicit method, an explicit one, and on a table: coordinate, reactions and works are those of two loads.
#[test]
fn the_work_of_many_loads_is_that_of_two() {
    let scenes = [2, 40].map(|count| scene(&pendulum(count)));
    let by_method = |method| {
        scenes.each_ref().map(|scene| {
            let settings = SolverSettings {
                method,
                ..SolverSettings::default()
            };
            table(&simulate(scene, &settings, &|_| {}).unwrap())
        })
    };
    let to_accuracy = scenes
        .each_ref()
        .map(|scene| table(&simulate_to_accuracy(scene, 1e-7, None, &|_| {}).unwrap()));
    for [two, many] in [
        by_method(Method::Bdf),
        by_method(Method::Dop853),
        to_accuracy,
    ] {
        assert!(!many.has("push0.work") && !two.has("loads.work"));
        let works = two.column("push0.work");
        let works: Vec<f64> = works
            .iter()
            .zip(two.column("push1.work"))
            .map(|(a, b)| a + b)
            .collect();
        assert!(largest(&works) > 0.01, "{}", largest(&works));
        let same = |name: &str, few: &[f64], many: &[f64]| {
            for (a, b) in few.iter().zip(many) {
                assert!((a - b).abs() < 1e-6 * largest(few), "{name}: {a} {b}");
            }
        };
        same("work", &works, &many.column("loads.work"));
        for name in ["phi", "A.x", "energy.kinetic"] {
            same(name, &two.column(name), &many.column(name));
        }
        // Energies less works are what they were.
        let balance = largest(&many.column("energy.balance_error"));
        assert!(balance < 1e-6 * largest(&works), "{balance}");
    }
}

/// A table of w and c that a computer does not hold is refused before it is computed, with how many positions it may have.
#[test]
fn a_reduced_table_of_very_many_loads_is_refused() {
    let refused = dwell_study::reduce(&scene(&pendulum(20_000)), None, None);
    let message = refused.map(drop).unwrap_err().to_string();
    assert!(message.contains("20001 loads"), "{message}");
}
