//! Scenes in space: what `check` says of them, and what is refused.

use crate::messages::Group;
use crate::test_dir::TestDir;
use std::fmt::Write as _;

fn scene(name: &str) -> String {
    let path = format!(
        "{}/../../validation/spatial/{name}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    std::fs::read_to_string(path).unwrap()
}

/// A scene with one piece of text, which it must contain once, replaced.
fn changed(name: &str, old: &str, new: &str) -> String {
    let text = scene(name);
    assert_eq!(text.matches(old).count(), 1, "`{old}` once in {name}");
    text.replacen(old, new, 1)
}

#[test]
fn checks_say_what_is_determined_and_what_turns_idly() {
    let dir = TestDir::new();
    let mut text = String::new();
    for name in ["bricard-a04", "rssr", "governor"] {
        dir.put("scene.toml", scene(name));
        let run = dir.run(&["check", "scene.toml", "--name", name]);
        assert_eq!(run.status, Some(0), "{run:?}");
        let _ = writeln!(text, "# {name}\n{}", run.out.trim_end());
    }
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("check-in-space", text));
}

#[test]
fn what_is_wrong_in_space_is_said_where_it_is() {
    let mut group = Group::new();
    group.scene("nothing does work in a cycle", "cycle", scene("rssr"));
    let held = format!(
        "{}push = {{ joint-torque = \"A\", magnitude = 30 }}\n",
        scene("rssr")
    );
    group.scene("no balance", "linearise", held);
    group.scene("two actuators", "reduce", scene("governor"));
    let undriven = changed("rssr", "q = { angle = \"A\" }\n", "");
    group.scene(
        "nothing drives it",
        "check",
        undriven.replace("q = 0\n", ""),
    );
    let wrong = changed("bennett", "D = [0.4, 0, 0]", "D = [0.4001, 0, 0]");
    group.scene("a length that disagrees", "check", wrong);
    let far = changed("slider-crank-haug", "B = [-0.15, 0, 0]", "B = [0.08, 0, 0]");
    group.scene("too short a rod", "check", far);
    let coupled = changed(
        "rssr",
        "[0.0002, 0.0045, 0.0045]",
        "[0.0002, 0.0045, 0.0046]",
    );
    group.scene("a rod that is not round", "check", coupled);
    group.check("space");
}
