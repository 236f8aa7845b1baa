//! Messages for invalid scenes: the catalogue in errors.txt, and further ones.

use super::*;
use std::fmt::Write as _;

/// The catalogue with the messages that are said now: `-` lines are taken out of the scene, `+`
/// lines put in, and what is said about that follows as `=` lines.
fn catalogue(text: &str, scene: &str) -> (String, usize) {
    let (mut now, mut cases) = (String::new(), 0);
    for case in text.split("\n\n") {
        let lines = |sign: char| {
            let lines: Vec<_> = case.lines().filter_map(|l| l.strip_prefix(sign)).collect();
            lines.join("\n")
        };
        let kept: Vec<_> = case.lines().filter(|l| !l.starts_with('=')).collect();
        let _ = writeln!(now, "{}", kept.join("\n"));
        if case.lines().any(|l| l.starts_with('-')) {
            cases += 1;
            for message in messages(&changed(scene, &lines('-'), &lines('+'))) {
                let _ = writeln!(now, "={message}");
            }
        }
        now.push('\n');
    }
    now.pop();
    (now, cases)
}

#[test]
fn every_careless_scene_is_told_what_is_wrong() {
    for (path, text, scene, min_cases) in [
        (
            "src/tests/errors.txt",
            include_str!("errors.txt"),
            WHOLE,
            90,
        ),
        (
            "src/tests/machine.txt",
            include_str!("machine.txt"),
            MACHINE,
            0,
        ),
        (
            "src/tests/driven.txt",
            include_str!("driven.txt"),
            FREE_MOTION,
            35,
        ),
        (
            "src/tests/space.txt",
            include_str!("space.txt"),
            IN_SPACE,
            30,
        ),
    ] {
        let (now, cases) = catalogue(text, scene);
        assert!(cases >= min_cases, "{cases} cases in {path}");
        same_as_written(path, &now);
    }
}

#[test]
fn all_errors_of_a_file_come_at_once_and_in_order() {
    let text = with("mass = 2.0", "mass = -2.0")
        .replace("\"rod.B\"", "\"rod.X\"")
        .replace("periods = 2", "periods = -2")
        .replace("angle = \"deg\"", "angle = \"grad\"");
    let error = parse(&text).unwrap_err();
    assert_eq!(error.message, "the scene has 4 errors");
    let messages: Vec<_> = error.errors().iter().map(|e| e.message.as_str()).collect();
    assert_eq!(
        messages,
        [
            "unknown unit of angle `grad`",
            "the mass of body `crank` is negative",
            "body `rod` has no point `X`",
            "periods in [motion] must be greater than zero",
        ]
    );
}

#[test]
fn too_many_errors_are_counted_not_listed() {
    let keys: String = (0..500).map(|k| format!("key{k} = 1\n")).collect();
    let error = parse(&with("title = \"Slider-crank\"\n", &keys)).unwrap_err();
    assert_eq!(
        error.message,
        "the scene has 500 errors; here are 40 of them"
    );
    assert_eq!(error.errors().len(), 40);
}

#[test]
fn next_to_nothing() {
    let empty = [
        "the scene is empty | «» no bodies, no joints ⇒ a scene has at least [bodies] and [joints]",
    ];
    assert_eq!(messages(""), empty);
    assert_eq!(messages("\u{feff}\n \t\r\n"), empty);
    let comments = messages("# a comment\n");
    assert!(comments[0].starts_with("the scene has nothing but comments"));
    assert!(messages("title = \"t\"")[0].starts_with("the scene has no bodies"));
    assert!(
        messages("[bodies]")[0].starts_with("the scene has no bodies | «bodies» nothing in it")
    );
    let ground = "[bodies.ground]\npoints = { A = [0, 0] }\n[joints]";
    assert!(messages(ground)[0].starts_with("the scene has no joints | «joints» nothing in it"));
}

