//! Tests of the whole crate: text in, data or messages out.

mod content;
mod errors;
mod files;
mod format;
mod free_motion;
mod machine;
mod mutations;
mod renamed_keys;
mod space;
mod suspicious_numbers;
mod values;

use crate::{PlaneScene, Scene, SceneError};
use miette::{GraphicalReportHandler, GraphicalTheme};

/// A scene that uses the whole language.
const WHOLE: &str = r#"
title = "Slider-crank"
note = "For tests."
[units]
length = "mm"
inertia = "kg mm2"
angle = "deg"
[bodies.ground]
points = { A = [0, 0], S = [0, 10] }
[bodies.crank]
points = { A = [0, 0], B = [100, 0] }
mass = 2.0
center = [50, 1]
inertia = 1666.0
[bodies.rod]
points = { B = [0, 0], P = [300, 0] }
mass = 1
center = "B"
[bodies.piston]
points = { P = [0, 0] }
mass = 0.5
center = "P"
[joints]
A = { revolute = ["ground.A", "crank.A"] }
B = { revolute = ["crank.B", "rod.B"] }
P = { revolute = ["rod.P", "piston.P"] }
slide = { prismatic = ["ground.S", "piston.P"], axis = [3, 4] }
[actuators.phi]
angle = ["ground", "crank"]
[assembly]
phi = 90
rod = -20
[requests]
reactions = ["slide", "A.x", "slide.normal"]
paths = ["rod.P", "crank.B"]
dwell = { body = "rod", relative-band = 0.02 }
[motion]
initial-coordinate = 30
initial-velocity = { phi = 180 }
periods = 2
[calibration]
parameter = "crank.inertia"
period = 5.42
"#;

/// Another one, with what the first has not: every kind of joint and load, laws and tables.
const MACHINE: &str = include_str!("machine.toml");

/// And one for what moves freely: drives, friction, led actuators, events.
const FREE_MOTION: &str = include_str!("driven.toml");

/// And one in space.
const IN_SPACE: &str = include_str!("space.toml");

/// `WHOLE` with one piece of text, which it must contain once, replaced.
fn with(old: &str, new: &str) -> String {
    changed(WHOLE, old, new)
}

/// `scene` with one piece of text, which it must contain once, replaced.
fn changed(scene: &str, old: &str, new: &str) -> String {
    assert_eq!(scene.matches(old).count(), 1, "`{old}` once in the scene");
    scene.replacen(old, new, 1)
}

/// Compares what is written at `path` (from the crate) with what it should be, or writes it if
/// the environment says `DWELL_WRITE=1`.
fn same_as_written(path: &str, should: &str) {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    if std::env::var_os("DWELL_WRITE").is_some() {
        std::fs::write(&path, should).unwrap();
    }
    let is = std::fs::read_to_string(&path).unwrap_or_default();
    let differs = is.lines().zip(should.lines()).find(|(a, b)| a != b);
    assert!(
        is == should,
        "{} is not what it should be; first difference: {differs:?}. DWELL_WRITE=1 writes it.",
        path.display()
    );
}

fn parse(text: &str) -> Result<PlaneScene, SceneError> {
    PlaneScene::parse("test.toml", text)
}

/// Draws the error as the command does, and holds every label to the text.
fn render(error: &SceneError) -> String {
    for one in error.errors() {
        let text = one.text.as_ref().map_or("", |t| t.inner());
        for label in &one.labels {
            let range = label.offset()..label.offset() + label.len();
            assert!(
                text.get(range.clone()).is_some(),
                "{range:?} in {}",
                one.message
            );
        }
        assert!(!one.message.is_empty());
    }
    let handler = GraphicalReportHandler::new_themed(GraphicalTheme::unicode_nocolor());
    let mut drawn = String::new();
    handler.render_report(&mut drawn, error).unwrap();
    drawn
}

/// Message, labelled text, its label and help of each error, one line each.
fn messages(text: &str) -> Vec<String> {
    let Err(error) = Scene::parse("test.toml", text) else {
        return vec!["nothing is wrong".to_owned()];
    };
    assert!(!render(&error).is_empty());
    let line = |e: &SceneError| {
        let labels: Vec<_> = e
            .labelled()
            .iter()
            .map(|(slice, label)| format!("«{slice}» {label}"))
            .collect();
        let help = e
            .help
            .as_deref()
            .map_or(String::new(), |h| format!(" ⇒ {h}"));
        format!("{} | {}{help}", e.message, labels.join(" | "))
    };
    error.errors().iter().map(line).collect()
}
