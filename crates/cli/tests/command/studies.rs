//! Messages for invalid tables and sweeps, as in `messages`; and the schema of scenes.

use crate::messages::Group;
use crate::test_dir::{LIMITED, TestDir, four_bar_with, home};
use std::fs;

#[test]
fn tables() {
    let mut group = Group::new();
    group.dir.put("scene.toml", four_bar_with(&[]));
    group.dir.put("limited.toml", four_bar_with(&LIMITED));
    let spring = "\n[loads]\nspring = { torsion-spring = [\"ground\", \"crank\"], stiffness = 2, free-angle = 0 }\n";
    group.dir.put("winds.toml", four_bar_with(&[]) + spring);
    for accuracy in ["0", "1e-20", "1", "-1e-9", "fine", "nan"] {
        group.refused(
            &format!("an accuracy of {accuracy}"),
            &["reduce", "scene.toml", "--table-accuracy", accuracy],
        );
    }
    for (title, scene, rest) in [
        ("a load that winds up", "winds.toml", &[][..]),
        (
            "beyond the range",
            "limited.toml",
            &["--table-from", "0", "--table-to", "400"],
        ),
        (
            "from the end to the beginning",
            "scene.toml",
            &["--table-from", "2", "--table-to", "1"],
        ),
        (
            "nothing",
            "scene.toml",
            &["--table-from", "1", "--table-to", "1"],
        ),
        ("no end", "scene.toml", &["--table-from", "1"]),
        (
            "an infinite end",
            "scene.toml",
            &["--table-from", "-1", "--table-to", "inf"],
        ),
        (
            "a unit",
            "scene.toml",
            &["--table-from", "10deg", "--table-to", "20deg"],
        ),
        (
            "up to a limit position",
            "limited.toml",
            &["--table-from", "0", "--table-to", "1.3715642395"],
        ),
        (
            "many turns",
            "scene.toml",
            &["--table-from", "0", "--table-to", "1e5"],
        ),
    ] {
        let arguments = ["reduce", scene, "--table-accuracy", "1e-9"];
        group.refused(title, &[&arguments, rest].concat());
    }
    let arguments = ["reduce", "limited.toml", "--table-accuracy", "1e-14"];
    group.refused("more than there is next to limit positions", &arguments);
    let arguments = [
        "reduce",
        "scene.toml",
        "--table-from",
        "0",
        "--table-to",
        "1",
    ];
    group.refused("an extent of no table", &arguments);
    group.check("tables");
}

#[test]
fn sweeps() {
    let mut group = Group::new();
    group.dir.put("four-bar.toml", four_bar_with(&[]));
    for (title, vary) in [
        ("an unknown number", "crank.inertai=1,2"),
        ("a body without such a number", "ground.mass=1,2"),
        ("no variation", "crank.inertia"),
        ("an unfinished range", "crank.inertia=0.001:0.002"),
        ("no values", "crank.inertia=0.001:0.002:0"),
        ("an empty range", "crank.inertia=0.001:0.001:5"),
        ("no number", "crank.inertia=0.001,NaN"),
        ("no such distribution", "crank.inertia~gauss(0.001,1e-4)"),
        ("no deviation", "crank.inertia~normal(0.001,0)"),
        ("a range upside down", "crank.inertia~uniform(0.002,0.001)"),
        ("no tolerance", "crank.inertia±0%"),
        ("random, but how often", "crank.inertia±1%"),
    ] {
        group.refused(title, &["sweep", "four-bar.toml", "--vary", vary]);
    }
    let refused = |group: &mut Group, title: &str, more: &[&str]| {
        let vary = [
            "sweep",
            "four-bar.toml",
            "--vary",
            "crank.inertia=0.001,0.002",
        ];
        group.refused(title, &[&vary[..], more].concat());
    };
    refused(
        &mut group,
        "the same number twice",
        &["--vary", "crank.inertia=1,2"],
    );
    refused(&mut group, "samples of nothing", &["--samples", "100"]);
    refused(&mut group, "samples below zero", &["--samples", "-1"]);
    refused(&mut group, "a seed that is no number", &["--seed", "x"]);
    refused(&mut group, "a shard too many", &["--shard", "3/2"]);
    refused(
        &mut group,
        "the shard before the first",
        &["--shard", "0/2"],
    );
    refused(&mut group, "no shard", &["--shard", "two"]);
    refused(&mut group, "an unknown result", &["--result", "perod"]);
    refused(&mut group, "an unknown form", &["--export", "xlsx"]);
    refused(
        &mut group,
        "a shard and an export",
        &["--shard", "1/2", "--export", "csv"],
    );
    group.refused("nothing varied", &["sweep", "four-bar.toml"]);
    group
        .dir
        .put("text/four-bar-sweep/_study.toml", "my own notes");
    refused(
        &mut group,
        "a file that defines no study",
        &["--out", "text"],
    );
    let own = [
        "sweep",
        "four-bar.toml",
        "--vary",
        "crank.inertia=0.001,0.002,0.003",
    ];
    let run = group.dir.run(&[&own[..], &["--out", "own"]].concat());
    assert_eq!(run.status, Some(0), "{run:?}");
    refused(&mut group, "a folder of another study", &["--out", "own"]);
    group.dir.put(
        "four-bar.toml",
        four_bar_with(&[("mass = 1.0", "mass = 1.5")]),
    );
    let changed = [&own[..], &["--out", "own"]].concat();
    group.refused("a scene that was changed since", &changed);
    group.check("sweeps");
}

/// The schema needs no folder, and is the one of the documentation.
#[test]
fn the_schema_is_that_of_the_documentation() {
    let dir = TestDir::new();
    let run = dir.run(&["schema"]);
    assert_eq!((run.status, run.err.as_str()), (Some(0), ""));
    assert!(dir.contents().is_empty());
    let written = fs::read_to_string(home().join("docs/scene-schema.json")).unwrap();
    assert_eq!(run.out, written);
}

/// Names from before the first release fail; the error says how they are called now, of the command that knows them.
#[test]
fn a_former_option_or_command_is_answered_with_its_name() {
    let dir = TestDir::new();
    dir.put("scene.toml", four_bar_with(&[]));
    let scene = "scene.toml";
    for (arguments, name) in [
        (
            &["calibrate", scene, "--set", "crank.mass"][..],
            "--parameter",
        ),
        (&["linearise", scene, "--at=0.2"], "--about"),
        (&["reduce", scene, "--table=1e-9"], "--table-accuracy"),
        (&["reduce", scene, "--to", "3"], "--table-to"),
        (&["simulate", scene, "--every", "0.1"], "--sample-interval"),
        (&["sweep", scene, "--store", "sqlite"], "--export"),
        (&["sweep", scene, "--want", "m"], "--result"),
        (&["symbolic", scene, "--to", "c"], "--format"),
        (&["validate", "--long"], "--slow"),
        (&["tradeoff", scene], "work-precision"),
    ] {
        let done = dir.run(arguments);
        assert_eq!(done.status, Some(2), "{arguments:?}: {}", done.err);
        let named = done.err.contains(&format!("exists: '{name}'"));
        assert!(named, "{arguments:?}: {}", done.err);
    }
    // Another command has no such option.
    let done = dir.run(&["check", scene, "--to", "c"]);
    assert!(!done.err.contains("exists: '--format'"), "{}", done.err);
}
