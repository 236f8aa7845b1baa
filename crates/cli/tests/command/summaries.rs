//! The summary that every command writes for programs: what is printed, the file and the status agree, for every case and command.

use crate::test_dir::{Run, TestDir, four_bar_with, home};
use rayon::prelude::*;
use serde_json::Value;
use std::fs;

/// The commands that read a scene. A work–precision study takes minutes, and a sweep and a calibration need more.
const COMMANDS: [&str; 10] = [
    "check",
    "kinematics",
    "statics",
    "kinetostatics",
    "reduce",
    "simulate",
    "cycle",
    "equilibria",
    "linearise",
    "symbolic",
];
/// Lines of advice, whose numbers are no results.
const ADVICE: [&str; 9] = [
    // Where a motion changes its coordinate, and how far a period was looked for.
    ": coordinate changed from",
    "change point at",
    " more changes",
    "not periodic within",
    "note: ",
    "hint: ",
    "--pictures all",
    "of [assembly]; `dwell check`",
    "reaction figures only",
];
/// From SI to what is printed: cm, inches, degrees, revolutions per minute, Hz, mm or percent.
const FACTORS: [f64; 7] = [
    1.0,
    100.0,
    1.0 / 0.0254,
    180.0 / std::f64::consts::PI,
    30.0 / std::f64::consts::PI,
    0.5 / std::f64::consts::PI,
    1000.0,
];

/// A printed number, with half of its last digit.
fn number(token: &str) -> Option<(f64, f64)> {
    let token = token.replace('−', "-");
    let value: f64 = token.parse().ok().filter(|v: &f64| v.is_finite())?;
    let (mantissa, exponent) = token.split_once('e').unwrap_or((&token, "0"));
    let decimals = mantissa.split_once('.').map_or(0, |(_, d)| d.len());
    let exponent: i32 = exponent.parse().ok()?;
    Some((value, 0.5 * 10_f64.powi(exponent - decimals as i32)))
}

/// The numbers of a line that stand for themselves: not the parts of a name, a unit or a word.
fn numbers(line: &str) -> Vec<(f64, f64)> {
    let words = line.split(|c: char| c.is_whitespace() || "(),;:=[]".contains(c));
    let trimmed = words.map(|word| word.trim_end_matches(['°', '.', 'i']));
    trimmed.filter_map(number).collect()
}

/// Every number in a JSON document, with its estimated error where it has one.
fn values(json: &Value, found: &mut Vec<[f64; 2]>) {
    match json {
        Value::Object(fields) => {
            let error = fields.get("estimated_error").and_then(Value::as_f64);
            let number = ["value", "min", "max"].into_iter();
            for field in number.filter_map(|name| fields.get(name)) {
                let of_end = field.get("value").unwrap_or(field);
                found.extend(of_end.as_f64().map(|v| [v, error.unwrap_or(0.0)]));
                found.extend(field.get("at").and_then(Value::as_f64).map(|v| [v, 0.0]));
            }
            let others = ["results", "extrema", "events", "findings"].into_iter();
            for field in others.filter_map(|name| fields.get(name)) {
                values(field, found);
            }
            if !fields.contains_key("results") {
                fields.values().for_each(|field| values(field, found));
            }
            found.extend(error.map(|error| [error, 0.0]));
        }
        Value::Array(all) => all.iter().for_each(|one| values(one, found)),
        _ => found.extend(json.as_f64().map(|v| [v, 0.0])),
    }
}

/// Why a printed number is none of those of the file, if so.
fn unknown_number(line: &str, known: &[[f64; 2]], texts: &str) -> Option<f64> {
    let is_bound = line.contains("rounding error");
    let agrees = |(printed, half): (f64, f64)| {
        known.iter().any(|&[value, error]| {
            FACTORS.iter().any(|factor| {
                let (value, error) = (value * factor, error * factor);
                let rounding = half * (1.0 + 1e-9) + 1e-12 * value.abs();
                // Six digits, in whole numbers above them; a number within its error is printed as zero.
                let whole = match printed.abs() >= 1e5 {
                    true => 5e-6 * printed.abs(),
                    false => 0.0,
                };
                // A whole number may be rounded to the digits that its error leaves.
                let within = if half == 0.5 { 10.0 * error } else { 0.0 };
                (printed - value).abs() <= rounding.max(whole).max(within)
                    || printed == 0.0 && value.abs() <= error
                    || is_bound && value <= printed && printed <= 10.0 * value
            })
        })
    };
    let found = numbers(line).into_iter();
    let mut unknown = found.filter(|&of| !agrees(of));
    unknown
        .find(|(printed, _)| !texts.contains(&format!("{printed}")))
        .map(|(printed, _)| printed)
}

