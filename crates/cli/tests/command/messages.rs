//! What a careless user is told: the words are reviewed in the snapshots. Each of these inputs ends
//! with exit status 2, nothing on standard output but what was found before, and no file touched.

use crate::bench::{Bench, LIMITED, with};
use std::fmt::Write as _;

/// Collects the messages of a group of inputs.
struct Group {
    bench: Bench,
    text: String,
}

impl Group {
    fn new() -> Self {
        Self {
            bench: Bench::new(),
            text: String::new(),
        }
    }

    /// Runs the command and notes what it says.
    fn refused(&mut self, title: &str, arguments: &[&str]) {
        let before = self.bench.contents();
        let run = self.bench.run(arguments);
        assert_eq!(run.status, Some(2), "{title}: {run:?}");
        assert_eq!(run.out, "", "{title}");
        assert!(!run.err.contains("panicked"), "{title}: {}", run.err);
        assert!(
            self.bench.contents() == before,
            "{title}: a file was touched"
        );
        let _ = writeln!(
            self.text,
            "# {title}\n$ dwell {}\n{}\n",
            arguments.join(" "),
            run.err.trim_end()
        );
    }

    /// The same for a scene, in a file of its own.
    fn scene(&mut self, title: &str, command: &str, scene: impl AsRef<[u8]>) {
        self.bench.put("scene.toml", scene);
        self.refused(title, &[command, "scene.toml"]);
    }

    fn check(self, name: &str) {
        let mut settings = insta::Settings::clone_current();
        settings.set_snapshot_path("../snapshots");
        settings.set_prepend_module_to_snapshot(false);
        settings.set_omit_expression(true);
        settings.bind(|| insta::assert_snapshot!(name, self.text));
    }
}

#[test]
fn files() {
    let mut group = Group::new();
    group.bench.put("four-bar.toml", with(&[]));
    group.bench.put("case/scene.toml", with(&[]));
    group.bench.put("program", b"\x7fELF\x02\x01\0\0\xff\xfe\0");
    group.refused("no such file", &["check", "six-bar.toml"]);
    group.refused("the ending left out", &["check", "four-bar"]);
    group.refused("a folder", &["reduce", "case"]);
    group.refused("a program", &["check", "program"]);
    group.scene("an empty file", "check", "");
    group.scene("Latin-1", "check", b"title = \"K\xf6rper\"\n");
    group.scene("broken off", "check", &with(&[])[..190]);
    group.scene(
        "a line of a megabyte",
        "check",
        format!("x = [{}] 3", "1,".repeat(500_000)),
    );
    group.check("files");
}

#[test]
fn scenes() {
    let mut group = Group::new();
    for (title, old, new) in [
        ("an unknown body", "\"coupler.C\"", "\"cuopler.C\""),
        ("an unknown point", "\"coupler.C\"", "\"coupler.E\""),
        ("a body joined to itself", "\"coupler.C\"", "\"rocker.D\""),
        ("a negative mass", "mass = 1.0", "mass = -1.0"),
        ("no number", "mass = 1.0", "mass = nan"),
        ("a speed beyond all bounds", "speed = 10.0", "speed = 1e150"),
        ("an angle of too many turns", "phi = 1.0", "phi = 1e50"),
        (
            "an axis without length",
            "C = { revolute = [\"coupler.C\", \"rocker.C\"] }",
            "C = { prismatic = [\"coupler.C\", \"rocker.C\"], axis = [0, 0] }",
        ),
        (
            "an unknown joint in the requests",
            "[motion]",
            "[requests]\nreactions = [\"E\"]\n[motion]",
        ),
        (
            "three errors at once",
            "[joints]",
            "[bodies.weight]\nmass = 1\n[joints]",
        ),
    ] {
        group.scene(title, "check", with(&[(old, new)]));
    }
    let long = format!("\"{}\"", "A title that goes on and on. ".repeat(8).trim());
    group.scene("a long title", "check", with(&[("\"Four-bar\"", &long)]));
    group.check("scenes");
}

/// A second link makes the four-bar a five-bar.
const FIVE_BAR: [(&str, &str); 2] = [
    (
        "[bodies.rocker]",
        "[bodies.link]\npoints = { C = [0, 0], E = [0.2, 0] }\n[bodies.rocker]",
    ),
    (
        "C = { revolute = [\"coupler.C\", \"rocker.C\"] }",
        "C = { revolute = [\"coupler.C\", \"link.C\"] }\nE = { revolute = [\"link.E\", \"rocker.C\"] }",
    ),
];
/// A second actuator; the motion goes, since it has no second speed.
const TWO_ACTUATORS: [(&str, &str); 2] = [
    (
        "[assembly]",
        "[actuators.psi]\nangle = [\"ground\", \"rocker\"]\n[assembly]\npsi = 1.8",
    ),
    ("[motion]\nstart = 1.0\nspeed = 10.0\nperiods = 2\n", ""),
];

