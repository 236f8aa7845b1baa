//! Motions of very many periods, by quadrature: their end, their rows, their events and the status.

use crate::test_dir::{Run, TestDir, four_bar_with, home};
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::process::Stdio;
use std::time::{Duration, Instant};

/// Half the period of the pendulum A01, released level, s (50 digits: 2.3678419475762374493 s).
const HALF_PERIOD: f64 = 1.183_920_973_788_118_7;

/// A point mass on a massless bar of 1 m, released level.
fn pendulum(rest: &str) -> String {
    let path = home().join("validation/pendulum-a01/scene.toml");
    let text = fs::read_to_string(path).unwrap();
    text.replace("periods = 4", rest)
}

/// A wheel without loads at 1000 rad/s.
fn wheel(rest: &str) -> String {
    let path = home().join("validation/pendulum-a01/scene.toml");
    let text = fs::read_to_string(path).unwrap();
    let text = text
        .replace("periods = 4", rest)
        .replace("phi = 0.0", "phi = 1000");
    text.replace("weight = { gravity = [0, -9.81] }", "")
}

fn simulate(text: &str, arguments: &[&str]) -> (TestDir, Run) {
    let dir = TestDir::new();
    dir.put("long.toml", text);
    let all = [&["simulate", "long.toml", "--out", "o"], arguments].concat();
    let run = dir.run(&all);
    (dir, run)
}

/// A column of a table.
fn column(dir: &TestDir, file: &str, index: usize) -> Vec<f64> {
    let text = fs::read_to_string(dir.0.join(file)).unwrap();
    let cell = |line: &str| line.split(',').nth(index).unwrap().parse().unwrap();
    text.lines().skip(1).map(cell).collect()
}

#[test]
fn forty_thousand_periods_with_their_events() {
    let text = pendulum("periods = 40000\nevents.back = { reverses = \"phi\" }");
    let (dir, run) = simulate(&text, &["--accuracy", "1e-6"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""), "{}", run.out);
    let end = 80_000.0 * HALF_PERIOD;
    assert!(run.out.contains("back: 80000 times"), "{}", run.out);
    let rows = column(&dir, "o/long-motion.csv", 0);
    assert_eq!(rows.len(), 1001);
    assert!((rows[1000] - end).abs() < 1e-9 * end, "{}", rows[1000]);
    let times = column(&dir, "o/long-motion-events.csv", 0);
    for (k, t) in times.iter().enumerate() {
        let error = (t / ((k + 1) as f64 * HALF_PERIOD) - 1.0).abs();
        assert!(error < 1e-9, "{k} {error:e}");
    }
    // Its largest force, at the bottom of a swing, is three times the weight, between whatever rows.
    let text = fs::read_to_string(dir.0.join("o/long-motion-extrema.csv")).unwrap();
    let force = text
        .lines()
        .find(|line| line.starts_with("A.magnitude,"))
        .unwrap();
    let cells = force.split(',').skip(2).map(|cell| cell.parse().unwrap());
    let cells: Vec<f64> = cells.collect();
    let largest = cells[0].abs().max(cells[2].abs());
    assert!((largest / (3.0 * 9.81) - 1.0).abs() < 1e-5, "{force}");
}

#[test]
fn more_events_than_are_kept_are_an_error() {
    let text = pendulum("periods = 60000\nevents.back = { reverses = \"phi\" }");
    let (dir, run) = simulate(&text, &["--accuracy", "1e-6"]);
    assert_eq!(run.status, Some(1), "{}", run.out);
    let message = run.err.split_whitespace().collect::<Vec<_>>().join(" ");
    let message = message.replace("│ ", "");
    assert!(
        message.contains("more than 100000 events happen"),
        "{message}"
    );
    // What is written ends where the message says.
    let times = column(&dir, "o/long-motion-events.csv", 0);
    let rows = column(&dir, "o/long-motion.csv", 0);
    assert_eq!((times.len(), times.last()), (100_000, rows.last()));
}

#[test]
fn a_fast_wheel_for_a_million_seconds() {
    let text = wheel("duration = 1e6\nevents.far = { reaches = \"phi\", value = 9e5 }");
    let far = (9e5 - std::f64::consts::PI) / 1000.0;
    // 1e9 rad have roundings of 1e-7, and the period its own.
    for (accuracy, status) in [("1e-3", 0), ("1e-6", 1)] {
        let (dir, run) = simulate(&text, &["--accuracy", accuracy, "--sample-interval", "1e5"]);
        let rows = column(&dir, "o/long-motion.csv", 0);
        assert_eq!(
            rows,
            (0..=10).map(|k| 1e5 * f64::from(k)).collect::<Vec<_>>(),
            "{}",
            run.out
        );
        // By hand.
        let times = column(&dir, "o/long-motion-events.csv", 0);
        assert!(
            times.len() == 1 && (times[0] - far).abs() < 1e-6,
            "{times:?} {}",
            run.out
        );
        assert_eq!(run.status, Some(status), "{}", run.err);
    }
    // What stops the motion.
    let stop = text.replace("e5 }", "e5, stop = true }");
    let (dir, run) = simulate(&stop, &["--accuracy", "1e-3"]);
    assert_eq!(run.status, Some(0), "{}", run.err);
    let rows = column(&dir, "o/long-motion.csv", 0);
    assert!(
        (rows.last().unwrap() - far).abs() < 1e-6,
        "{:?}",
        rows.last()
    );
}

/// The same angle, stopped at the third swing, by every method.
#[test]
fn a_release_from_rest_is_no_event_by_any_method() {
    let text = pendulum(
        "periods = 3.2\nevents.back = { reverses = \"phi\" }\nevents.home = { reaches = \"phi\", value = 3.141592653589793 }",
    );
    let methods = ["bdf", "esdirk34", "tr-bdf2", "tsit45", "dop853"];
    let by_method = methods.map(|method| vec!["--method", method, "--rtol", "1e-8"]);
    for arguments in by_method.into_iter().chain([vec!["--accuracy", "1e-6"]]) {
        let (_, run) = simulate(&text, &arguments);
        assert_eq!(run.status, Some(0), "{arguments:?} {}", run.err);
        assert!(
            run.out.contains("back: 6 times, first at t = 1.18392"),
            "{arguments:?} {}",
            run.out
        );
        assert!(run.out.contains("home: never"), "{arguments:?} {}", run.out);
    }
}

/// After 2 s without a terminal a line says that the run goes on; what it would print is read until then.
#[test]
fn a_long_run_says_that_it_goes_on() {
    let dir = TestDir::new();
    let begin = Instant::now();
    dir.put("long.toml", four_bar_with(&[]));
    let slow = ["sweep", "long.toml", "--vary", "coupler.mass=1:2:1000000"];
    let mut child = dir.command(&slow).stderr(Stdio::piped()).spawn().unwrap();
    let mut line = String::new();
    let mut lines = BufReader::new(child.stderr.take().unwrap());
    lines.read_line(&mut line).unwrap();
    child.kill().unwrap();
    child.wait().unwrap();
    let (done, end) = line.split_once(" of 1000000 steps done").unwrap();
    let done = done.strip_prefix("dwell sweep: running for 2 s, ").unwrap();
    assert!(done.parse::<u32>().unwrap() > 10, "{line}");
    assert_eq!(end, " (last: points)\n");
    assert!(begin.elapsed() >= Duration::from_secs(2), "{begin:?}");
}
