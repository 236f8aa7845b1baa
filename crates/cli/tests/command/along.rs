//! `kinematics`, `statics` and `kinetostatics`: files, headers, exit status, messages.

use crate::bench::{Bench, FOUR_BAR, LIMITED, home, with};
use std::fs;

fn case(name: &str) -> String {
    let path = home().join("validation").join(name).join("scene.toml");
    path.to_str().unwrap().to_owned()
}

fn header(bench: &Bench, file: &str) -> Vec<String> {
    let text = fs::read_to_string(bench.0.join(file)).unwrap();
    let line = text.lines().next().unwrap();
    line.split(',').map(str::to_owned).collect()
}

#[test]
fn kinematics_writes_positions_speeds_and_accelerations() {
    let bench = Bench::new();
    let run = bench.run(&["kinematics", &case("crank-rocker"), "--out", "o"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let files = bench.files("o");
    for file in [
        "-a-mechanism.png",
        "-b-angles.png",
        "-e-transmission.png",
        "-mechanism.gif",
        "-peaks.csv",
        ".csv",
        ".md",
        ".npz",
    ] {
        let file = format!("crank-rocker-kinematics{file}");
        assert!(files.contains(&file), "{file} of {files:?}");
    }
    let header = header(&bench, "o/crank-rocker-kinematics.csv");
    for column in [
        "t [s]",
        "phi [rad]",
        "phi.speed [rad/s]",
        "phi.acceleration [rad/s2]",
        "coupler.angle [rad]",
        "coupler.speed [rad/s]",
        "coupler.acceleration [rad/s2]",
        "coupler.ratio",
        "coupler.C.x [m]",
        "coupler.C.vy [m/s]",
        "coupler.C.ax [m/s2]",
        "C.transmission [rad]",
    ] {
        assert!(header.iter().any(|h| h == column), "{column} of {header:?}");
    }
    assert!(!header.iter().any(|h| h.contains("[N")), "{header:?}");
    assert!(
        run.out.contains("361 positions over one turn of phi"),
        "{}",
        run.out
    );
    let gif = fs::read(bench.0.join("o/crank-rocker-kinematics-mechanism.gif")).unwrap();
    assert!(gif.starts_with(b"GIF89a"));
}

#[test]
fn statics_writes_forces_without_speeds() {
    let bench = Bench::new();
    let run = bench.run(&[
        "statics",
        &case("rack-pinion"),
        "--out",
        "o",
        "--points",
        "30",
    ]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let header = header(&bench, "o/rack-pinion-statics.csv");
    for column in [
        "t [s]",
        "phi [rad]",
        "phi.action [N m]",
        "guide.travel [m]",
        "guide.normal [N]",
        "guide.moment [N m]",
        "mesh.tooth [N]",
        "C.x@pinion [N]",
        "C.magnitude [N]",
        "C.direction [rad]",
        "frame.fx [N]",
        "frame.m [N m]",
    ] {
        assert!(header.iter().any(|h| h == column), "{column} of {header:?}");
    }
    let moving = |h: &String| h.contains("/s") || h.contains("[W]");
    assert!(!header.iter().any(moving), "{header:?}");
    let table = fs::read_to_string(bench.0.join("o/rack-pinion-statics.csv")).unwrap();
    assert_eq!(table.lines().count(), 31);
}

#[test]
fn kinetostatics_writes_forces_power_and_peaks() {
    let bench = Bench::new();
    let run = bench.run(&["kinetostatics", &case("boom"), "--out", "o"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let columns = header(&bench, "o/boom-kinetostatics.csv");
    for column in [
        "t [s]",
        "lift [m]",
        "lift.speed [m/s]",
        "lift.action [N]",
        "dig.action [N]",
        "ram.travel.acceleration [m/s2]",
        "ram.moment [N m]",
        "T.y@stick [N]",
        "bucket.load [N]",
        "weight.power [W]",
        "balance.actuators [W]",
        "balance.loads [W]",
        "balance.dE/dt [W]",
        "balance.residual [W]",
        "balance.energy [J]",
    ] {
        assert!(
            columns.iter().any(|h| h == column),
            "{column} of {columns:?}"
        );
    }
    assert_eq!(
        header(&bench, "o/boom-kinetostatics-peaks.csv"),
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
        "f-actions",
        "g-reactions",
        "h-frame",
        "i-power",
        "c-path-stick-W",
    ] {
        let file = format!("boom-kinetostatics-{figure}.png");
        assert!(bench.files("o").contains(&file), "{file}");
    }
    let page = fs::read_to_string(bench.0.join("o/boom-kinetostatics.md")).unwrap();
    for words in [
        "couple of barrel on rod, about the joint's point of rod",
        "force between the points; positive pushes them apart",
        "![Power balance](boom-kinetostatics-i-power.png)",
        "| L.magnitude | N |",
    ] {
        assert!(page.contains(words), "{words}");
    }
    assert!(run.out.contains("power balance kept to"), "{}", run.out);
}

#[test]
fn columns_that_were_asked_for_are_the_table() {
    let bench = Bench::new();
    let run = bench.run(&["kinetostatics", &case("cam"), "--out", "o"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert_eq!(
        header(&bench, "o/cam-kinetostatics.csv"),
        [
            "t [s]",
            "phi [rad]",
            "phi.action [N m]",
            "rise [m]",
            "rise.speed [m/s]",
            "rise.acceleration [m/s2]",
            "contact.force [N]"
        ]
    );
}

#[test]
fn sections_are_tables_and_a_picture() {
    let bench = Bench::new();
    let way = "[sweep]\nspeed = 2.0\n[loads]\nweight = { gravity = [0, -9.81] }\n[requests]\n\
               sections = [{ body = \"rocker\", from = \"D\", to = \"C\" }]\n";
    bench.put("four.toml", format!("{FOUR_BAR}{way}"));
    let run = bench.run(&["kinetostatics", "four.toml", "--out", "o"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert_eq!(
        header(&bench, "o/four-kinetostatics-section-rocker-D-C.csv"),
        ["station [m]", "axial [N]", "shear [N]", "bending [N m]"]
    );
    let envelope = header(
        &bench,
        "o/four-kinetostatics-section-rocker-D-C-envelope.csv",
    );
    assert_eq!(
        envelope[..3],
        ["station [m]", "axial min [N]", "axial max [N]"]
    );
    let picture = "four-kinetostatics-j-section-rocker-D-C.png".to_owned();
    assert!(bench.files("o").contains(&picture));
    assert!(
        run.out.contains("bending moment of rocker from D to C"),
        "{}",
        run.out
    );
}

/// Exit status 1: what was found is written, the rest is explained.
#[test]
fn a_motion_that_meets_a_limit_position_keeps_its_results() {
    let bench = Bench::new();
    let way = "[prescribed]\nduration = 2.0\npoints = 101\n[prescribed.phi]\nspeed = 0.5\n";
    bench.put("limited.toml", format!("{}{way}", with(&LIMITED)));
    for command in ["kinematics", "statics", "kinetostatics"] {
        let run = bench.run(&[command, "limited.toml", "--out", "o"]);
        assert_eq!(run.status, Some(1), "{}", run.err);
        // From 1 rad on, to the limit at 1.3716 rad.
        assert!(run.out.contains("38 of 101 positions"), "{}", run.out);
        let words = run.err.replace("\n  │ ", " ");
        assert!(
            words.contains("a limit position is reached at t = 0.743128 s"),
            "{words}"
        );
        assert!(words.contains("`coupler`, `rocker` are in line"), "{words}");
        assert!(words.contains("[prescribed]"), "{words}");
        let table = fs::read_to_string(bench.0.join(format!("o/limited-{command}.csv"))).unwrap();
        assert_eq!(table.lines().count(), 39);
    }
}

/// Exit status 2: nothing is written.
#[test]
fn what_cannot_be_followed_is_refused() {
    let bench = Bench::new();
    let refused = |scene: String, arguments: &[&str], said: &[&str]| {
        bench.put("scene.toml", scene);
        let run = bench.run(arguments);
        assert_eq!((run.status, run.out.as_str()), (Some(2), ""), "{}", run.err);
        for words in said {
            assert!(run.err.contains(words), "{words}: {}", run.err);
        }
        assert!(bench.files("reports").is_empty());
    };
    refused(
        with(&[]),
        &["kinetostatics", "scene.toml"],
        &["does not say how it moves", "[prescribed]", "[sweep]"],
    );
    let column = "[requests]\nvariables = [\"coupler.angel\"]\n";
    refused(
        with(&[]) + column,
        &["kinematics", "scene.toml"],
        &["no column `coupler.angel`", "did you mean `coupler.angle`?"],
    );
    for points in ["1", "-3", "many", "1e9"] {
        let arguments = ["statics", "scene.toml", "--points", points];
        refused(with(&[]), &arguments, &["--points"]);
    }
    let away = "[sweep]\nphi = [3.0, 4.0]\n";
    refused(
        with(&LIMITED) + away,
        &["statics", "scene.toml"],
        &[
            "the first position cannot be reached: phi = 3 rad",
            "of -1.37156 to",
        ],
    );
}