#[test]
fn nothing_nested_or_long_enough_to_break() {
    let deep = 100_000;
    for text in [
        format!("a = {}", "[".repeat(deep)),
        format!("a = {}", "{ a = ".repeat(deep)),
        format!("{} = 1", vec!["a"; deep].join(".")),
        format!("[{}]", vec!["a"; deep].join(".")),
        format!("{} = 1", "a".repeat(deep)),
        format!("bodies.\"{}\" = 1", "\\u0001".repeat(deep)),
        format!("title = {}", "9".repeat(deep)),
    ] {
        let error = parse(&text).unwrap_err();
        for one in error.errors() {
            assert!(one.message.len() < 1000, "{} characters", one.message.len());
        }
    }
}

/// Drawing a line of a megabyte helps nobody, and drawing a label beyond column 65 535 panics.
#[test]
fn in_a_long_line_the_place_is_said_in_words() {
    let long = format!("x = [{}] 3", "1,".repeat(500_000));
    let error = parse(&long).unwrap_err();
    assert!(render(&error).len() < 1000);
    assert!(
        error
            .message
            .ends_with("(test.toml, line 1, column 1000008)"),
        "{}",
        error.message
    );
    // The line before the one at fault is shown as well.
    let before = format!("note = \"{}\"\nmass = \n", "x".repeat(100_000));
    let message = parse(&before).unwrap_err().message;
    assert!(
        message.ends_with("(test.toml, line 2, column 6)"),
        "{message}"
    );
}

#[test]
fn what_a_terminal_would_obey_is_not_shown_to_it() {
    let error = parse("title = \"a\u{1b}[31mb\u{7}\"").unwrap_err();
    let drawn = render(&error);
    assert!(drawn.contains("a?[31mb?"), "{drawn}");
    let text = with("\"Slider-crank\"", "\"a\\u001b[31m\\tb\\u0007\"");
    assert_eq!(parse(&text).unwrap().title, "a [31m b");
}

#[test]
fn an_error_found_later_points_into_the_file() {
    use crate::SceneLocation::*;
    use dwell_geometry::{ActuatorId, BodyId, JointId};
    let scene = parse(WHOLE).unwrap();
    let (crank, rod, slide, phi) = (BodyId(1), BodyId(2), JointId(3), ActuatorId(0));
    for (location, text) in [
        (Whole, ""),
        (Units, "[units]"),
        (Body(crank), "crank"),
        (Point(crank, 1), "B"),
        (Mass(crank), "2.0"),
        (Inertia(crank), "1666.0"),
        (Center(crank), "[50, 1]"),
        (Joint(slide), "slide"),
        (JointPoint(slide, 1), "\"piston.P\""),
        (Axis(slide), "[3, 4]"),
        (Actuator(phi), "phi"),
        (Assembly, "[assembly]"),
        (AssemblyCoordinate(phi), "phi = 90"),
        (InitialGuess(rod), "rod = -20"),
        (Requests, "[requests]"),
        (Reaction(2), "\"A.x\""),
        (Path(1), "\"crank.B\""),
        (Dwell, "{ body = \"rod\", relative-band = 0.02 }"),
        (Motion, "[motion]"),
        (InitialCoordinate(phi), "30"),
        (InitialVelocity(phi), "180"),
        (Duration, "periods = 2"),
        (Calibration, "\"crank.inertia\""),
        // Not written down: the nearest thing that is.
        (Inertia(rod), "rod"),
        (InitialGuess(crank), "crank"),
        (Axis(JointId(0)), "A"),
        // Not in the scene at all: no panic.
        (Mass(BodyId(99)), ""),
        (JointPoint(slide, 9), "slide"),
        (Reaction(99), "[requests]"),
    ] {
        let error = scene.error(
            "it does not close".to_owned(),
            Some("move it".to_owned()),
            &[(location, "here".to_owned())],
        );
        assert_eq!(error.labelled(), [(text, "here")], "{location:?}");
        assert!(render(&error).contains("it does not close"));
    }
}
