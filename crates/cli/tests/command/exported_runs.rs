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
    // As it was written before two files followed.
    let former = dir.run(&[
        "reduce",
        "dwell.toml",
        "--table-accuracy",
        "1e-6",
        "--from",
        "0",
        "--to",
        "1",
        "--pictures",
        "none",
    ]);
    assert_eq!(former.status, Some(0), "{}", former.err);
    assert!(
        former.err.contains("--from is now --table-from"),
        "{}",
        former.err
    );
}
