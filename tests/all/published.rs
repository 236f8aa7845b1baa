//! Published and independently computed values, to 1e-12 of the largest coefficient of a unit.

use dwell_kinetostatics::ReducedModel;
use dwell_tests::fixtures::{model, repository_root, scene};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    match value {
        Value::String(text) => text.parse().expect("a number"),
        other => other.as_f64().expect("a number"),
    }
}

fn val_reference(case: &str) {
    let scene = scene(case);
    let model = model(&scene);
    let text = std::fs::read_to_string(
        repository_root()
            .join("validation")
            .join(case)
            .join("case.toml"),
    );
    let reference: Value = toml::from_str(&text.expect("a file")).expect("TOML");
    let reactions = scene.mechanism.reactions();
    let mut workspace = model.workspace();
    let mut at = model.model().coefficient_buffer();
    // The largest coefficient of each unit over the samples: reactions in N, couples in N m.
    let (mut worst, mut largest) = (0.0_f64, 0.0_f64);
    for sample in reference["samples"].as_array().expect("samples") {
        let degrees = sample["q"].as_str().and_then(|q| q.strip_suffix("*pi/180"));
        let phi = match degrees {
            Some(degrees) => number(&Value::from(degrees)).to_radians(),
            None => number(&sample["q"]),
        };
        model
            .coefficients(phi, &mut workspace, &mut at)
            .expect("a pose");
        let m = number(&sample["m"]);
        assert!((at.m - m).abs() < 1e-14 * m, "{case} {phi}: m {} {m}", at.m);
        let half = number(&sample["half_dm"]);
        assert!(
            (at.half_dm - half).abs() < 1e-12 * m,
            "{case} {phi}: {} {half}",
            at.half_dm
        );
        for (name, value) in sample["reactions"].as_object().expect("reactions") {
            let k = reactions
                .iter()
                .position(|&r| scene.mechanism.reaction_name(r) == *name)
                .expect("a reaction");
            for (got, want) in [
                (at.a[k], number(&value["a"])),
                (at.b[k], number(&value["b"])),
            ] {
                worst = worst.max((got - want).abs());
                largest = largest.max(want.abs());
                assert!(
                    (got - want).abs() < 1e-11,
                    "{case} {phi} {name}: {got} {want}"
                );
            }
        }
    }
    assert!(worst < 1e-12 * largest, "{case}: {worst:e} of {largest}");
}

#[test]
fn val_single_dwell() {
    val_reference("single-dwell");
}

#[test]
fn val_crank_rocker() {
    val_reference("crank-rocker");
}

#[test]
fn largest_groups() {
    for (case, largest) in [
        ("single-dwell", 2),
        ("crank-rocker", 2),
        ("slotted-rocker", 2),
        ("class-three-six-bar", 4),
    ] {
        let model = model(&scene(case));
        let sizes = model.model().plan().group_methods();
        assert!(
            sizes.iter().map(|(n, _)| *n).max() <= Some(largest),
            "{case}: {sizes:?}"
        );
        println!("{case}: {sizes:?} {:?}", model.range());
    }
}