#[test]
fn mechanisms() {
    let mut group = Group::new();
    let short = [("C = [0.35, 0]", "C = [0.05, 0]")];
    group.scene("bars too short", "check", with(&short));
    let open = [("coupler = 0.6\n", "")];
    group.scene("two ways to assemble", "check", with(&open));
    let straight = [
        ("B = [0.1, 0]", "B = [0.05, 0]"),
        ("C = [0.35, 0]", "C = [0.15, 0]"),
        ("C = [0.3, 0]", "C = [0.2, 0]"),
        ("phi = 1.0", "phi = 0.0"),
    ];
    group.scene("a start in a limit position", "check", with(&straight));
    group.scene("two degrees of freedom", "check", with(&FIVE_BAR));
    group.scene("two actuators on one", "check", with(&TWO_ACTUATORS));
    let both = [FIVE_BAR, TWO_ACTUATORS].concat();
    group.scene("two actuators on two", "reduce", with(&both));
    let none = [
        ("[actuators.phi]\nangle = [\"ground\", \"crank\"]\n", ""),
        ("phi = 1.0\n", ""),
        TWO_ACTUATORS[1],
    ];
    group.scene("no actuator", "reduce", with(&none));
    let braced = [(
        "[actuators.phi]",
        "E = { revolute = [\"ground.D\", \"coupler.C\"] }\n[actuators.phi]",
    )];
    group.scene("no degree of freedom", "check", with(&braced));
    let loose = [(
        "[joints]",
        "[bodies.a]\npoints = { P = [0, 0] }\n[bodies.b]\npoints = { P = [0, 0] }\n[joints]\n\
         P = { revolute = [\"a.P\", \"b.P\"] }",
    )];
    group.scene("bodies held by nothing", "check", with(&loose));
    group.check("mechanisms");
}

#[test]
fn motions() {
    let mut group = Group::new();
    let still = with(&[TWO_ACTUATORS[1]]);
    group.scene("no motion", "simulate", still);
    for (title, old, new) in [
        ("at rest", "speed = 10.0", "speed = 0"),
        ("nearly at rest", "speed = 10.0", "speed = 1e-200"),
        ("too short", "periods = 2", "duration = 1e-200"),
    ] {
        group.scene(title, "simulate", with(&[(old, new)]));
    }
    let massless: String = with(&[])
        .lines()
        .filter(|l| {
            !["mass", "center", "inertia"]
                .iter()
                .any(|k| l.starts_with(k))
        })
        .map(|l| format!("{l}\n"))
        .collect();
    group.scene("no mass at all", "simulate", &massless);
    // A body with mass that nothing moves: it slides along a bar between two fixed pivots.
    let at_rest = massless
        .replace("coupler = 0.6", "coupler = 0.6\npost = 0")
        .replace(
            "[joints]",
            "[bodies.post]\npoints = { P = [0, 0] }\nmass = 3\ncenter = \"P\"\n[bodies.strut]\n\
             points = { P = [0, 0], R = [0.2, 0] }\n[joints]\n\
             P = { revolute = [\"ground.A\", \"post.P\"] }\n\
             S = { prismatic = [\"post.P\", \"strut.P\"], axis = [1, 0] }\n\
             R = { revolute = [\"strut.R\", \"ground.D\"] }",
        );
    group.scene("mass in a body at rest", "simulate", &at_rest);
    let near = LIMITED.map(|(old, new)| (old, if old.starts_with("per") { old } else { new }));
    group.scene("periods without a whole turn", "simulate", with(&near));
    let outside = [&LIMITED[..], &[("start = 1.0", "start = 3.0")]].concat();
    group.scene("a start outside the range", "simulate", with(&outside));
    let beyond = [&LIMITED[..], &[("phi = 1.0", "phi = 3.0")]].concat();
    group.scene("an assembly outside the range", "reduce", with(&beyond));
    group.check("motions");
}