/// The files of a folder, without what the command keeps for itself: other folders may change meanwhile.
fn files(dir: &TestDir, folder: &str) -> Vec<String> {
    let entries = fs::read_dir(dir.0.join(folder)).into_iter().flatten();
    let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let mut names: Vec<String> = names.filter(|name| name != ".dwell").collect();
    names.sort();
    names
}

/// What is wrong with the summary of a run, whose files are in `folder`.
fn fault(dir: &TestDir, folder: &str, run: &Run, path: &str) -> Option<String> {
    let files = files(dir, folder);
    if run.status == Some(2) {
        return (!files.is_empty()).then(|| format!("status 2 with {files:?}"));
    }
    let text = fs::read_to_string(dir.0.join(folder).join(path));
    let Ok(text) = text else {
        return Some(format!("no {path}, but {files:?}"));
    };
    if text.contains("NaN") || text.contains("null,\n      \"unit\"") {
        return Some("a number that is none".to_owned());
    }
    let json: Value = serde_json::from_str(&text).unwrap();
    if json["status"].as_i64() != run.status.map(i64::from) {
        return Some(format!("status {} for {:?}", json["status"], run.status));
    }
    let results = json["results"].as_object().unwrap();
    // One that is there twice would be read once.
    if results.len() != text.matches("\": {\n      \"value\"").count() {
        return Some("two results of one name".to_owned());
    }
    let listed: Vec<&str> = json["files"]
        .as_array()
        .unwrap()
        .iter()
        .filter_map(Value::as_str)
        .collect();
    if listed != files {
        return Some(format!("lists {listed:?}, wrote {files:?}"));
    }
    let printed = json["printed"].as_array().unwrap().iter();
    let printed: Vec<&str> = printed.filter_map(Value::as_str).collect();
    let out: Vec<&str> = run.out.lines().take(printed.len()).collect();
    if printed != out
        || !run
            .out
            .lines()
            .skip(printed.len())
            .all(|line| line.contains(folder) || line.starts_with("  and "))
    {
        return Some("prints something else".to_owned());
    }
    let errors = json["messages"].as_array().unwrap().iter();
    let errors = errors
        .filter(|message| message["severity"] == "error")
        .count();
    if run.status == Some(1) && errors == 0 && !run.out.contains("FAIL")
        || run.status == Some(0) && errors > 0
    {
        return Some(format!("status {:?} with {errors} errors", run.status));
    }
    let mut known = Vec::new();
    values(&json, &mut known);
    let texts = json["scene"]["title"].as_str().unwrap();
    let lines = printed.iter().skip(usize::from(json["command"] == "check"));
    let lines = lines.filter(|line| !ADVICE.iter().any(|advice| line.contains(advice)));
    lines
        .filter_map(|line| Some((line, unknown_number(line, &known, texts)?)))
        .map(|(line, number)| format!("{number} is in no file: {line}"))
        .next()
}

#[test]
fn what_is_printed_the_file_and_the_status_agree_for_every_case_and_command() {
    let dir = TestDir::new();
    let cases = fs::read_dir(home().join("validation")).unwrap();
    let cases = cases.map(|entry| entry.unwrap().path());
    let mut cases: Vec<_> = cases
        .filter(|path| path.join("scene.toml").is_file())
        .collect();
    cases.sort();
    let pairs: Vec<_> = cases
        .iter()
        .flat_map(|case| COMMANDS.map(|command| (case, command)))
        .collect();
    let faults = pairs.par_iter().filter_map(|(case, command)| {
        let name = case.file_name().unwrap().to_str().unwrap();
        let scene = case.join("scene.toml");
        let folder = format!("{name}-{command}");
        let arguments = [
            command,
            scene.to_str().unwrap(),
            "--out",
            &folder,
            "--pictures",
            "none",
        ];
        let run = dir.run(&arguments);
        let path = format!("{name}-{command}.json");
        Some(format!(
            "{name} {command}: {}",
            fault(&dir, &folder, &run, &path)?
        ))
    });
    let faults: Vec<String> = faults.collect();
    assert!(
        pairs.len() >= 270 && faults.is_empty(),
        "{}\n{}",
        faults.len(),
        faults.join("\n")
    );
}

