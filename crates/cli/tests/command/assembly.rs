//! Where a mechanism is assembled, where its range ends, and what the commands say about both.

use crate::test_dir::{Run, TestDir, home};

/// A four-bar of these lengths in m (ground, crank, coupler, rocker), a crank at `phi` and a coupler at about `coupler`, rad.
fn four_bar(
    [ground, crank, coupler, rocker]: [f64; 4],
    phi: f64,
    guess: f64,
    rest: &str,
) -> String {
    format!(
        r#"
title = "Four-bar"
[bodies]
ground.points = {{ A = [0, 0], D = [{ground}, 0] }}
crank = {{ points = {{ A = [0, 0], B = [{crank}, 0] }}, mass = 1, center = "A", inertia = 0.5 }}
coupler = {{ points = {{ B = [0, 0], C = [{coupler}, 0] }}, mass = 0.2, center = [0.1, 0], inertia = 1e-3 }}
rocker.points = {{ D = [0, 0], C = [{rocker}, 0] }}
[joints]
A = {{ revolute = ["ground.A", "crank.A"] }}
B = {{ revolute = ["crank.B", "coupler.B"] }}
C = {{ revolute = ["coupler.C", "rocker.C"] }}
D = {{ revolute = ["ground.D", "rocker.D"] }}
[actuators]
phi = {{ angle = ["ground", "crank"] }}
[assembly]
phi = {phi}
coupler = {guess}
{rest}
"#
    )
}

fn run(text: &str, arguments: &[&str]) -> Run {
    let dir = TestDir::new();
    dir.put("s.toml", text);
    let scene = [
        &arguments[..1],
        &["s.toml"],
        &arguments[1..],
        &["--out", "o"],
    ]
    .concat();
    dir.run(&scene)
}

/// What is printed, without the breaks and marks of a drawn message.
fn plain(run: &Run) -> String {
    let text = format!("{} {}", run.out, run.err);
    let words = text.split_whitespace().filter(|word| *word != "│");
    words.collect::<Vec<_>>().join(" ")
}

/// The coupler is 30° from where it was said to be: every command says so, once.
#[test]
fn every_command_says_where_the_assembly_mode_is_far_from_the_given_angles() {
    let drive = "[loads]\nweight = { gravity = [0, -9.81] }\n[drives]\nm = { motor = \"phi\", torque-constant = 1.0, resistance = 1.0, voltage = 20.0 }\n";
    let rest = "[motion]\nduration = 0.1\ninitial-velocity = 6.0\n";
    let lengths = [0.4, 0.1, 0.35, 0.3];
    let free = four_bar(lengths, 0.5, 0.2, rest);
    let driven = four_bar(lengths, 0.5, 0.2, &format!("{drive}{rest}"));
    let note = "far from the approximate 11.5° of [assembly]";
    for (text, arguments) in [
        (&free, &["check"][..]),
        (&free, &["kinematics"]),
        (&free, &["reduce"]),
        (
            &free,
            &[
                "calibrate",
                "--parameter",
                "crank.inertia",
                "--period",
                "1.05",
            ],
        ),
        (
            &free,
            &["sweep", "--vary", "crank.inertia=0.4,0.5", "--result", "m"],
        ),
        (&driven, &["simulate"]),
        (&driven, &["cycle"]),
        (&driven, &["equilibria"]),
        (&driven, &["linearise", "--about", "initial"]),
    ] {
        let run = run(text, arguments);
        let found = plain(&run);
        assert_eq!(found.matches(note).count(), 1, "{arguments:?}: {found}");
        assert_eq!(run.status, Some(0), "{arguments:?}: {found}");
    }
}

/// The names of the two ends of a range as `check` prints them.
fn ends(text: &str) -> Vec<String> {
    let out = run(text, &["check"]).out;
    let lines = out.lines().map(str::trim);
    let is_end =
        |line: &&str| line.starts_with("limit position") || line.starts_with("change point");
    let name = |line: &str| line.split(", where").next().unwrap_or_default().to_owned();
    lines.filter(is_end).map(name).collect()
}

