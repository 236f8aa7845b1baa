//! `dwell reduce --from`: what `dwell runs` exported, and what careless users give.

use crate::test_dir::TestDir;
use serde_json::Value;

const PERIOD: f64 = 5.419_662_677_064_272;

fn single_dwell() -> String {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    std::fs::read_to_string(format!("{root}/validation/single-dwell/scene.toml")).unwrap()
}

#[test]
fn exported_runs_give_the_reduced_model() {
    let dir = TestDir::new();
    dir.put("dwell.toml", single_dwell());
    let scene = dir.run(&["runs", "dwell.toml", "--out", "o", "--pictures", "none"]);
    assert_eq!(scene.status, Some(0), "{}", scene.err);
    for ending in ["csv", "npz"] {
        let [one, two] = ["i", "ii"].map(|run| format!("o/dwell-run-{run}.{ending}"));
        let done = dir.run(&[
            "reduce", "--from", &one, &two, "--out", ending, "--name", "again",
        ]);
        assert_eq!(done.status, Some(0), "{}{}", done.out, done.err);
        let summary: Value = serde_json::from_str(
            &std::fs::read_to_string(dir.0.join(format!("{ending}/again-reduce.json")))
                .expect("a file"),
        )
        .expect("JSON");
        let period = summary["results"]["period_at_unit_speed"]["value"]
            .as_f64()
            .expect("a period");
        let error = summary["results"]["period_at_unit_speed"]["estimated_error"].as_f64();
        let error = error.expect("an error");
        assert!((period - PERIOD).abs() < 1e-11, "{period} {ending}");
        assert!(
            (period - PERIOD).abs() <= error && error < 1e-9,
            "{error:e}"
        );
        assert!(
            std::fs::read_to_string(dir.0.join(format!("{ending}/again-reduced.csv")))
                .expect("a file")
                .starts_with("phi [rad],m [kg m2],half_dm")
        );
    }
}

#[test]
fn careless_exports_are_refused() {
    let dir = TestDir::new();
    dir.put("dwell.toml", single_dwell());
    dir.run(&[
        "runs",
        "dwell.toml",
        "--out",
        "o",
        "--pictures",
        "none",
        "--points",
        "73",
    ]);
    let (one, two) = ("o/dwell-run-i.csv", "o/dwell-run-ii.csv");
    dir.put(
        "columns.toml",
        "coordinate = \"phi\"\nforce = \"Phi.Actuator_Force\"\n",
    );
    dir.put("wrong.toml", "coordinat = \"phi\"\n");
    dir.put("short.csv", "phi [deg],torque\n0,1\n10\n");
    for (arguments, status, message) in [
        (&["--from", two, one][..], 2, "exchanged"),
        (&["--from", one], 2, "2 values required"),
        (
            &["--from", one, "missing.csv"],
            2,
            "`missing.csv` cannot be read",
        ),
        (
            &["--from", one, two, "--columns", "columns.toml"],
            2,
            "did you mean `phi.actuator_force`?",
        ),
        (
            &["--from", one, two, "--columns", "wrong.toml"],
            2,
            "unknown key `coordinat`",
        ),
        (
            &["--from", "short.csv", two],
            2,
            "a row of 1 fields, where the header has 2",
        ),
        (
            &["dwell.toml", "--from", one, two],
            2,
            "cannot be used with",
        ),
        (
            &["--from", one, two, "--interpolation", "quadratic"],
            2,
            "invalid value 'quadratic'",
        ),
    ] {
        let done = dir.run(&[&["reduce", "--out", "p"], arguments].concat());
        let text = done.err.split_whitespace().collect::<Vec<_>>().join(" ");
        assert_eq!(done.status, Some(status), "{arguments:?}: {text}");
        assert!(text.contains(message), "{arguments:?}: {text}");
    }
}

/// The scene that `reduce --from` writes moves as the mechanism that the runs are of, with its reactions.
#[test]
fn the_written_scene_moves_as_the_mechanism() {
    let dir = TestDir::new();
    dir.put("single-dwell.toml", single_dwell());
    let scene = "single-dwell.toml";
    let ok = |args: &[&str]| {
        let run = dir.run(args);
        assert_eq!(run.status, Some(0), "{args:?}: {}", run.err);
    };
    ok(&[
        "runs",
        scene,
        "--points",
        "361",
        "--pictures",
        "none",
        "--out",
        "o",
    ]);
    let runs = ["o/single-dwell-run-i.csv", "o/single-dwell-run-ii.csv"];
    ok(&[
        "reduce",
        "--from",
        runs[0],
        runs[1],
        "--pictures",
        "none",
        "--out",
        "o",
        "--name",
        "known",
    ]);
    // The original takes ten periods in its 1001 rows, the written scene one.
    for (scene, out) in [(scene, "original"), ("o/known-scene.toml", "written")] {
        ok(&[
            "simulate",
            scene,
            "--method",
            "dop853",
            "--rtol",
            "1e-12",
            "--pictures",
            "none",
            "--out",
            out,
        ]);
    }
    let columns = |file: &str| {
        let text = std::fs::read_to_string(dir.0.join(file)).unwrap();
        let mut lines = text
            .lines()
            .map(|line| line.split(',').map(str::to_owned).collect::<Vec<_>>());
        let header = lines.next().unwrap();
        let rows: Vec<Vec<String>> = lines.collect();
        move |name: &str| -> Vec<f64> {
            let k = header
                .iter()
                .position(|column| column.starts_with(name))
                .unwrap();
            rows.iter().map(|row| row[k].parse().unwrap()).collect()
        }
    };
    let original = columns("original/single-dwell-motion.csv");
    let written = columns("written/known-scene-motion.csv");
    let times = [original("t [s]"), written("t [s]")];
    assert!(
        (times[1][1000] - 5.419_662_677_064).abs() < 1e-9,
        "{}",
        times[1][1000]
    );
    for (name, tolerance) in [
        ("phi [rad]", 1e-11),
        ("phi.velocity", 1e-11),
        ("slide.normal", 1e-9),
    ] {
        let values = [original(name), written(name)];
        let largest = values[0].iter().fold(0.0_f64, |max, v| max.max(v.abs()));
        for k in 0..=100 {
            assert!((times[0][k] - times[1][10 * k]).abs() < 1e-12);
            let difference = (values[0][k] - values[1][10 * k]).abs() / largest;
            assert!(difference < tolerance, "{name} {k}: {difference:e}");
        }
    }
}