#[test]
fn sweeps_and_calibrations_have_summaries_too() {
    let dir = TestDir::new();
    dir.put("arm.toml", four_bar_with(&[]));
    for (command, options) in [
        (
            "sweep",
            ["--vary", "crank.inertia=0.4:0.6:5", "--result", "m,period"].as_slice(),
        ),
        (
            "calibrate",
            &["--parameter", "crank.inertia", "--period", "0.65"],
        ),
    ] {
        let plain = [command, "arm.toml", "--out", command, "--pictures", "none"];
        let arguments = [&plain[..], options];
        let run = dir.run(&arguments.concat());
        assert_ne!(run.status, Some(2), "{run:?}");
        let fault = fault(&dir, command, &run, &format!("arm-{command}.json"));
        assert_eq!(fault, None, "{run:?}");
    }
}

/// The centre of mass and the size, of a mechanism whose ground does not begin at the origin.
#[test]
fn check_lists_masses_loads_drives_and_motions() {
    let dir = TestDir::new();
    let scene = "[units]\nlength = \"mm\"\ninertia = \"kg m2\"\n[bodies.ground]\npoints = { O = [1000, 2000] }\n[bodies.bar]\n\
                 points = { O = [0, 0], P = [300, 0] }\nmass = 2\ncenter = [200, 0]\ninertia = 0.1\n[bodies.tip]\n\
                 points = { P = [0, 0] }\nmass = 6\ncenter = [0, 0]\n[joints]\n\
                 O = { revolute = [\"ground.O\", \"bar.O\"] }\nP = { weld = [\"bar.P\", \"tip.P\"] }\n[actuators]\n\
                 phi = { angle = [\"ground\", \"bar\"] }\n[loads]\nweight = { gravity = [0, -9.81] }\n\
                 wind = { torque = [\"ground\", \"bar\"], magnitude = \"2*t\" }\n[drives]\nmotor = { applied-force = \"phi\", magnitude = 3 }\n\
                 [motion]\ninitial-velocity = 4\nduration = 0.5\n";
    dir.put("pendulum.toml", scene);
    let run = dir.run(&["check", "pendulum.toml"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    for line in [
        "overall size at the start: 300 by 0 mm",
        "moving mass 8 kg, with its centre of mass at (1275, 2000) mm at the start",
        "bar: 2 kg, 0.1 kg m²",
        "weight: gravity, 9.81 m/s²",
        "wind: couple of ground on bar, a function of t, in N m",
        "motor: applied force on phi, 3 N m",
        "free motion: phi from 0 rad at 4 rad/s, for 0.5 s",
    ] {
        assert!(run.out.contains(line), "{line}: {}", run.out);
    }
}

/// A crank-slider of 60 and 220 mm whose guide passes 20 mm beside the pin: the piston travels by the difference of the
/// two stretched positions, and the transmission angle, from the normal of the guide, is a right angle less the rod's lean.
#[test]
fn kinematics_prints_swings_and_transmission_angles_in_the_scenes_units() {
    let dir = TestDir::new();
    assert_eq!(dir.run(&["init", "pump"]).status, Some(0));
    let run = dir.run(&["kinematics", "pump.toml", "--pictures", "none"]);
    let travel = 280.0_f64.mul_add(280.0, -400.0).sqrt() - 160.0_f64.mul_add(160.0, -400.0).sqrt();
    let number_after = |before: &str| -> f64 {
        let (_, rest) = run
            .out
            .split_once(before)
            .unwrap_or_else(|| panic!("{before}: {}", run.out));
        rest.split(' ').next().unwrap().parse().unwrap()
    };
    let printed = number_after("guide travels by ");
    assert!((printed - travel).abs() < 1e-3, "{printed} {travel}");
    // The rod leans by asin((60 ± 20)/220) at most.
    let swing = (80.0_f64 / 220.0).asin() + (40.0_f64 / 220.0).asin();
    let printed = number_after("rod turns by ");
    assert!((printed - swing.to_degrees()).abs() < 1e-3, "{printed}");
    let least = 90.0 - (40.0_f64 / 220.0).asin().to_degrees();
    let printed = number_after("transmission angle at C from ");
    assert!((printed - least).abs() < 1e-3, "{printed} {least}");
    for unit in [" deg/s at", " mm/s at", " mm/s2 at"] {
        assert!(run.out.contains(unit), "{unit}: {}", run.out);
    }
}

#[test]
fn a_motion_that_ends_early_says_so_in_its_summary() {
    let dir = TestDir::new();
    dir.put("limited.toml", four_bar_with(&crate::test_dir::LIMITED));
    let run = dir.run(&[
        "simulate",
        "limited.toml",
        "--out",
        "o",
        "--pictures",
        "none",
        "--method",
        "bdf",
    ]);
    let text = fs::read_to_string(dir.0.join("o/limited-simulate.json")).unwrap();
    let json: Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["status"].as_i64(), run.status.map(i64::from));
    assert_eq!(fault(&dir, "o", &run, "limited-simulate.json"), None);
}

/// Runs the command with a text on its standard input.
fn with_input(dir: &TestDir, arguments: &[&str], text: &str) -> std::process::Output {
    dir.put("input", text);
    let input = fs::File::open(dir.0.join("input")).unwrap();
    dir.command(arguments).stdin(input).output().unwrap()
}

#[test]
fn a_scene_may_come_from_standard_input() {
    let dir = TestDir::new();
    let text = four_bar_with(&[]);
    let plain = ["--pictures", "none", "--out", "o"];
    let done = with_input(&dir, &[&["reduce", "-"], &plain[..]].concat(), &text);
    assert_eq!(done.status.code(), Some(0));
    assert!(dir.files("o").contains(&"stdin-reduced.csv".to_owned()));
    let named = [&["simulate", "-", "--name", "arm"], &plain[..]].concat();
    assert_eq!(with_input(&dir, &named, &text).status.code(), Some(0));
    assert!(dir.files("o").contains(&"arm-simulate.json".to_owned()));
    // The same results as those of a file.
    dir.put("arm.toml", &text);
    let run = dir.run(&["reduce", "arm.toml", "--out", "p", "--pictures", "none"]);
    assert_eq!(run.status, Some(0));
    let table = |path: &str| fs::read(dir.0.join(path)).unwrap();
    assert_eq!(table("o/stdin-reduced.csv"), table("p/arm-reduced.csv"));
    // A fault is shown where it is, and nothing is written.
    let before = dir.contents();
    let wrong = text.replace("\"coupler.C\"", "\"cuopler.C\"");
    let refused = with_input(&dir, &["check", "-", "--out", "q"], &wrong);
    let err = String::from_utf8(refused.stderr).unwrap();
    assert_eq!(refused.status.code(), Some(2));
    let line = wrong
        .lines()
        .position(|line| line.contains("cuopler"))
        .unwrap()
        + 1;
    assert!(err.contains(&format!("<stdin>:{line}:")), "{err}");
    assert!(err.contains("cuopler.C"), "{err}");
    fs::remove_file(dir.0.join("input")).unwrap();
    let mut before = before;
    before.remove("input");
    assert_eq!(dir.contents(), before);
}

#[test]
fn names_that_are_no_part_of_a_file_name_are_refused() {
    let dir = TestDir::new();
    dir.put("arm.toml", four_bar_with(&[]));
    for name in ["", "../arm", "a/b", "a.b", " "] {
        let run = dir.run(&["check", "arm.toml", "--name", name]);
        assert_eq!(run.status, Some(2), "{name}");
        assert!(run.err.contains("letters, digits"), "{}", run.err);
    }
}

#[test]
fn init_writes_a_scene_that_runs_at_once_and_replaces_nothing() {
    let dir = TestDir::new();
    let run = dir.run(&["init", "pump"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    let text = fs::read_to_string(dir.0.join("pump.toml")).unwrap();
    for section in [
        "[units]",
        "[bodies.",
        "[joints]",
        "[loads]",
        "[drives]",
        "[motion]",
        "[requests]",
    ] {
        assert!(text.contains(section), "{section}");
    }
    // It explains itself: a comment before each section.
    for line in text.lines().filter(|line| line.starts_with('[')) {
        let before = text.lines().take_while(|other| *other != line);
        assert!(
            before.filter(|line| line.contains('#')).count() >= 3,
            "{line}"
        );
    }
    for command in [
        "check",
        "kinematics",
        "statics",
        "kinetostatics",
        "reduce",
        "simulate",
        "cycle",
        "equilibria",
        "symbolic",
    ] {
        let run = dir.run(&[command, "pump.toml", "--pictures", "none"]);
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""), "{command}");
    }
    let before = dir.contents();
    for name in ["pump", "pump.toml"] {
        let run = dir.run(&["init", name]);
        assert_eq!(run.status, Some(2));
        assert!(run.err.contains("exists already"), "{}", run.err);
    }
    let run = dir.run(&["init", "nowhere/pump"]);
    assert_eq!(run.status, Some(2), "{run:?}");
    assert_eq!(dir.contents(), before);
}
