//! Files: those that cannot be read, and the scenes of the validation.

use super::*;
use crate::MotionDuration;
use std::path::{Path, PathBuf};

fn folder() -> PathBuf {
    // One folder for each test thread and process.
    let unique = format!(
        "dwell-scene-{}-{:?}",
        std::process::id(),
        std::thread::current().id()
    );
    let folder = std::env::temp_dir().join(unique);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

#[test]
fn a_file_that_cannot_be_read_says_why() {
    let folder = folder();
    let read = |name: &str| {
        let error = PlaneScene::read(folder.join(name)).unwrap_err();
        render(&error);
        let display_path = folder.display().to_string();
        let help = error.help.unwrap_or_default();
        format!("{} ⇒ {help}", error.message).replace(&display_path, "DIR")
    };
    assert_eq!(read("none.toml"), "there is no file `DIR/none.toml` ⇒ ");
    assert_eq!(read(""), "`DIR/` is a folder ⇒ give the scene file itself");
    std::fs::write(folder.join("scene.toml"), "").unwrap();
    assert_eq!(
        read(""),
        "`DIR/` is a folder ⇒ did you mean `DIR/scene.toml`?"
    );
    assert_eq!(
        read("scene"),
        "there is no file `DIR/scene` ⇒ did you mean `DIR/scene.toml`?"
    );
    assert!(read("scene.toml").starts_with("the scene is empty"));
    std::fs::write(folder.join("latin.toml"), b"title = \"K\xf6rper\"\n").unwrap();
    assert_eq!(
        read("latin.toml"),
        "`DIR/latin.toml` is not UTF-8 text ⇒ save it as UTF-8"
    );
    let error = PlaneScene::read(folder.join("latin.toml")).unwrap_err();
    assert_eq!(error.labelled(), [("\u{fffd}", "not a character")]);
    for bytes in [&b"\x7fELF\0\xff"[..], b"title\0"] {
        std::fs::write(folder.join("program"), bytes).unwrap();
        assert_eq!(
            read("program"),
            "`DIR/program` is not a text file ⇒ if this is a scene, save it as UTF-8"
        );
    }
    std::fs::remove_dir_all(folder).unwrap();
}

#[test]
fn a_scene_is_named_after_its_file_or_folder() {
    let folder = folder();
    std::fs::create_dir_all(folder.join("press")).unwrap();
    for file in ["press/scene.toml", "press/variant 2.toml"] {
        std::fs::write(folder.join(file), WHOLE).unwrap();
    }
    let name = |file: &str| PlaneScene::read(folder.join(file)).unwrap().file.name;
    assert_eq!(name("press/scene.toml"), "press");
    assert_eq!(name("press/../press/scene.toml"), "press");
    assert_eq!(name("press/variant 2.toml"), "variant 2");
    std::fs::remove_dir_all(folder).unwrap();
    assert_eq!(
        PlaneScene::parse("a/b/scene.toml", WHOLE).unwrap().name,
        "b"
    );
    assert_eq!(
        PlaneScene::parse("scene.toml", WHOLE).unwrap().name,
        "scene"
    );
    assert_eq!(PlaneScene::parse("", WHOLE).unwrap().name, "scene");
}

fn case(name: &str) -> PlaneScene {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../validation");
    PlaneScene::read(root.join(name).join("scene.toml"))
        .map_err(|e| render(&e))
        .unwrap()
}

#[test]
fn single_dwell() {
    let scene = case("single-dwell");
    assert_eq!(scene.name, "single-dwell");
    assert!(scene.note.as_deref().unwrap().contains("Figure 2"));
    let m = &scene.mechanism;
    assert_eq!((m.bodies.len(), m.joints.len()), (6, 7));
    let mass = |name: &str| {
        let body = m.bodies.iter().position(|b| b.name == name).unwrap();
        let mass = scene.masses[body];
        (mass.mass, mass.center.x, mass.inertia)
    };
    let bar = |mass: f64, length: f64| mass * length * length / 12.0;
    assert_eq!(mass("crank"), (20.0, 0.0, 0.626));
    assert_eq!(mass("coupler"), (1.5, 0.25, bar(1.5, 0.5)));
    assert_eq!(mass("rocker"), (0.75, 0.125, bar(0.75, 0.25)));
    assert!((mass("guide").2 - bar(2.1, 0.7)).abs() < 1e-16);
    assert_eq!(mass("guide").1, 0.35);
    assert_eq!(mass("slider"), (0.5, 0.0, 0.0));
    assert_eq!(m.joints[6].points[0].x, 0.0);
    let requested = &scene.requests.reactions;
    assert_eq!(requested.len(), 1);
    assert_eq!(m.reaction_name(requested[0]), "slide.normal");
    let motion = scene.motion.as_ref().unwrap();
    assert_eq!(motion.duration, MotionDuration::Periods(10.0));
    assert_eq!(
        (motion.initial_coordinates[0], motion.initial_velocities[0]),
        (0.0, 1.0)
    );
    let calibration = scene.calibration.as_ref().unwrap();
    assert_eq!(scene.value(&calibration.path).unwrap(), 0.626);
    assert_eq!(scene.unit_of(&calibration.path), "kg m2");
}

#[test]
fn crank_rocker() {
    let scene = case("crank-rocker");
    assert_eq!(scene.masses[2].inertia, 2.0 * 3.5 * 3.5 / 12.0);
    assert_eq!(scene.masses[1].inertia, 1.0 / 12.0);
    assert_eq!(
        scene.assembly.coordinates,
        [60.0 * std::f64::consts::PI / 180.0]
    );
    assert_eq!(scene.motion.unwrap().initial_velocities, [10.0]);
}

#[test]
fn slotted_rocker() {
    let scene = case("slotted-rocker");
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-16, "{a} {b}");
    close(scene.masses[1].inertia, 700e-6);
    close(scene.masses[3].mass, 1.5);
    close(scene.masses[3].center.y, -0.015);
    assert!(scene.points[0][1].1.x.abs() > scene.points[1][1].1.x + 0.02);
}

#[test]
fn class_three_six_bar() {
    let scene = case("class-three-six-bar");
    assert_eq!(scene.mechanism.bodies.len(), 6);
    assert_eq!(scene.mechanism.joints.len(), 7);
    assert_eq!(
        scene
            .mechanism
            .body_name(scene.mechanism.actuators[0].bodies[1]),
        "link5"
    );
    assert_eq!(scene.assembly.coordinates, [-0.6]);
    assert_eq!(scene.requests.reactions, scene.mechanism.reactions());
    assert_eq!(scene.motion, None);
}
