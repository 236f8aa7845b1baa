//! The rows of a table, and the extrema between them.

use crate::test_dir::{Run, TestDir, four_bar_with, home};
use std::fs;

/// A point mass on a massless bar of 1 m, released level: nine tenths of a period and more.
fn pendulum(rest: &str) -> String {
    let path = home().join("validation/pendulum-a01/scene.toml");
    let text = fs::read_to_string(path).unwrap();
    text.replace("periods = 4", &format!("duration = 2\n{rest}"))
}

/// A slider-crank with forces on a body welded to the crank, whose moments at the weld cancel.
const BALANCED_WELD: &str = include_str!("balanced-weld.toml");

fn run(text: &str, arguments: &[&str]) -> (TestDir, Run) {
    let dir = TestDir::new();
    dir.put("moved.toml", text);
    let run = dir.run(
        &[
            &arguments[..1],
            &["moved.toml"],
            &arguments[1..],
            &["--out", "o"],
        ]
        .concat(),
    );
    (dir, run)
}

/// The first cells of all rows.
fn times(dir: &TestDir, file: &str) -> Vec<f64> {
    let text = fs::read_to_string(dir.0.join(file)).unwrap();
    let first = |line: &str| line.split(',').next().unwrap().parse().unwrap();
    text.lines().skip(1).map(first).collect()
}

/// Minimum and maximum of a quantity, each with the abscissa where it is.
fn extrema(dir: &TestDir, file: &str, quantity: &str) -> [f64; 4] {
    let text = fs::read_to_string(dir.0.join(file)).unwrap();
    let start = format!("{quantity},");
    let line = text.lines().find(|line| line.starts_with(&start)).unwrap();
    let cells: Vec<f64> = line
        .split(',')
        .skip(2)
        .map(|v| v.parse().unwrap())
        .collect();
    [cells[0], cells[1], cells[2], cells[3]]
}

#[test]
fn the_last_instant_is_a_row_and_in_the_headline() {
    let (dir, run_of) = run(&pendulum(""), &["simulate", "--sample-interval", "0.3"]);
    assert_eq!((run_of.status, run_of.err.as_str()), (Some(0), ""));
    assert!(
        run_of.out.contains("8 positions over a free motion of 2 s"),
        "{}",
        run_of.out
    );
    let rows = times(&dir, "o/moved-motion.csv");
    assert_eq!((rows.len(), rows.last()), (8, Some(&2.0)));
    // Where an event ends it: at the first reversal, half a period after the release.
    let event = "[motion.events]\nback = { reverses = \"phi\", stop = true }";
    let text = pendulum("").replace(
        "initial-velocity = { phi = 0.0 }",
        "initial-velocity = { phi = 0.1 }",
    );
    let (dir, run_of) = run(&(text + event), &["simulate", "--sample-interval", "0.3"]);
    assert_eq!((run_of.status, run_of.err.as_str()), (Some(0), ""));
    let event = times(&dir, "o/moved-motion-events.csv");
    let rows = times(&dir, "o/moved-motion.csv");
    assert_eq!(rows.last(), event.last());
    assert!(event[0] > 1.0 && event[0] < 1.2, "{event:?}");
    let headline = run_of.out.lines().next().unwrap();
    assert!(
        headline.contains(&format!("{:.5}", event[0])[..6]),
        "{headline}"
    );
}

#[test]
fn a_sample_interval_outside_the_motion_is_refused() {
    for (interval, fault) in [
        ("3", "longer than the motion of 2 s"),
        ("1e-9", "2e9 samples"),
    ] {
        let (dir, run) = run(&pendulum(""), &["simulate", "--sample-interval", interval]);
        assert_eq!(run.status, Some(2), "{}", run.out);
        let message = run.err.split_whitespace().collect::<Vec<_>>().join(" ");
        assert!(message.replace("│ ", "").contains(fault), "{message}");
        assert!(
            message.contains("from 2e-5 s (100000 samples) to 2 s"),
            "{message}"
        );
        assert!(!dir.0.join("o").exists());
    }
    // Both ends of what is allowed.
    let (dir, longest) = run(&pendulum(""), &["simulate", "--sample-interval", "2"]);
    assert_eq!(longest.status, Some(0));
    assert_eq!(times(&dir, "o/moved-motion.csv"), [0.0, 2.0]);
}