#[test]
fn calibrations() {
    let mut group = Group::new();
    group.bench.put("scene.toml", with(&[]));
    let mut refused = |title: &str, value: &str, period: &str| {
        let arguments = [
            "calibrate",
            "scene.toml",
            "--set",
            value,
            "--period",
            period,
        ];
        group.refused(title, &arguments);
    };
    refused("an unknown value", "crank.inertai", "0.7");
    refused("a body for a value", "crank", "0.7");
    refused("a value that is zero", "coupler.center[1]", "0.7");
    refused("a period out of reach", "crank.inertia", "0.5");
    refused(
        "a value that takes the bars apart",
        "crank.points.B[0]",
        "5",
    );
    refused("a negative period", "crank.inertia", "-0.7");
    refused("a period of text", "crank.inertia", "soon");
    group.refused("nothing to set", &["calibrate", "scene.toml"]);
    let speed = with(&[("speed = 10.0", "speed = 0")]);
    group.bench.put("scene.toml", speed);
    let arguments = [
        "calibrate",
        "scene.toml",
        "--set",
        "crank.mass",
        "--period",
        "1",
    ];
    group.refused("at rest", &arguments);
    // A free motion knows no loads: a value fitted without them would be another one.
    let weight = "[loads]\nweight = { gravity = [0, -9.81] }\n[motion]";
    group.bench.put("scene.toml", with(&[("[motion]", weight)]));
    group.refused("under its weight", &arguments);
    group.check("calibrations");
}

#[test]
fn validations() {
    let mut group = Group::new();
    group.refused("no folder of cases", &["validate"]);
    group.bench.put("cases/notes.txt", "");
    group.refused("no case in it", &["validate", "--folder", "cases"]);
    group.bench.put("cases/a/scene.toml", with(&[]));
    group.refused("an unknown case", &["validate", "b", "--folder", "cases"]);
    group
        .bench
        .put("cases/b/scene.toml", with(&[("mass = 1.0", "mass = -1.0")]));
    group.bench.put(
        "cases/c/scene.toml",
        with(&[("D = [0.4, 0]", "D = [4, 0]")]),
    );
    group.bench.put("cases/d/scene.toml", "title = 3");
    group.refused(
        "three that cannot be validated",
        &["validate", "b", "c", "d", "--folder", "cases"],
    );
    group.bench.put("other/a/scene.toml", with(&[]));
    group.refused("two of one name", &["validate", "cases/a", "other/a"]);
    group.refused("a scene file", &["validate", "cases/notes.txt"]);
    for (title, reference) in [
        ("no TOML", "source = \"me\"\nsamples = [ "),
        ("an unknown key", "sample = []"),
        ("no position", "samples = [{ m1_kg_m2 = 1 }]"),
        (
            "an unknown reaction",
            "samples = [{ phi_rad = 0, reactions = { \"E.x\" = { a = 1, b = 1 } } }]",
        ),
        (
            "half a reaction",
            "samples = [{ phi_rad = 0, reactions = { \"A.x\" = { a = 1 } } }]",
        ),
        ("a number in words", "samples = [{ phi_rad = \"one\" }]"),
        (
            "a misspelt quantity",
            "samples = [{ phi_rad = 1, m_kg_m2 = 1 }]",
        ),
        ("nothing to compare", "samples = [{ phi_rad = 1 }]"),
        (
            "an unknown point",
            "samples = [{ phi_rad = 1, E_m = [0, 1] }]",
        ),
        (
            "a motion without its period",
            "free_motion = { period = 1 }",
        ),
        (
            "a tolerance for no finding",
            "[tolerances]\nm-energi = 1e-14",
        ),
        (
            "a tolerance that is none",
            "[tolerances]\nm-energy = \"small\"",
        ),
    ] {
        group.bench.put("cases/a/case.toml", reference);
        group.refused(
            &format!("a case.toml with {title}"),
            &["validate", "cases/a"],
        );
    }
    group.check("validations");
}

#[test]
fn machines() {
    let mut group = Group::new();
    group.scene("nothing drives it", "cycle", with(&[]));
    let drive = |change: &str, engine: &str| format!("{change}\n[drives]\nengine = {{ {engine} }}");
    let action = "action = \"phi\", magnitude = 2.0";
    let limited = [LIMITED[0], LIMITED[1], LIMITED[2]];
    let text = drive("duration = 2", action);
    let limited: Vec<_> = limited
        .into_iter()
        .chain([("periods = 2", text.as_str())])
        .collect();
    group.scene("a crank that does not turn", "cycle", with(&limited));
    let text = drive("duration = 2", "action = \"phi\", magnitude = \"2 + t\"");
    group.scene(
        "a drive that follows time",
        "cycle",
        with(&[("periods = 2", &text)]),
    );
    group.scene(
        "an equilibrium in time",
        "equilibria",
        with(&[("periods = 2", &text)]),
    );
    group.scene("no force at all", "equilibria", with(&[]));
    let text = drive("duration = 2", action);
    group.scene(
        "a force that never ends",
        "linearise",
        with(&[("periods = 2", &text)]),
    );
    group.scene(
        "a drive that nothing holds",
        "cycle",
        with(&[("periods = 2", &text)]),
    );
    group.bench.put("scene.toml", with(&[]));
    for ratio in ["0", "-0.1", "3", "much"] {
        let arguments = ["cycle", "scene.toml", "--fluctuation", ratio];
        group.refused("a wrong fluctuation", &arguments);
    }
    group.check("machines");
}

