//! What the commands write and print when all is well, and what they leave alone when it is not.

use crate::test_dir::{LIMITED, TestDir, four_bar_with, home};
use std::fs;
use std::io::Read as _;
use std::process::Stdio;

fn case(name: &str) -> String {
    let path = home().join("validation").join(name).join("scene.toml");
    path.to_str().unwrap().to_owned()
}

fn first_line(dir: &TestDir, file: &str) -> String {
    let text = fs::read_to_string(dir.0.join(file)).unwrap();
    text.lines().next().unwrap().to_owned()
}

#[test]
fn check_describes_the_single_dwell_and_writes_its_summary_alone() {
    let dir = TestDir::new();
    let run = dir.run(&["check", &case("single-dwell")]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert_eq!(dir.files("reports"), ["single-dwell-check.json"]);
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("../snapshots");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| insta::assert_snapshot!("check-single-dwell", run.out));
}

/// Also of a mechanism without ends, over the revolution that is shown.
#[test]
fn reduce_makes_a_table_that_needs_no_mechanism() {
    let dir = TestDir::new();
    for (name, of) in [
        ("crank-rocker", "a full revolution"),
        ("planetary", "0 to 6.28319"),
    ] {
        let run = dir.run(&[
            "reduce",
            &case(name),
            "--table-accuracy",
            "1e-9",
            "--out",
            "o",
        ]);
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
        assert!(run.out.contains(of), "{}", run.out);
        assert_eq!(
            first_line(&dir, &format!("o/{name}.table")),
            "dwell-table 1"
        );
    }
}

/// Over a part of the revolution, in the scene's unit: degrees here.
#[test]
fn reduce_makes_a_table_of_a_part_of_the_turn() {
    let dir = TestDir::new();
    let scene = case("slotted-rocker");
    let interval = ["--table-from", "-30", "--table-to", "90"];
    let arguments = [
        &["reduce", &scene, "--table-accuracy", "1e-9", "--out", "o"],
        &interval[..],
    ]
    .concat();
    let run = dir.run(&arguments);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert!(run.out.contains("from -30 to 90 deg"), "{}", run.out);
}

