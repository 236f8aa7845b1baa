//! Analyses that reject sticking friction, and mistakes in scenes: messages name the joint, with a place in the file.

use dwell_scene::PlaneScene;
use dwell_study::{OperatingPoint, compute_linearisation};

const SCENE: &str = r#"
[bodies.ground]
points = { A = [0, 0] }
[bodies.bar]
points = { A = [0, 0] }
mass = 2.0
center = [0.3, 0]
inertia = 0.05
[joints]
pin = { revolute = ["ground.A", "bar.A"] }
[actuators.phi]
angle = ["ground", "bar"]
[loads]
weight = { gravity = [0, -9.81] }
[friction]
pin = { coefficient = 0.2, radius = 0.02 }
[motion]
initial-velocity = 1
duration = 1
"#;

/// Message, help and labels of the first error of a scene.
fn error_of(text: &str) -> String {
    let error = PlaneScene::parse("scene.toml", text).expect_err("an error");
    format!("{error:?}")
}

#[test]
fn a_linearised_motion_names_the_joint_that_holds() {
    let scene = PlaneScene::parse("scene.toml", SCENE).expect("a scene");
    let error = compute_linearisation(&scene, OperatingPoint::InitialState);
    let Err(error) = error else {
        panic!("it is refused");
    };
    let text = format!("{error:?}");
    assert!(
        text.contains("the dry friction of joint `pin` holds at rest"),
        "{text}"
    );
    assert!(text.contains("regularization-speed"), "{text}");
}

#[test]
fn a_static_coefficient_below_the_other_is_refused() {
    let text = SCENE.replace(
        "coefficient = 0.2,",
        "coefficient = 0.2, static-coefficient = 0.1,",
    );
    let error = error_of(&text);
    assert!(error.contains("is below its `coefficient` 0.2"), "{error}");
}

#[test]
fn a_static_coefficient_beside_a_regularization_speed_has_no_effect_and_says_so() {
    let text = SCENE.replace(
        "coefficient = 0.2,",
        "coefficient = 0.2, static-coefficient = 0.3, regularization-speed = 0.1,",
    );
    let scene = PlaneScene::parse("scene.toml", &text).expect("a scene");
    let said = format!("{:?}", scene.warnings);
    assert!(said.contains("does not hold at rest"), "{said}");
    // Without it nothing is said.
    let plain = PlaneScene::parse("scene.toml", SCENE).expect("a scene");
    assert!(plain.warnings.is_empty());
}
