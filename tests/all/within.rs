//! A motion to a wanted accuracy is as near to the truth as it says.

use crate::world::scene;
use dwell_dynamics::Method;
use dwell_scene::Scene;
use dwell_study::{Accuracy, Followed, PRESETS, simulate, simulate_within};

/// The table of a motion: names, units, rows.
struct Sheet {
    columns: Vec<(String, String)>,
    rows: Vec<Vec<f64>>,
}

fn sheet(scene: &Scene, followed: &Followed) -> Sheet {
    let name = format!("{}-motion.csv", scene.name);
    let mut files = followed.outcome.files.iter();
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
    Sheet {
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
fn off(scene: &Scene, truth: &Sheet, other: &Sheet) -> f64 {
    let mut worst = 0.0_f64;
    assert_eq!(truth.columns, other.columns);
    assert_eq!(truth.rows.len(), other.rows.len());
    let of = |k: usize, sheet: &Sheet| sheet.rows.iter().map(|row| row[k]).collect::<Vec<f64>>();
    let span = |unit: &str| {
        let alike = (0..truth.columns.len()).filter(|&k| truth.columns[k].1 == unit);
        alike
            .flat_map(|k| of(k, truth))
            .fold(0.0, |most: f64, v| most.max(v.abs()))
    };
    for (k, (name, unit)) in truth.columns.iter().enumerate() {
        let drive = scene.mechanism.actuators.iter().any(|a| a.name == *name);
        let scale = match unit.as_str() {
            "rad" if drive => 1.0,
            "m" if drive => {
                let values = of(k, truth);
                values
                    .iter()
                    .fold(0.0, |most: f64, v| most.max((v - values[0]).abs()))
            }
            "N" | "N m" => span(unit),
            _ => continue,
        };
        for (a, b) in of(k, truth).iter().zip(of(k, other)) {
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
    let finest = Accuracy {
        method: Method::Tsit45,
        relative: 1e-13,
        absolute: 1e-13,
        ..Accuracy::default()
    };
    let truth = simulate(&scene, &finest, &|_| {}).expect("a motion");
    let truth = sheet(&scene, &truth);
    for (name, wanted) in &PRESETS[..3] {
        let followed = simulate_within(&scene, *wanted, None, &|_| {}).expect("a motion");
        assert!(followed.stopped.is_none());
        let off = off(&scene, &truth, &sheet(&scene, &followed));
        println!("{name} {off:.1e}");
        assert!(off <= *wanted, "{name} {off:e}");
        // And not at any price: nothing is a million times as good.
        assert!(off > 1e-6 * wanted, "{name} {off:e}");
    }
}
