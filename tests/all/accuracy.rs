//! A motion to a wanted accuracy is as near to the truth as it says.

use dwell_dynamics::Method;
use dwell_scene::PlaneScene;
use dwell_study::{PRESETS, SolverSettings, TrajectoryOutcome, simulate, simulate_to_accuracy};
use dwell_tests::fixtures::scene;

/// The table of a motion: names, units, rows.
struct MotionTable {
    columns: Vec<(String, String)>,
    rows: Vec<Vec<f64>>,
}

fn motion_table(scene: &PlaneScene, results: &TrajectoryOutcome) -> MotionTable {
    let name = format!("{}-motion.csv", scene.name);
    let mut files = results.outcome.files.iter();
    let file = files.find(|(path, _)| path.ends_with(&name));
    let (_, file) = file.expect("a table");
    let text = std::str::from_utf8(file).expect("text");
    let mut lines = text.lines();
    let column = |head: &str| {
        let (name, unit) = head
            .trim_matches('"')
            .split_once(" [")
            .unwrap_or((head, ""));
        (name.to_owned(), unit.trim_end_matches(']').to_owned())
    };
    MotionTable {
        columns: lines
            .next()
            .expect("a head")
            .split(',')
            .map(column)
            .collect(),
        rows: lines
            .map(|line| {
                line.split(',')
                    .map(|v| v.parse().unwrap_or(f64::NAN))
                    .collect()
            })
            .collect(),
    }
}

/// The largest difference of coordinates (rad), and of forces and moments as parts of their largest.
fn max_difference(scene: &PlaneScene, reference: &MotionTable, other: &MotionTable) -> f64 {
    let mut worst = 0.0_f64;
    assert_eq!(reference.columns, other.columns);
    assert_eq!(reference.rows.len(), other.rows.len());
    let of =
        |k: usize, sheet: &MotionTable| sheet.rows.iter().map(|row| row[k]).collect::<Vec<f64>>();
    let span = |unit: &str| {
        let alike = (0..reference.columns.len()).filter(|&k| reference.columns[k].1 == unit);
        alike
            .flat_map(|k| of(k, reference))
            .fold(0.0, |max: f64, v| max.max(v.abs()))
    };
    for (k, (name, unit)) in reference.columns.iter().enumerate() {
        let drive = scene.mechanism.actuators.iter().any(|a| a.name == *name);
        let scale = match unit.as_str() {
            "rad" if drive => 1.0,
            "m" if drive => {
                let values = of(k, reference);
                values
                    .iter()
                    .fold(0.0, |max: f64, v| max.max((v - values[0]).abs()))
            }
            "N" | "N m" => span(unit),
            _ => continue,
        };
        for (a, b) in of(k, reference).iter().zip(of(k, other)) {
            if !(a.is_nan() && b.is_nan()) {
                let part = (a - b).abs() / scale;
                assert!(part.is_finite(), "{name}");
                worst = worst.max(part);
            }
        }
    }
    worst
}

/// As a user sees it: the tables of coordinates and reactions, against a method that was not picked. (How all
/// cases keep all accuracies is judged next to the choice itself.)
#[test]
fn val_what_is_asked_for_is_in_the_table() {
    let scene = scene("slider-crank-friction");
    let finest = SolverSettings {
        method: Method::Tsit45,
        rtol: 1e-13,
        atol: 1e-13,
        ..SolverSettings::default()
    };
    let reference = simulate(&scene, &finest, &|_| {}).expect("a motion");
    let reference = motion_table(&scene, &reference);
    for (name, accuracy) in &PRESETS[..3] {
        let results = simulate_to_accuracy(&scene, *accuracy, None, &|_| {}).expect("a motion");
        assert!(results.early_stop.is_none());
        let difference = max_difference(&scene, &reference, &motion_table(&scene, &results));
        println!("{name} {difference:.1e}");
        assert!(difference <= *accuracy, "{name} {difference:e}");
        // And not at any price: nothing is a million times as good.
        assert!(difference > 1e-6 * accuracy, "{name} {difference:e}");
    }
}