/// At the bottom a bar that fell from the level bears three times the weight, whatever the rows.
#[test]
fn the_largest_force_is_that_of_the_motion() {
    for rest in [
        &["--method", "bdf"][..],
        &["--method", "dop853"],
        &["--accuracy", "1e-9"],
    ] {
        let arguments = [&["simulate", "--sample-interval", "0.37"], rest].concat();
        let (dir, run) = run(&pendulum(""), &arguments);
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
        let [min, _, max, at] = extrema(&dir, "o/moved-motion-extrema.csv", "A.magnitude");
        let expected = 3.0 * 9.81;
        assert!(
            (max - expected).abs() < 1e-6 * expected,
            "{max} for {expected}"
        );
        // A quarter of the period 4 K(1/2) √(l/g), K(1/2) = 1.854 074 677 301 372.
        let quarter = 1.854_074_677_301_372 / 9.81_f64.sqrt();
        let periods = (at - quarter) / (2.0 * quarter);
        assert!((periods - periods.round()).abs() < 1e-4, "{at} {quarter}");
        assert!(min.abs() < 1e-6 * expected, "{min}");
        assert!(run.out.contains(" reaches 29.43 N at"), "{}", run.out);
    }
}

/// A crank pin at constant speed: its components are sinusoids.
#[test]
fn the_largest_velocity_is_between_the_rows_of_a_prescribed_motion() {
    let scene = home().join("validation/slider-crank/scene.toml");
    let dir = TestDir::new();
    let arguments = [
        "kinematics",
        scene.to_str().unwrap(),
        "--points",
        "12",
        "--out",
        "o",
    ];
    let run = dir.run(&arguments);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    for (quantity, expected) in [
        ("rod.B.vx", 0.08 * 150.0),
        ("rod.B.ax", 0.08 * 150.0_f64.powi(2)),
    ] {
        let [min, _, max, _] = extrema(&dir, "o/slider-crank-kinematics-extrema.csv", quantity);
        for value in [-min, max] {
            assert!(
                (value - expected).abs() < 1e-10 * expected,
                "{quantity}: {value} {expected}"
            );
        }
    }
    assert_eq!(times(&dir, "o/slider-crank-kinematics.csv").len(), 12);
}

#[test]
fn what_is_zero_but_for_rounding_is_zero_and_has_no_relative_error() {
    let (dir, simulated) = run(BALANCED_WELD, &["simulate", "--accuracy", "1e-9"]);
    assert_eq!((simulated.status, simulated.err.as_str()), (Some(0), ""));
    let [min, _, max, _] = extrema(&dir, "o/moved-motion-extrema.csv", "w.moment");
    assert_eq!([min, max], [0.0; 2]);
    assert!(!simulated.out.contains("w.moment"), "{}", simulated.out);
    // m and ½m′ of a planetary gear are constant, and some of its reactions are zero.
    let planetary = home().join("validation/planetary/scene.toml");
    let dir = TestDir::new();
    let reduced = dir.run(&["reduce", planetary.to_str().unwrap(), "--out", "o"]);
    assert_eq!((reduced.status, reduced.err.as_str()), (Some(0), ""));
    assert!(
        reduced.out.contains("½m′  from 0 to 0 kg m²/rad"),
        "{}",
        reduced.out
    );
    let line = reduced
        .out
        .lines()
        .find(|line| line.contains("rounding errors"))
        .unwrap();
    for part in line.split(' ').filter(|part| part.starts_with("1e")) {
        let error: f64 = part.parse().unwrap();
        assert!(error < 1e-12, "{line}");
    }
}

