//! Searches of better designs: what is left of one that is interrupted, the scene that is written, and the status.

use crate::test_dir::{TestDir, home};
use std::fs;
use std::io::{BufRead as _, BufReader, Read as _};
use std::process::{Command, Stdio};

/// A scene with a job, of those that the optimiser is tested with.
fn job(name: &str, changes: &[(&str, &str)]) -> TestDir {
    let read = |name: &str| fs::read_to_string(home().join("tests/all/optimise").join(name));
    let mut text = read(&format!("{name}.toml")).unwrap();
    for (old, new) in changes {
        assert_eq!(text.matches(old).count(), 1, "`{old}` once in the scene");
        text = text.replacen(old, new, 1);
    }
    let dir = TestDir::new();
    dir.put("machine.toml", text);
    if let Ok(table) = read(&format!("{name}.csv")) {
        dir.put(&format!("{name}.csv"), table);
    }
    dir
}

#[cfg(unix)]
#[test]
fn ctrl_c_keeps_the_best_design_so_far() {
    // So many random designs take half a minute and more.
    let dir = job(
        "lengths-ten",
        &[("starts = 200", "starts = 200\npool = 1000000")],
    );
    let mut command = dir.command(&["optimise", "machine.toml", "--out", "o"]);
    let command = command.stderr(Stdio::piped()).stdout(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut line = String::new();
    let mut lines = BufReader::new(child.stderr.take().unwrap());
    lines.read_line(&mut line).unwrap();
    assert!(line.contains("running for 2 s"), "{line}");
    let id = child.id().to_string();
    let mut interrupt = Command::new("kill");
    assert!(interrupt.args(["-INT", &id]).status().unwrap().success());
    let mut out = String::new();
    let mut printed = child.stdout.take().unwrap();
    printed.read_to_string(&mut out).unwrap();
    let mut rest = String::new();
    lines.read_to_string(&mut rest).unwrap();
    // No start has converged.
    assert_eq!(child.wait().unwrap().code(), Some(1), "{rest}");
    assert!(
        rest.starts_with("interrupted: the best design so far follows"),
        "{rest}"
    );
    assert!(
        out.contains("not certified: the search was interrupted"),
        "{out}"
    );
    assert!(out.contains("evaluations; interrupted\n"), "{out}");
    let again = dir.run(&["check", "o/machine-optimise-ten.toml"]);
    assert_eq!(again.status, Some(0), "{}", again.err);
}

#[test]
fn the_better_scene_is_read_from_where_it_is_written() {
    let few = [("starts = 100\npool = 5000", "starts = 3\npool = 30")];
    let dir = job("timed", &few);
    let before = fs::read(dir.0.join("timed.csv")).unwrap();
    let run = dir.run(&["optimise", "machine.toml", "--out", "o"]);
    assert_eq!(run.status, Some(0), "{}", run.err);
    let sweep = ["sweep", "o/machine-optimise-path.toml", "--out", "s"];
    let varied = ["--result", "curve.distance.rms", "--vary", "u=0.1:0.3:2"];
    let run = dir.run(&[&sweep[..], &varied[..]].concat());
    assert_eq!(run.status, Some(0), "{}", run.err);
    // Beside the scene itself the table stays as it is, and no other is replaced.
    let run = dir.run(&["optimise", "machine.toml", "--out", "."]);
    assert_eq!(run.status, Some(0), "{}", run.err);
    assert_eq!(fs::read(dir.0.join("timed.csv")).unwrap(), before);
    dir.put("o/timed.csv", "another table");
    let run = dir.run(&["optimise", "machine.toml", "--out", "o"]);
    assert_eq!(run.status, Some(2), "{}", run.out);
    assert!(run.err.contains("timed.csv"), "{}", run.err);
}

#[test]
fn a_condition_that_no_design_satisfies_is_no_success() {
    let text = fs::read_to_string(home().join("tests/all/optimise/lengths.toml")).unwrap();
    let written = text
        .lines()
        .find(|line| line.starts_with("subject-to"))
        .unwrap();
    // A rocker of a four-bar swings by less than half a turn.
    let dir = job(
        "lengths",
        &[
            (written, "subject-to = [\"rocker.angle.stroke = 4\"]"),
            ("starts = 200", "starts = 3"),
        ],
    );
    let run = dir.run(&["optimise", "machine.toml", "--out", "o"]);
    assert_eq!(run.status, Some(1), "{}", run.out);
    assert!(
        run.out.contains("not certified: a condition is violated"),
        "{}",
        run.out
    );
}
