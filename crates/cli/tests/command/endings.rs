//! Motions that cannot continue: their rows up to there, the instant, all coordinates and the bodies; and what takes too long.

use crate::test_dir::{Run, TestDir};
use std::fs;

const METHODS: [&str; 5] = ["bdf", "esdirk34", "tr-bdf2", "tsit45", "dop853"];
/// By scene: its coordinates, a body that is named, and when it ends, s: where all methods end within 2e-6 s.
const SINGULAR: [(&str, &[&str], &str, f64); 3] = [
    (
        include_str!("endings/five-bar.toml"),
        &["p", "q"],
        "three",
        0.195_568_9,
    ),
    (
        include_str!("endings/slot.toml"),
        &["q0", "q1"],
        "b2",
        0.180_554_3,
    ),
    (
        include_str!("endings/stewart.toml"),
        &["q0", "q1", "q2", "q3", "q4", "q5"],
        "b0",
        0.188_014,
    ),
];

fn simulate(text: &str, arguments: &[&str]) -> (TestDir, Run) {
    let dir = TestDir::new();
    dir.put("ends.toml", text);
    let fixed = ["simulate", "ends.toml", "--out", "o", "--pictures", "none"];
    let run = dir.run(&[&fixed[..], arguments].concat());
    (dir, run)
}

/// A message without its line breaks.
fn message(run: &Run) -> String {
    let words = run.err.replace('│', " ");
    words.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// A column of the motion by the start of its name.
fn column(dir: &TestDir, name: &str) -> Vec<f64> {
    let text = fs::read_to_string(dir.0.join("o/ends-motion.csv")).unwrap();
    let mut lines = text.lines();
    let mut names = lines.next().unwrap().split(',');
    let k = names.position(|n| n.starts_with(name)).unwrap();
    let cell = |line: &str| line.split(',').nth(k).unwrap().parse().unwrap();
    lines.map(cell).collect()
}

/// The steps that a run took.
fn steps(run: &Run) -> usize {
    let line = run.out.lines().find(|line| line.contains(" steps, "));
    let number = line.unwrap().split_whitespace().next().unwrap();
    number.parse().unwrap()
}

/// By every method: status 1, rows up to the singular position, none that is false, and what ends there.
#[test]
fn singular_positions_end_motions_by_every_method() {
    for (text, coordinates, body, end) in SINGULAR {
        for method in METHODS {
            let (dir, run) = simulate(text, &["--method", method]);
            let (message, place) = (message(&run), format!("{body} {method}"));
            assert_eq!(run.status, Some(1), "{place}: {message}");
            assert!(
                message.contains("the motion cannot continue after t = ")
                    && message.contains(&format!("`{body}`")),
                "{place}: {message}"
            );
            for name in coordinates {
                assert!(
                    message.contains(&format!("`{name}` = ")),
                    "{place}: {message}"
                );
            }
            let t = column(&dir, "t [s]");
            let last = *t.last().unwrap();
            assert!((last - end).abs() < 1e-3 * end, "{place}: {last}");
            // A false row had half the kinetic energy, or three times as much.
            let kinetic = column(&dir, "energy.kinetic [");
            let largest = kinetic.iter().fold(0.0, |max: f64, t| max.max(*t));
            let balance = column(&dir, "energy.balance_error [");
            let off = balance.iter().fold(0.0, |max: f64, b| max.max(b.abs()));
            assert!(off < 1e-4 * largest, "{place}: {off:e} of {largest}");
            // TR-BDF2 takes 27 757 to the dead position of the slot; BDF took 2 000 000.
            assert!(steps(&run) < 50_000, "{place}: {}", steps(&run));
        }
    }
}

/// What is required to an accuracy, and the values at the end, are those of the last good row.
#[test]
fn accuracies_and_extrema_know_no_false_row() {
    let (text, _, _, end) = SINGULAR[0];
    for accuracy in ["1e-3", "1e-6"] {
        let (dir, run) = simulate(text, &["--accuracy", accuracy]);
        assert_eq!(run.status, Some(1), "{}", run.err);
        let t = column(&dir, "t [s]");
        assert!((t.last().unwrap() - end).abs() < 1e-3 * end, "{t:?}");
        // 3.146 J at the singular position; a false row had 1.575 J, and false steps 6 J.
        let extrema = fs::read_to_string(dir.0.join("o/ends-motion-extrema.csv")).unwrap();
        let line = extrema
            .lines()
            .find(|line| line.starts_with("energy.kinetic,"));
        let largest: f64 = line.unwrap().split(',').nth(4).unwrap().parse().unwrap();
        assert!((largest - 3.146).abs() < 0.02, "{largest} {line:?}");
    }
}

/// Two coordinates with a loop in space: the same at any number of revolutions, and as before far from them.
#[test]
fn a_loop_in_space_turns_on() {
    let text = include_str!("endings/rssr-pendulum.toml");
    let (dir, run) = simulate(text, &[]);
    assert_eq!(run.status, Some(0), "{}", run.err);
    let [kinetic, balance] =
        ["energy.kinetic [", "energy.balance_error ["].map(|c| column(&dir, c));
    let largest = kinetic.iter().fold(0.0, |max: f64, t| max.max(*t));
    assert!(balance.iter().all(|b| b.abs() < 1e-7 * largest));
}

/// Impacts 1 µs apart, and a gimbal next to its lock, which turns at 2e7 rad/s.
#[test]
fn what_takes_too_many_steps_is_refused() {
    let gap = "bodies.ground.points = { O = [0, 0] }\n\
        bodies.block = { points = { P = [0, 0] }, mass = 1.0, center = \"P\", inertia = 0.01 }\n\
        joints.G = { prismatic = [\"ground.O\", \"block.P\"], axis = [0, 1] }\n\
        actuators.x = { length = \"G\" }\n\
        assembly.x = 5e-7\n\
        stops.s = { coordinate = \"x\", min = 0, max = 1e-6, restitution = 1 }\n\
        motion = { initial-velocity = 1.0, duration = 1.0 }\n";
    let (_, run) = simulate(gap, &[]);
    assert_eq!(run.status, Some(1), "{}", run.out);
    assert!(
        message(&run).contains("more than 100000 events happen"),
        "{}",
        run.err
    );
    let oscillator = "bodies.ground.points = { O = [0, 0] }\n\
        bodies.block = { points = { P = [0, 0] }, mass = 1.0, center = \"P\", inertia = 0.01 }\n\
        joints.G = { prismatic = [\"ground.O\", \"block.P\"], axis = [0, 1] }\n\
        actuators.x = { length = \"G\" }\n\
        assembly.x = 0.1\n\
        loads.stiff = { force = \"block.P\", direction = [0, 1], magnitude = \"-1e16*x - 1e-9*x.velocity\" }\n\
        motion = { initial-velocity = 1.0, duration = 1.0 }\n";
    let (_, run) = simulate(oscillator, &["--method", "dop853"]);
    assert_eq!(run.status, Some(1), "{}", run.out);
    let said = message(&run);
    assert!(
        said.contains("2000000 steps are not enough: after 100000, about "),
        "{said}"
    );
}