#[test]
fn reduce_writes_a_table_with_units_and_pictures() {
    let dir = TestDir::new();
    let run = dir.run(&["reduce", &case("single-dwell"), "--out", "o"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert_eq!(
        dir.files("o"),
        [
            "single-dwell-reaction.png",
            "single-dwell-reduce.json",
            "single-dwell-reduced.csv",
            "single-dwell-reduced.npz",
            "single-dwell-reduced.png"
        ]
    );
    assert_eq!(
        first_line(&dir, "o/single-dwell-reduced.csv"),
        "phi [rad],m [kg m2],half_dm [kg m2/rad],slide.normal.a [kg m],slide.normal.b [kg m],relative_error"
    );
    assert!(run.out.contains("o/single-dwell-reduced.csv") && run.out.contains("kg m²/rad"));
    assert!(run.out.contains(
        "estimated rounding errors, compared with 32-digit arithmetic: below 1e-15 of the largest m"
    ));
}

#[test]
fn simulate_writes_a_table_with_units_and_a_picture() {
    let dir = TestDir::new();
    for method in ["bdf", "tsit45"] {
        let scene = case("single-dwell");
        let arguments = ["simulate", &scene, "--out", "o", "--method", method];
        let run = dir.run(&[&arguments[..], &["--pictures", "all"]].concat());
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
        let files = dir.files("o");
        for file in [
            "coordinates.png",
            "energies.png",
            "phase-portrait.png",
            "mechanism.gif",
            "extrema.csv",
        ] {
            let file = format!("single-dwell-motion-{file}");
            assert!(files.contains(&file), "{file} is not in {files:?}");
        }
        let header = first_line(&dir, "o/single-dwell-motion.csv");
        let expected = "t [s],phi [rad],phi.velocity [rad/s],phi.acceleration [rad/s2],";
        assert!(header.starts_with(expected), "{header}");
        for column in [
            "slide.normal [N]",
            "energy.kinetic [J]",
            "energy.balance_error [J]",
        ] {
            assert!(header.contains(column), "{header}");
        }
        assert!(
            !header.contains("phi.actuator_force"),
            "nothing acts through a free actuator: {header}"
        );
        let period = "period 5.419662677064 s (estimated error ";
        assert!(run.out.contains(period), "{}", run.out);
        let energy = "of the largest kinetic energy, 0.455087 J";
        assert!(run.out.contains(energy), "{}", run.out);
    }
}

/// The four-bar with a motor, its weight and a damper.
fn motor_scene() -> String {
    let sections = "duration = 2\n[loads]\nweight = { gravity = [0, -9.81] }\n\
        press = { rotational-damper = [\"ground\", \"rocker\"], damping = 0.4 }\n[drives]\n\
        engine = { motor = \"phi\", voltage = 24, torque-constant = 0.05, resistance = 0.4, gear-ratio = 10 }";
    four_bar_with(&[("periods = 2", sections)])
}

#[test]
fn work_precision_writes_every_combination_and_the_front() {
    let dir = TestDir::new();
    dir.put("driven.toml", motor_scene());
    let run = dir.run(&["work-precision", "driven.toml", "--out", "o"]);
    // It runs for seconds, and longer where others run, too.
    let is_progress = |line: &str| line.starts_with("dwell work-precision: running for");
    assert!(run.status == Some(0) && run.err.lines().all(is_progress));
    assert_eq!(
        dir.files("o"),
        ["csv", "json", "md", "npz", "png"].map(|end| format!("driven-work-precision.{end}"))
    );
    let header = first_line(&dir, "o/driven-work-precision.csv");
    assert!(
        header.starts_with("evaluation,integrator,tolerance"),
        "{header}"
    );
    let says = |words: &str| run.out.contains(words);
    assert!(says("fixed step of 1 ms") && says("with the main pictures"));
}

#[test]
fn cycle_tells_the_steady_cycle_and_its_flywheel() {
    let dir = TestDir::new();
    dir.put("driven.toml", motor_scene());
    let arguments = [
        "cycle",
        "driven.toml",
        "--fluctuation",
        "0.02",
        "--out",
        "o",
    ];
    let run = dir.run(&arguments);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert_eq!(
        dir.files("o"),
        [
            "driven-cycle-flywheel.csv",
            "driven-cycle-flywheel.npz",
            "driven-cycle-work.csv",
            "driven-cycle.csv",
            "driven-cycle.json",
            "driven-cycle.md",
            "driven-cycle.npz",
            "driven-cycle.png"
        ]
    );
    assert_eq!(
        first_line(&dir, "o/driven-cycle.csv"),
        "t [s],phi [rad],phi.velocity [rad/s],phi.acceleration [rad/s2],press.work [J],engine.work [J]"
    );
    for words in [
        "mean speed",
        "stable: ",
        "work of engine",
        "for a coefficient of fluctuation of 0.02: flywheel of",
    ] {
        assert!(run.out.contains(words), "{words}: {}", run.out);
    }
}

#[test]
fn equilibria_and_linearise_need_no_motion() {
    let dir = TestDir::new();
    let hung = four_bar_with(&[(
        "[motion]\ninitial-coordinate = 1.0\ninitial-velocity = 10.0\nperiods = 2",
        "[loads]\nweight = { gravity = [0, -9.81] }",
    )]);
    dir.put("hung.toml", hung);
    let run = dir.run(&["equilibria", "hung.toml", "--out", "o"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert!(run.out.contains("2 equilibria of phi"), "{}", run.out);
    assert!(run.out.contains("unstable") && run.out.contains("stable without damping"));
    let run = dir.run(&["linearise", "hung.toml", "--out", "o"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert!(
        run.out
            .contains("outputs: phi (rad), phi.velocity (rad/s), A.x (N)"),
        "{}",
        run.out
    );
    assert_eq!(
        dir.files("o"),
        [
            "hung-equilibria.csv",
            "hung-equilibria.json",
            "hung-equilibria.md",
            "hung-equilibria.png",
            "hung-linear.csv",
            "hung-linear.md",
            "hung-linear.npz",
            "hung-linearise.json"
        ]
    );
}

#[test]
fn calibrate_finds_the_inertia_of_the_single_dwell() {
    let dir = TestDir::new();
    let run = dir.run(&["calibrate", &case("single-dwell")]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let expected = "Single-dwell mechanism: crank.inertia = 0.626326641678 kg m2 gives the period 5.42 s\n  \
         the scene has 0.626 kg m2, which gives 5.419662677064 s\n  estimated errors: ";
    assert!(run.out.starts_with(expected), "{}", run.out);
    // The reverse, with a value of another kind.
    let arguments = ["--parameter", "coupler.mass", "--period", "5.42"];
    let run = dir.run(&[&["calibrate", &case("single-dwell")], &arguments[..]].concat());
    assert_eq!(run.status, Some(0));
    assert!(run.out.contains("coupler.mass = 1.497607"), "{}", run.out);
    assert_eq!(dir.files("reports"), ["single-dwell-calibrate.json"]);
}

/// The folder of somebody's own cases has no independent reader.
const NO_AUDIT: &str = "independent reader: not run (cases/audit/case.py is not found)\n";

#[test]
fn validate_writes_the_report_and_its_status_tells_the_verdict() {
    let dir = TestDir::new();
    let folder = home().join("validation/single-dwell");
    let text = |file: &str| fs::read_to_string(folder.join(file)).unwrap();
    let reference = text("case.toml");
    dir.put("cases/dwell/scene.toml", text("scene.toml"));
    dir.put("cases/dwell/case.toml", &reference);
    let run = dir.run(&["validate", "--folder", "cases"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), NO_AUDIT));
    let passed = |out: &str| -> [usize; 2] {
        let line = out.lines().next().unwrap();
        let counts = line.strip_prefix("dwell: ").unwrap();
        let counts = counts.strip_suffix(" findings pass").unwrap();
        let (some, all) = counts.split_once(" of ").unwrap();
        [some, all].map(|n| n.parse().unwrap())
    };
    let [some, all] = passed(&run.out);
    assert!(some == all && all >= 31, "{}", run.out);
    let files = dir.files("reports");
    for file in [
        "dwell.json",
        "dwell.md",
        "dwell.txt",
        "dwell/mechanism.png",
        "dwell/reduced.png",
        "dwell/reaction.png",
        "dwell/work-precision-bdf.csv",
        "dwell/work-precision-tsit45.csv",
        "dwell/motion.png",
        "dwell/energy-drift.png",
        "dwell/differences.png",
        "dwell/work-precision.png",
        "dwell/motion.csv",
        "dwell/reduced.csv",
    ] {
        assert!(files.iter().any(|f| f == file), "{file} of {files:?}");
    }
    assert_eq!(
        first_line(&dir, "reports/dwell/work-precision-bdf.csv"),
        "tolerance,steps,evaluations,jacobians,wall_time [s],period_error,\
         energy_drift,reaction_error"
    );
    // One published digit changed, the tenth of m at φ = 0: the check fails, the report says so.
    let wrong = reference.replacen("0.9101735605", "0.9101735606", 1);
    assert_ne!(wrong, reference);
    dir.put("cases/dwell/case.toml", wrong);
    let run = dir.run(&["validate", "--folder", "cases"]);
    assert_eq!((run.status, run.err.as_str()), (Some(1), NO_AUDIT));
    assert_eq!(passed(&run.out), [all - 1, all]);
    let second = run.out.lines().nth(1).unwrap();
    assert!(second.starts_with("  FAIL published-m "), "{second}");
    let report = fs::read_to_string(dir.0.join("reports/dwell.txt")).unwrap();
    assert!(report.contains("FAIL  published-m"));
}

#[test]
fn a_report_is_left_alone_when_the_next_one_fails() {
    let dir = TestDir::new();
    dir.put("scene.toml", four_bar_with(&[]));
    assert_eq!(dir.run(&["reduce", "scene.toml"]).status, Some(0));
    // The scene is wrong.
    dir.put(
        "scene.toml",
        four_bar_with(&[("mass = 1.0", "mass = -1.0")]),
    );
    let before = dir.contents();
    assert_eq!(dir.run(&["reduce", "scene.toml"]).status, Some(2));
    assert!(dir.contents() == before);
    // One of the files cannot be written, so none is.
    dir.put("scene.toml", four_bar_with(&[("mass = 1.0", "mass = 2.0")]));
    let reports = dir.0.join("reports");
    let table = dir
        .files("reports")
        .into_iter()
        .find(|f| f.ends_with(".csv"));
    let table = reports.join(table.unwrap());
    fs::remove_file(&table).unwrap();
    fs::create_dir(&table).unwrap();
    let before = dir.contents();
    let run = dir.run(&["reduce", "scene.toml"]);
    assert_eq!(run.status, Some(2));
    assert!(run.err.contains("no file was written"), "{}", run.err);
    assert!(dir.contents() == before);
}

#[test]
fn a_good_case_is_written_when_others_cannot_be_validated() {
    let dir = TestDir::new();
    dir.put("cases/good/scene.toml", four_bar_with(&[]));
    dir.put(
        "cases/apart/scene.toml",
        four_bar_with(&[("C = [0.35, 0]", "C = [0.05, 0]")]),
    );
    dir.put("cases/unread/scene.toml", "bodies = 3");
    let run = dir.run(&["validate", "--folder", "cases", "--out", "o"]);
    assert_eq!(run.status, Some(2));
    for bad in ["apart/scene.toml", "unread/scene.toml"] {
        assert!(run.err.contains(bad), "{}", run.err);
    }
    assert!(run.out.contains("good: "), "{}", run.out);
    let files = dir.files("o");
    let of = |case: &str| files.iter().filter(|f| f.contains(case)).count();
    assert!(of("good") > 3, "{files:?}");
    assert_eq!((of("apart"), of("unread")), (0, 0));
    let verdict = std::fs::read_to_string(dir.0.join("o/index.md")).unwrap();
    let headline = "# FAIL: cases/apart could not be validated\n";
    assert!(verdict.starts_with(headline), "{verdict}");
    let index = std::fs::read_to_string(dir.0.join("o/cases.md")).unwrap();
    for row in [
        "(good.md) | pass |",
        "apart` | **not validated** |",
        "unread` | **not validated** |",
    ] {
        assert!(index.contains(row), "{index}");
    }
}

#[test]
fn nothing_is_written_when_no_case_can_be_validated() {
    let dir = TestDir::new();
    dir.put("cases/bad/scene.toml", "bodies = 3");
    dir.put("cases/worse/scene.toml", "joints");
    let before = dir.contents();
    let run = dir.run(&["validate", "--folder", "cases"]);
    assert_eq!(run.status, Some(2));
    assert!(dir.contents() == before);
}

#[test]
fn a_reader_that_has_seen_enough_is_no_error() {
    let dir = TestDir::new();
    let mut child = dir
        .command(&["reduce", &case("single-dwell"), "--out", "o"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let mut messages = String::new();
    child
        .stderr
        .take()
        .unwrap()
        .read_to_string(&mut messages)
        .unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(0));
    assert!(messages.starts_with("time: "), "{messages}");
    assert_eq!(messages.lines().count(), 1, "{messages}");
    assert_eq!(dir.files("o").len(), 5);
}

#[test]
fn names_in_any_script_and_folders_with_spaces() {
    let dir = TestDir::new();
    let scene = four_bar_with(&[])
        .replace("rocker", "качалка")
        .replace("[bodies.качалка]", "[bodies.\"качалка\"]")
        .replace("phi =", "\"φ\" =")
        .replace("[actuators.phi]", "[actuators.\"φ\"]");
    dir.put("my case/scene.toml", scene);
    let run = dir.run(&["reduce", "my case/scene.toml"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let header = first_line(&dir, "reports/my case-reduced.csv");
    assert!(header.starts_with("φ [rad],m [kg m2]"), "{header}");
}

/// Reads what has no speed or no mass: true words instead of NaN.
#[test]
fn odd_motions_are_told_as_they_are() {
    let dir = TestDir::new();
    let output = |scene: String, arguments: &[&str]| {
        dir.put("scene.toml", scene);
        let run = dir.run(arguments);
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
        assert!(!run.out.contains("NaN"), "{}", run.out);
        run.out
    };
    let rest = [
        ("initial-velocity = 10.0", "initial-velocity = 0"),
        ("periods = 2", "duration = 2"),
    ];
    let out = output(four_bar_with(&rest), &["simulate", "scene.toml"]);
    assert!(
        out.contains("the mechanism stays at rest: no force moves it"),
        "{out}"
    );
    // A coordinate that folds back at its dead point: another carries the motion through.
    let out = output(
        four_bar_with(&LIMITED),
        &["simulate", "scene.toml", "--method", "tsit45"],
    );
    assert!(out.contains("at its dead point"), "{out}");
    assert!(out.contains("  2 s by Tsit45"), "{out}");
    // The same motion, a hundred thousand revolutions later.
    let rotated = [(
        "initial-coordinate = 1.0",
        "initial-coordinate = 628319.5307179587",
    )];
    let out = output(four_bar_with(&rotated), &["simulate", "scene.toml"]);
    assert!(out.contains("period 0.75506323"), "{out}");
    let fast = [("initial-velocity = 10.0", "initial-velocity = 1e30")];
    let out = output(four_bar_with(&fast), &["simulate", "scene.toml"]);
    assert!(out.contains("  1.510126e-29 s by BDF"), "{out}");
    let massless: String = four_bar_with(&[])
        .lines()
        .filter(|l| {
            !["mass", "center", "inertia"]
                .iter()
                .any(|k| l.starts_with(k))
        })
        .map(|l| format!("{l}\n"))
        .collect();
    let out = output(massless, &["reduce", "scene.toml"]);
    assert!(out.contains("no body with mass moves"), "{out}");
}

/// Friction that brings a mechanism to rest is stiff there: an explicit method needs many steps, and the summary
/// suggests another.
#[test]
fn a_method_that_needs_many_steps_is_advised_of_another() {
    let dir = TestDir::new();
    let friction = "[loads]\nweight = { gravity = [0, -9.81] }\n[friction.A]\ncoefficient = 0.3\n\
               radius = 0.05\nregularization-speed = 0.001\n[motion]";
    let stiff = [("[motion]", friction), ("periods = 2", "duration = 3")];
    dir.put("scene.toml", four_bar_with(&stiff));
    let run = dir.run(&[
        "simulate",
        "scene.toml",
        "--method",
        "tsit45",
        "--rtol",
        "1e-6",
    ]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert!(run.out.contains("hint: --method bdf"), "{}", run.out);
    let run = dir.run(&["simulate", "scene.toml", "--rtol", "1e-6"]);
    assert!(!run.out.contains("hint"), "{}", run.out);
}
