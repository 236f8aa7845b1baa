//! The hints that messages request for scenes with several assembly modes; with them, the scenes are accepted.

use crate::table::scene;
use dwell_study::{StudyError, check};

/// A slider on the x axis at 500 mm from a point 300 mm above it: at 400 mm or −400 mm.
const SLIDER: &str = r#"
units = { length = "mm", inertia = "kg mm2" }
[bodies.ground.points]
O = [0, 0]
H = [0, 300]
[bodies.slider]
mass = 1.0
center = "P"
inertia = 0.0
points = { P = [0, 0] }
[joints.slide]
prismatic = ["ground.O", "slider.P"]
axis = [1, 0]
[actuators.l]
length = ["ground.H", "slider.P"]
[assembly]
l = 500
"#;

/// A body whose angle is driven hangs on two distances.
const HUNG: &str = r#"
units = { angle = "deg" }
[bodies.ground.points]
A = [-0.6, 0]
B = [0.6, 0]
[bodies.body]
mass = 1.0
center = "P"
inertia = 0.1
points = { P = [0, 0] }
[joints]
body = { distance = ["ground.A", "body.P"], length = 1.0 }
right = { distance = ["ground.B", "body.P"], length = 1.0 }
[actuators.phi]
angle = ["ground", "body"]
[assembly]
"#;

/// The help of the refusal.
fn help(text: &str) -> String {
    match check(&scene(text)) {
        Err(StudyError::Scene(error)) => error.help.unwrap(),
        Err(error) => panic!("{error}"),
        Ok(_) => panic!("not refused"),
    }
}

#[test]
fn a_travel_is_asked_for_in_the_units_of_the_scene() {
    let help = help(SLIDER);
    let modes = ["`slide = 400`", "`slide = -400`"];
    assert!(modes.iter().all(|mode| help.contains(mode)), "{help}");
    assert!(
        help.starts_with("add ") && help.ends_with(" to [assembly]"),
        "{help}"
    );
    for (hint, other) in [("350", "-0.4000"), ("-350", "0.4000")] {
        let summary = check(&scene(&format!("{SLIDER}slide = {hint}\n")))
            .unwrap()
            .summary;
        assert!(
            summary.contains(&format!("other assembly mode: slide = {other} m\n")),
            "{summary}"
        );
    }
}

/// The first distance has the name of a body, which takes precedence: the hint for the other is asked for.
#[test]
fn a_direction_is_asked_for_in_the_units_of_the_scene() {
    let help = help(HUNG);
    // The cosine of the direction is −0.6.
    let modes = ["`right = 126.87`", "`right = -126.87`"];
    assert!(modes.iter().all(|mode| help.contains(mode)), "{help}");
    let summary = check(&scene(&format!("{HUNG}right = 100\n")))
        .unwrap()
        .summary;
    assert!(summary.contains("right = -2.2143 rad\n"), "{summary}");
}

/// A revolute joint takes no hint.
#[test]
fn nothing_can_be_told_of_a_pin() {
    let text = HUNG.replace(
        "[actuators",
        "pin = { revolute = [\"ground.A\", \"body.P\"] }\n[actuators",
    );
    let error =
        dwell_scene::PlaneScene::parse("test.toml", &format!("{text}pin = 3\n")).unwrap_err();
    assert!(error.message.contains("`pin`"), "{}", error.message);
    let help = error.help.unwrap();
    assert!(
        help.contains("`right`") && !help.contains("`pin`"),
        "{help}"
    );
}