#[test]
fn arguments() {
    let mut group = Group::new();
    group.bench.put("scene.toml", with(&[]));
    for rtol in ["0", "1e-20", "-1e-6", "0.5", "fine", "nan"] {
        group.refused(
            &format!("a tolerance of {rtol}"),
            &["simulate", "scene.toml", "--rtol", rtol],
        );
    }
    for accuracy in ["0", "1e-20", "0.5", "fine", "nan"] {
        group.refused(
            &format!("a wanted accuracy of {accuracy}"),
            &["simulate", "scene.toml", "--accuracy", accuracy],
        );
    }
    let both = [
        "simulate",
        "scene.toml",
        "--accuracy",
        "draft",
        "--rtol",
        "1e-9",
    ];
    group.refused("an accuracy and a tolerance", &both);
    let both = [
        "reduce",
        "scene.toml",
        "--accuracy",
        "draft",
        "--table",
        "1e-9",
    ];
    group.refused("an accuracy and a table", &both);
    group.refused("no scene", &["reduce"]);
    group.refused("an unknown command", &["animate", "scene.toml"]);
    let method = ["simulate", "scene.toml", "--method", "rk4"];
    group.refused("an unknown method", &method);
    group.bench.put("notes", "mine");
    group.refused(
        "a file for a folder",
        &["reduce", "scene.toml", "--out", "notes"],
    );
    group.check("arguments");
}

#[test]
fn tables() {
    let mut group = Group::new();
    group.bench.put("scene.toml", with(&[]));
    group.bench.put("limited.toml", with(&LIMITED));
    let spring =
        "\n[loads]\nspring = { torsion = [\"ground\", \"crank\"], stiffness = 2, free = 0 }\n";
    group.bench.put("winds.toml", with(&[]) + spring);
    for accuracy in ["0", "1e-20", "1", "-1e-9", "fine", "nan"] {
        group.refused(
            &format!("an accuracy of {accuracy}"),
            &["reduce", "scene.toml", "--table", accuracy],
        );
    }
    for (title, scene, rest) in [
        ("a load that winds up", "winds.toml", &[][..]),
        (
            "beyond the range",
            "limited.toml",
            &["--from", "0", "--to", "400"],
        ),
        (
            "from the end to the beginning",
            "scene.toml",
            &["--from", "2", "--to", "1"],
        ),
        ("nothing", "scene.toml", &["--from", "1", "--to", "1"]),
        ("no end", "scene.toml", &["--from", "1"]),
        (
            "an infinite end",
            "scene.toml",
            &["--from", "-1", "--to", "inf"],
        ),
        (
            "a unit",
            "scene.toml",
            &["--from", "10deg", "--to", "20deg"],
        ),
        (
            "up to a limit position",
            "limited.toml",
            &["--from", "0", "--to", "1.3715642395"],
        ),
        ("many turns", "scene.toml", &["--from", "0", "--to", "1e5"]),
    ] {
        let arguments = ["reduce", scene, "--table", "1e-9"];
        group.refused(title, &[&arguments, rest].concat());
    }
    let arguments = ["reduce", "limited.toml", "--table", "1e-14"];
    group.refused("more than there is next to limit positions", &arguments);
    let arguments = ["reduce", "scene.toml", "--from", "0", "--to", "1"];
    group.refused("an extent of no table", &arguments);
    group.check("tables");
}

#[test]
fn sweeps() {
    let mut group = Group::new();
    group.bench.put("four-bar.toml", with(&[]));
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
    refused(&mut group, "an unknown result", &["--want", "perod"]);
    refused(&mut group, "an unknown form", &["--export", "xlsx"]);
    refused(
        &mut group,
        "a shard and an export",
        &["--shard", "1/2", "--export", "csv"],
    );
    group.refused("nothing varied", &["sweep", "four-bar.toml"]);
    group.bench.put(
        "text/four-bar-sweep.sqlite",
        "my own notes, and long enough not to be a header".repeat(4),
    );
    refused(&mut group, "a file that is no database", &["--out", "text"]);
    let own = [
        "sweep",
        "four-bar.toml",
        "--vary",
        "crank.inertia=0.001,0.002,0.003",
    ];
    let run = group.bench.run(&[&own[..], &["--out", "own"]].concat());
    assert_eq!(run.status, Some(0), "{run:?}");
    refused(&mut group, "a file of another study", &["--out", "own"]);
    group
        .bench
        .put("four-bar.toml", with(&[("mass = 1.0", "mass = 1.5")]));
    let changed = [&own[..], &["--out", "own"]].concat();
    group.refused("a scene that was changed since", &changed);
    group.check("sweeps");
}