/// `check` and `kinematics` name the position at which a range ends in the same words, with the same digits.
#[test]
fn the_end_of_a_range_has_one_name() {
    let limited = [0.4, 0.3, 0.35, 0.25];
    let parallelogram = [0.4, 0.2, 0.4, 0.2];
    for (lengths, upper) in [
        (
            limited,
            "limit position of `coupler`, `rocker` at phi = 2.046915388 rad (117.28°)",
        ),
        (
            parallelogram,
            "change point of `coupler`, `rocker` at phi = 3.1415926",
        ),
    ] {
        let text = four_bar(lengths, 0.5, 0.0, "[coordinate-sweep]\nphi = [0.5, 6.0]\n");
        let ends = ends(&text);
        assert_eq!(ends.len(), 2, "{ends:?}");
        assert!(ends[1].starts_with(upper), "{ends:?}");
        let swept = run(&text, &["kinematics"]);
        assert_eq!(swept.status, Some(1), "{}", swept.err);
        let message = plain(&swept);
        assert!(
            message.contains(&format!("the {} is reached", ends[1])),
            "{message}"
        );
    }
}

/// A first position outside the range is refused with the ends that `check` prints.
#[test]
fn a_start_outside_the_range_names_its_ends() {
    let sweep = "[coordinate-sweep]\nphi = [2.5, 6.0]\n";
    let text = four_bar([0.4, 0.3, 0.35, 0.25], 0.5, 0.0, sweep);
    let range = "0.000000 to 2.046915 rad (0.00° to 117.28°)";
    let checked = plain(&run(&text, &["check"]));
    assert!(
        checked.contains(&format!("phi ranges from {range}")),
        "{checked}"
    );
    let refused = run(&text, &["kinematics"]);
    assert!(
        plain(&refused).contains(&format!("outside the range of {range}")),
        "{}",
        refused.err
    );
}

const BOOM: &str = r#"
title = "Boom"
[bodies]
ground.points = { O = [0, 0], P = [0.8, -0.4] }
boom = { points = { O = [0, 0], L = [1.4, -0.2] }, mass = 100, center = [1.5, 0], inertia = 75 }
[joints]
O = { revolute = ["ground.O", "boom.O"] }
[actuators]
lift = { length = ["ground.P", "boom.L"] }
[assembly]
boom = 0.5
[loads]
weight = { gravity = [0, -9.81] }
[motion]
duration = 0.1
"#;

/// The length of a cylinder follows from the angle of what it lifts: the boom stands at exactly 0.5 rad.
#[test]
fn the_length_of_a_cylinder_follows_from_an_approximate_angle() {
    let checked = run(BOOM, &["check"]);
    assert_eq!(checked.status, Some(0), "{}", checked.err);
    let angle = checked
        .out
        .lines()
        .find(|l| l.trim_start().starts_with("boom "));
    assert!(
        angle.is_some_and(|l| l.contains("0.500000 rad")),
        "{}",
        checked.out
    );
    assert_eq!(run(BOOM, &["simulate"]).status, Some(0));
    // Without the angle nothing says where it stands.
    let unknown = run(&BOOM.replace("boom = 0.5\n", ""), &["check"]);
    assert_eq!(unknown.status, Some(2));
    let message = plain(&unknown);
    assert!(
        message.contains("the length of `lift` at the start is not given"),
        "{message}"
    );
    assert!(
        message.contains("or the approximate angles of the bodies"),
        "{message}"
    );
    // A given length is exact, whatever the angle says.
    let given = run(
        &BOOM.replace("boom = 0.5\n", "boom = 0.5\nlift = 1.1\n"),
        &["check"],
    );
    assert!(!given.out.contains("0.500000 rad"), "{}", given.out);
}

/// A misspelt body is one of its own, which no joint holds.
#[test]
fn a_body_in_no_joint_may_be_a_misspelt_one() {
    let text = BOOM.replace("[joints]", "bom.points = { T = [3, 0] }\n[joints]");
    let message = plain(&run(&text, &["check"]));
    assert!(message.contains("body `bom` is in no joint"), "{message}");
    assert!(message.contains("did you mean `boom`?"), "{message}");
}

/// Joints that are written twice are redundant, wherever they stand: a distance cannot place a body before its pins do.
#[test]
fn joints_written_twice_may_stand_before_the_others() {
    let path = home().join("validation/massless-coupler/scene.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let twins = "[joints]\n\
        twin = { revolute = [\"ground.A\", \"crank.A\"] }\n\
        link-twin = { distance = [\"crank.B\", \"rocker.C\"], length = 360 }\n\
        joint-twin = { weld = [\"rocker.W\", \"arm.W\"], angle = -35 }\n";
    let checked = run(&text.replace("[joints]\n", twins), &["check"]);
    assert_eq!(checked.status, Some(0), "{}", checked.err);
    assert!(
        checked
            .out
            .contains("6 constraints are redundant, and consistent"),
        "{}",
        checked.out
    );
}
