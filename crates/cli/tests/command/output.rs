//! Which files a command writes, and what stays when it is killed.

use crate::test_dir::TestDir;
use std::fs;
use std::process::Stdio;
use std::thread::sleep;
use std::time::Duration;

fn single_dwell() -> String {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation");
    format!("{root}/single-dwell/scene.toml")
}

#[test]
fn only_the_pictures_that_are_wanted_are_drawn_and_shown() {
    let dir = TestDir::new();
    for (wanted, pictures) in [("none", 0), ("main", 4), ("all", 10)] {
        let scene = single_dwell();
        let run = dir.run(&["simulate", &scene, "--out", wanted, "--pictures", wanted]);
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
        let is_picture = |file: &&String| file.ends_with(".png") || file.ends_with(".gif");
        let files = dir.files(wanted);
        let drawn: Vec<&String> = files.iter().filter(is_picture).collect();
        assert_eq!(drawn.len(), pictures, "{drawn:?}");
        assert_eq!(
            run.out.contains("--pictures all draws the others"),
            wanted == "main"
        );
        let page = fs::read_to_string(dir.0.join(wanted).join("single-dwell-motion.md")).unwrap();
        let is_shown = |file: &str| page.contains(&format!("({file})"));
        // The animation is in no page.
        let shown = drawn.iter().filter(|file| is_shown(file)).count();
        assert_eq!(shown, pictures - usize::from(wanted == "all"));
        assert_eq!(page.matches("![").count(), shown, "no picture is missing");
        let time = run.time.unwrap();
        for stage in ["computing", "drawing", "writing"] {
            assert!(time.contains(stage), "{time}");
        }
    }
    // Numbers do not depend on pictures.
    let table = |folder: &str| fs::read(dir.0.join(folder).join("single-dwell-motion.csv"));
    assert_eq!(table("none").unwrap(), table("all").unwrap());
}

#[test]
fn a_killed_command_leaves_nothing_behind_after_the_next() {
    let dir = TestDir::new();
    let scene = single_dwell();
    let arguments = ["reduce", &scene, "--out", "o"];
    let whole = dir.run(&arguments);
    assert_eq!((whole.status, whole.err.as_str()), (Some(0), ""));
    let files = dir.contents();
    let mut killed = 0;
    for kill in 0..36 {
        let mut command = dir.command(&arguments);
        let mut run = command
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        // Until some file is unfinished, or for longer.
        let unfinished = dir.0.join("o/.dwell/unfinished-0/0");
        while run.try_wait().unwrap().is_none() && !unfinished.exists() {
            sleep(Duration::from_micros(50));
        }
        sleep(Duration::from_micros(20 * kill));
        killed += usize::from(run.try_wait().unwrap().is_none());
        let _ = run.kill();
        run.wait().unwrap();
        let now = dir.contents();
        let of_users = |name: &&String| !name.starts_with("o/.dwell/unfinished");
        for name in now.keys().filter(of_users) {
            assert_eq!(now.get(name), files.get(name), "{name} is half a file");
        }
    }
    assert!(killed >= 10, "killed but {killed} times");
    dir.run(&arguments);
    assert_eq!(dir.contents(), files);
}

#[test]
fn two_scenes_of_one_name_do_not_share_a_file() {
    let dir = TestDir::new();
    let text = fs::read_to_string(single_dwell()).unwrap();
    dir.put("one/arm.toml", &text);
    dir.put("two/arm.toml", &text);
    dir.put("one/arm", &text);
    let run = |scene: &str| dir.run(&["reduce", scene, "--out", "o", "--pictures", "none"]);
    assert_eq!(run("one/arm.toml").status, Some(0));
    let files = dir.contents();
    for other in ["two/arm.toml", "one/arm"] {
        let refused = run(other);
        assert_eq!(refused.status, Some(2));
        assert!(
            refused.err.contains("another scene called `arm`"),
            "{}",
            refused.err
        );
        assert!(refused.err.contains("--out"), "{}", refused.err);
        assert_eq!(dir.contents(), files);
    }
    assert_eq!(run("one/arm.toml").status, Some(0));
}

#[test]
fn points_and_bodies_of_like_names_have_pictures_of_their_own() {
    let dir = TestDir::new();
    let pendulum = |name: &str| {
        format!(
            "[bodies.{name}]\npoints = {{ A = [0, 0], B-C = [1, 0], C = [2, 0], c = [3, 0] }}\n"
        )
    };
    let scene = format!(
        "[bodies.ground]\npoints = {{ A = [0, 0] }}\n{}{}[joints]\nA = {{ revolute = [\"ground.A\", \"crank.A\"] }}\n\
         W = {{ weld = [\"crank.A\", \"crank-B.A\"] }}\n[actuators]\nphi = {{ angle = [\"ground\", \"crank\"] }}\n\
         [requests]\npaths = [\"crank.B-C\", \"crank-B.C\", \"crank.C\", \"crank.c\"]\n",
        pendulum("crank"),
        pendulum("crank-B"),
    );
    dir.put("hostile.toml", scene);
    let run = dir.run(&[
        "kinematics",
        "hostile.toml",
        "--out",
        "o",
        "--pictures",
        "all",
    ]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let mut pictures = dir.files("o");
    pictures.retain(|file| file.contains("-path-"));
    let expected = [
        "path-crank-B.C",
        "path-crank.B-C",
        "path-crank.C",
        "path-crank.c~",
    ];
    let expected = expected.map(|name| format!("hostile-kinematics-{name}.png"));
    assert_eq!(pictures, expected);
}
