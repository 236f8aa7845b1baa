//! `kinematics`, `statics` and `kinetostatics`: files, headers, exit status, messages.

use crate::test_dir::{FOUR_BAR, LIMITED, TestDir, four_bar_with, home};
use std::fs;

fn case(name: &str) -> String {
    let path = home().join("validation").join(name).join("scene.toml");
    path.to_str().unwrap().to_owned()
}

fn header(dir: &TestDir, file: &str) -> Vec<String> {
    let text = fs::read_to_string(dir.0.join(file)).unwrap();
    let line = text.lines().next().unwrap();
    line.split(',').map(str::to_owned).collect()
}

#[test]
fn kinematics_writes_positions_speeds_and_accelerations() {
    let dir = TestDir::new();
    let scene = case("crank-rocker");
    let run = dir.run(&["kinematics", &scene, "--out", "o", "--pictures", "all"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let files = dir.files("o");
    for file in [
        "-mechanism.png",
        "-angles.png",
        "-transmission-angles.png",
        "-mechanism.gif",
        "-extrema.csv",
        ".csv",
        ".md",
        ".npz",
    ] {
        let file = format!("crank-rocker-kinematics{file}");
        assert!(files.contains(&file), "{file} of {files:?}");
    }
    let header = header(&dir, "o/crank-rocker-kinematics.csv");
    for column in [
        "t [s]",
        "phi [rad]",
        "phi.velocity [rad/s]",
        "phi.acceleration [rad/s2]",
        "coupler.angle [rad]",
        "coupler.angular_velocity [rad/s]",
        "coupler.angular_acceleration [rad/s2]",
        "coupler.velocity_ratio",
        "coupler.C.x [m]",
        "coupler.C.vy [m/s]",
        "coupler.C.ax [m/s2]",
        "C.transmission_angle [rad]",
    ] {
        assert!(header.iter().any(|h| h == column), "{column} of {header:?}");
    }
    assert!(!header.iter().any(|h| h.contains("[N")), "{header:?}");
    assert!(
        run.out.contains("361 positions over one revolution of phi"),
        "{}",
        run.out
    );
    let gif = fs::read(dir.0.join("o/crank-rocker-kinematics-mechanism.gif")).unwrap();
    assert!(gif.starts_with(b"GIF89a"));
}

#[test]
fn statics_writes_forces_without_speeds() {
    let dir = TestDir::new();
    let run = dir.run(&[
        "statics",
        &case("rack-pinion"),
        "--out",
        "o",
        "--points",
        "30",
    ]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let header = header(&dir, "o/rack-pinion-statics.csv");
    for column in [
        "t [s]",
        "phi [rad]",
        "phi.actuator_force [N m]",
        "guide.travel [m]",
        "guide.normal [N]",
        "guide.moment [N m]",
        "mesh.tooth [N]",
        "C.x@pinion [N]",
        "C.magnitude [N]",
        "C.direction [rad]",
        "shaking.fx [N]",
        "shaking.moment [N m]",
    ] {
        assert!(header.iter().any(|h| h == column), "{column} of {header:?}");
    }
    let moving = |h: &String| h.contains("/s") || h.contains("[W]");
    assert!(!header.iter().any(moving), "{header:?}");
    let table = fs::read_to_string(dir.0.join("o/rack-pinion-statics.csv")).unwrap();
    assert_eq!(table.lines().count(), 31);
}

#[test]
fn kinetostatics_writes_forces_power_and_peaks() {
    let dir = TestDir::new();
    let scene = case("boom");
    let run = dir.run(&["kinetostatics", &scene, "--out", "o", "--pictures", "all"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let columns = header(&dir, "o/boom-kinetostatics.csv");
    for column in [
        "t [s]",
        "lift [m]",
        "lift.velocity [m/s]",
        "lift.actuator_force [N]",
        "dig.actuator_force [N]",
        "ram.travel.acceleration [m/s2]",
        "ram.moment [N m]",
        "T.y@stick [N]",
        "bucket.load_force [N]",
        "weight.power [W]",
        "power.actuators [W]",
        "power.loads [W]",
        "power.kinetic [W]",
        "power.residual [W]",
        "energy.kinetic_bodies [J]",
    ] {
        assert!(
            columns.iter().any(|h| h == column),
            "{column} of {columns:?}"
        );
    }
    assert_eq!(
        header(&dir, "o/boom-kinetostatics-extrema.csv"),
        [
            "quantity",
            "unit",
            "min",
            "min at t [s]",
            "max",
            "max at t [s]"
        ]
    );
    for figure in [
        "actuator-forces",
        "reactions",
        "shaking-force",
        "power-balance",
        "path-stick.W",
    ] {
        let file = format!("boom-kinetostatics-{figure}.png");
        assert!(dir.files("o").contains(&file), "{file}");
    }
    let page = fs::read_to_string(dir.0.join("o/boom-kinetostatics.md")).unwrap();
    for words in [
        "moment of barrel on rod, about the joint's point of rod",
        "force between the points; positive pushes them apart",
        "![Power balance](boom-kinetostatics-power-balance.png)",
        "| L.magnitude | N |",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert!(
        run.out.contains("residual of the power balance:"),
        "{}",
        run.out
    );
}

#[test]
fn columns_that_were_asked_for_are_the_table() {
    let dir = TestDir::new();
    let run = dir.run(&["kinetostatics", &case("cam"), "--out", "o"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert_eq!(
        header(&dir, "o/cam-kinetostatics.csv"),
        [
            "t [s]",
            "phi [rad]",
            "phi.actuator_force [N m]",
            "rise [m]",
            "rise.velocity [m/s]",
            "rise.acceleration [m/s2]",
            "contact.force [N]"
        ]
    );
}

#[test]
fn sections_are_tables_and_a_picture() {
    let dir = TestDir::new();
    let motion = "[coordinate-sweep]\nspeed = 2.0\n[loads]\nweight = { gravity = [0, -9.81] }\n[requests]\n\
               sections = [{ body = \"rocker\", from = \"D\", to = \"C\" }]\n";
    dir.put("four.toml", format!("{FOUR_BAR}{motion}"));
    let run = dir.run(&["kinetostatics", "four.toml", "--out", "o"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert_eq!(
        header(&dir, "o/four-kinetostatics-internal-forces-rocker.D.C.csv"),
        ["station [m]", "axial [N]", "shear [N]", "bending [N m]"]
    );
    let envelope = header(
        &dir,
        "o/four-kinetostatics-internal-forces-rocker.D.C.envelope.csv",
    );
    assert_eq!(
        envelope[..3],
        ["station [m]", "axial.min [N]", "axial.max [N]"]
    );
    let picture = "four-kinetostatics-internal-forces-rocker.D.C.png".to_owned();
    assert!(dir.files("o").contains(&picture));
    assert!(
        run.out.contains("bending moment of rocker from D to C"),
        "{}",
        run.out
    );
}

/// Exit status 1: what was found is written, the rest is explained.
#[test]
fn a_motion_that_meets_a_limit_position_keeps_its_results() {
    let dir = TestDir::new();
    let motion = "[prescribed]\nduration = 2.0\npoints = 101\n[prescribed.phi]\nspeed = 0.5\n";
    dir.put(
        "limited.toml",
        format!("{}{motion}", four_bar_with(&LIMITED)),
    );
    for command in ["kinematics", "statics", "kinetostatics"] {
        let run = dir.run(&[command, "limited.toml", "--out", "o"]);
        assert_eq!(run.status, Some(1), "{}", run.err);
        // From 1 rad on, to the limit at 1.3716 rad.
        assert!(run.out.contains("38 of 101 positions"), "{}", run.out);
        let words = run.err.replace("\n  │ ", " ");
        assert!(words.contains("is reached at t = 0.743128 s"), "{words}");
        assert!(
            words.contains("the limit position of `coupler`, `rocker` at phi = 1.37156424 rad"),
            "{words}"
        );
        assert!(words.contains("[prescribed]"), "{words}");
        let table = fs::read_to_string(dir.0.join(format!("o/limited-{command}.csv"))).unwrap();
        assert_eq!(table.lines().count(), 39);
    }
}

/// Exit status 2: nothing is written.
#[test]
fn what_cannot_be_followed_is_refused() {
    let dir = TestDir::new();
    let refused = |scene: String, arguments: &[&str], messages: &[&str]| {
        dir.put("scene.toml", scene);
        let run = dir.run(arguments);
        assert_eq!((run.status, run.out.as_str()), (Some(2), ""), "{}", run.err);
        for words in messages {
            assert!(run.err.contains(words), "{words}: {}", run.err);
        }
        assert!(dir.files("reports").is_empty());
    };
    refused(
        four_bar_with(&[]),
        &["kinetostatics", "scene.toml"],
        &["prescribes no motion", "[prescribed]", "[coordinate-sweep]"],
    );
    let column = "[requests]\nvariables = [\"coupler.angel\"]\n";
    refused(
        four_bar_with(&[]) + column,
        &["kinematics", "scene.toml"],
        &["no column `coupler.angel`", "did you mean `coupler.angle`?"],
    );
    for points in ["1", "-3", "many", "1e9"] {
        let arguments = ["statics", "scene.toml", "--points", points];
        refused(four_bar_with(&[]), &arguments, &["--points"]);
    }
    let range = "[coordinate-sweep]\nphi = [3.0, 4.0]\n";
    refused(
        four_bar_with(&LIMITED) + range,
        &["statics", "scene.toml"],
        &[
            "the first position cannot be reached: phi = 3 rad",
            "range of -1.371564 to",
        ],
    );
}

#[test]
fn a_machine_without_a_steady_cycle_ends_with_status_1() {
    let dir = TestDir::new();
    let driven = "duration = 2\n[drives]\nengine = { applied-force = \"phi\", magnitude = 2.0 }";
    dir.put("driven.toml", four_bar_with(&[("periods = 2", driven)]));
    let run = dir.run(&["cycle", "driven.toml", "--out", "o"]);
    assert_eq!(run.status, Some(1), "{run:?}");
    assert!(
        run.out.contains("no steady cycle of phi is found"),
        "{run:?}"
    );
    // 2 N m over a turn.
    assert!(run.err.contains("gains 12.6 J per cycle"), "{run:?}");
}

/// A motor at constant voltage takes voltage times current; its efficiency is that of its speed, k N ω over k N ω + R i.
#[test]
fn a_motor_has_its_current_power_and_efficiency() {
    let dir = TestDir::new();
    assert_eq!(dir.run(&["init", "pump"]).status, Some(0));
    let run = dir.run(&["simulate", "pump.toml", "--pictures", "all"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let files = dir.files("reports");
    assert!(
        files.contains(&"pump-motion-drives.png".to_owned()),
        "{files:?}"
    );
    let text = fs::read_to_string(dir.0.join("reports/pump-motion.csv")).unwrap();
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let rows: Vec<Vec<f64>> = lines
        .map(|line| line.split(',').map(|cell| cell.parse().unwrap()).collect())
        .collect();
    let column = |name: &str| {
        let k = names.iter().position(|other| *other == name);
        k.unwrap_or_else(|| panic!("{name}: {names:?}"))
    };
    let [current, power, efficiency, speed] = [
        "motor.current [A]",
        "motor.electrical_power [W]",
        "motor.efficiency",
        "phi.velocity [rad/s]",
    ]
    .map(column);
    let mut running = 0;
    for row in &rows {
        let (i, back_voltage) = (row[current], 0.05 * 5.0 * row[speed]);
        assert!((row[power] - 24.0 * i).abs() < 1e-9 * row[power].abs().max(1.0));
        let expected = match back_voltage * i > 0.0 {
            true => back_voltage / (back_voltage + 0.5 * i),
            false => 0.0,
        };
        assert!((row[efficiency] - expected).abs() < 1e-9, "{row:?}");
        running += usize::from(expected > 0.0);
    }
    assert!(running > 500, "{running}");
}
