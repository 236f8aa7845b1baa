//! `dwell import`: the scenes that it writes, and its refusals.

use crate::test_dir::{TestDir, home};
use std::fs;

fn model(name: &str) -> String {
    let path = home().join("validation/imported").join(name);
    path.to_str().unwrap().to_owned()
}

#[test]
fn every_command_accepts_an_imported_scene() {
    let dir = TestDir::new();
    let run = dir.run(&["import", &model("m1-fourbar.xml"), "--out", "scene.toml"]);
    assert_eq!(run.status, Some(0), "{}", run.err);
    assert!(
        run.err
            .contains("m1-fourbar.xml:24: derived: `C` on rocker"),
        "{}",
        run.err
    );
    for command in ["check", "kinetostatics"] {
        let run = dir.run(&[command, "scene.toml", "--pictures", "none"]);
        assert_ne!(run.status, Some(2), "{command}: {}", run.err);
    }
    // The folder of `--out` gets the name of the model, and only an import of the same model is replaced.
    let again = dir.run(&["import", &model("m1-fourbar.xml")]);
    assert_eq!(again.status, Some(0), "{}", again.err);
    assert_eq!(
        dir.files("reports")
            .iter()
            .filter(|file| file.ends_with(".toml"))
            .count(),
        1
    );
    fs::write(dir.0.join("scene.toml"), "title = \"Mine\"").unwrap();
    let kept = dir.run(&["import", &model("m1-fourbar.xml"), "--out", "scene.toml"]);
    assert_eq!(kept.status, Some(2));
    assert!(kept.err.contains("exists already"), "{}", kept.err);
}

#[test]
fn a_model_that_loses_something_is_imported_only_if_that_is_allowed() {
    let dir = TestDir::new();
    let unsupported = model("x1-unsupported.xml");
    let run = dir.run(&["import", &unsupported, "--out", "x1.toml"]);
    assert_eq!(run.status, Some(2));
    assert!(
        run.err
            .contains("x1-unsupported.xml:23: muscle actuator of B: left out"),
        "{}",
        run.err
    );
    assert!(run.err.contains("--allow"), "{}", run.err);
    assert!(!dir.0.join("x1.toml").exists());
    let run = dir.run(&["import", &unsupported, "--out", "-", "--allow"]);
    assert_eq!(run.status, Some(0), "{}", run.err);
    assert!(run.out.contains("poly = { coupling"), "{}", run.out);
}

#[test]
fn errors_of_an_import_say_what_to_give_and_where_the_file_is_wrong() {
    let dir = TestDir::new();
    let run = dir.run(&["import", &model("m4-sixbar.xml"), "--out", "-"]);
    assert_eq!(run.status, Some(2));
    assert!(
        run.err.contains("1 degree of freedom and no drive") && run.err.contains("A, B, D, E, P"),
        "{}",
        run.err
    );
    fs::write(dir.0.join("wrong.urdf"), "<robot name=\"r\">\n  <link name=\"a\"/>\n  <joint name=\"j\" type=\"revolute\"><parent link=\"b\"/></joint>\n</robot>").unwrap();
    let run = dir.run(&["import", "wrong.urdf"]);
    assert_eq!(run.status, Some(2));
    assert!(
        run.err.contains("there is no link `b`") && run.err.contains("wrong.urdf:3"),
        "{}",
        run.err
    );
}