#[test]
fn wanted_instants_are_the_rows() {
    let dir = TestDir::new();
    dir.put("moved.toml", pendulum(""));
    dir.put("instants", "# two of them\n0.25\n\n1.125 # the second\n");
    let simulate =
        |rest: &[&str]| dir.run(&[&["simulate", "moved.toml", "--out", "o"], rest].concat());
    let at = |t: &str| {
        let text = fs::read_to_string(dir.0.join("o/moved-motion.csv")).unwrap();
        let row = text.lines().find(|line| line.starts_with(t)).unwrap();
        let cells = row.split(',').take(3).map(|v| v.parse().unwrap());
        cells.collect::<Vec<f64>>()
    };
    let run = simulate(&["--times", "instants"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert_eq!(times(&dir, "o/moved-motion.csv"), [0.25, 1.125, 2.0]);
    let wanted = [at("0.25"), at("1.125")];
    let run = simulate(&["--sample-interval", "0.125"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    for (wanted, sampled) in wanted.iter().zip([at("0.25"), at("1.125")]) {
        for (a, b) in wanted.iter().zip(&sampled) {
            assert!((a - b).abs() < 1e-7, "{wanted:?} {sampled:?}");
        }
    }
    // Where only the end is left of them, the start is the other row.
    dir.put("instants", "2\n");
    let run = simulate(&["--times", "instants"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert_eq!(times(&dir, "o/moved-motion.csv"), [0.0, 2.0]);
    for (text, fault) in [
        ("0.5\n0.25\n", "the wanted instant 0.25 s follows 0.5 s"),
        (
            "0.5\n2.5\n",
            "the wanted instant 2.5 s is not within the motion of 2 s",
        ),
        ("0.5\nsoon\n", "line 2 of `instants` is no time: `soon`"),
        ("\n", "0 wanted instants"),
    ] {
        dir.put("instants", text);
        let run = simulate(&["--times", "instants"]);
        assert_eq!(run.status, Some(2), "{}", run.out);
        assert!(run.err.contains(fault), "{}", run.err);
    }
}

#[test]
fn reduce_has_as_many_positions_as_are_wanted() {
    let scene = home().join("validation/crank-rocker/scene.toml");
    let dir = TestDir::new();
    let run = dir.run(&[
        "reduce",
        scene.to_str().unwrap(),
        "--points",
        "5",
        "--out",
        "o",
    ]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert!(run.out.contains(": 5 positions of"), "{}", run.out);
    let rows = times(&dir, "o/crank-rocker-reduced.csv");
    assert_eq!(rows.len(), 5);
    assert!((rows[4] - std::f64::consts::TAU).abs() < 1e-12);
}

/// A tolerance so slack that the second digit of the energy is wrong: the files are there, and the status is 1.
#[test]
fn a_motion_with_a_large_error_is_a_failure() {
    let dir = TestDir::new();
    dir.put("scene.toml", four_bar_with(&[]));
    let run = dir.run(&["simulate", "scene.toml", "--rtol", "1e-3"]);
    assert_eq!(run.status, Some(1), "{}", run.err);
    let message = "the motion is not resolved: the estimated error of the energy is";
    assert!(run.err.contains(message), "{}", run.err);
    assert!(
        run.out.contains("a finer tolerance is needed"),
        "{}",
        run.out
    );
}

#[test]
fn the_last_row_is_the_end_itself_however_the_steps_are_limited() {
    // The first ended at 3.9999999999999925 s, and said 4 of 4 s.
    for (method, step, duration) in [
        ("tsit45", "0.01", "4"),
        ("tsit45", "0.0125", "7.3"),
        ("bdf", "0.1", "4"),
        ("esdirk34", "0.1", "7.3"),
        ("tr-bdf2", "0.1", "2"),
        ("dop853", "0.01", "4"),
    ] {
        let text = pendulum("").replace("duration = 2\n", &format!("duration = {duration}\n"));
        let options = ["--method", method, "--max-step", step, "--rtol", "1e-6"];
        let (dir, run_of) = run(&text, &[&["simulate"], &options[..]].concat());
        let what = format!("{method} {step} {duration}");
        assert_eq!(
            (run_of.status, run_of.err.as_str()),
            (Some(0), ""),
            "{what}"
        );
        let rows = times(&dir, "o/moved-motion.csv");
        assert_eq!(rows.last().copied(), duration.parse().ok(), "{what}");
        let printed = format!("\n  {duration} s by ");
        assert!(run_of.out.contains(&printed), "{what}: {}", run_of.out);
    }
}

#[test]
fn no_row_is_beyond_the_end_of_a_motion_that_ends_early() {
    // The boom falls to where its cylinder reaches no further; the end that was printed was nine rows before the last.
    let path = home().join("validation/boom/scene.toml");
    let text = fs::read_to_string(path).unwrap();
    let (text, _) = text.split_once("[motion]").unwrap();
    let motion = "[motion]\nduration = 1.702901\ninitial-velocity = { lift = -3, dig = 0 }\n";
    let text = text.replace("mass = 620.0", "mass = 310.0") + motion;
    let options = ["--rtol", "1e-4", "--sample-interval", "0.001"];
    let (dir, run_of) = run(&text, &[&["simulate"], &options[..]].concat());
    assert_eq!(run_of.status, Some(1), "{}", run_of.err);
    let last = *times(&dir, "o/moved-motion.csv").last().unwrap();
    let head = run_of.out.lines().next().unwrap();
    let (_, end) = head.split_once("a free motion of ").unwrap();
    let end: f64 = end.strip_suffix(" s").unwrap().parse().unwrap();
    assert!((last - end).abs() < 1e-6, "{last} {head}");
}
