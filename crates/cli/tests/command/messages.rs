//! Messages for invalid input, which are reviewed in the snapshots. Each of these inputs ends
//! with exit status 2, nothing on standard output but what was found before, and no file touched.

use crate::test_dir::{LIMITED, TestDir, four_bar_with};
use std::fmt::Write as _;

/// Collects the messages of a group of inputs.
pub(crate) struct Group {
    pub(crate) dir: TestDir,
    text: String,
}

impl Group {
    pub(crate) fn new() -> Self {
        Self {
            dir: TestDir::new(),
            text: String::new(),
        }
    }

    /// Runs the command and notes what it says.
    pub(crate) fn refused(&mut self, title: &str, arguments: &[&str]) {
        let before = self.dir.contents();
        let run = self.dir.run(arguments);
        assert_eq!(run.status, Some(2), "{title}: {run:?}");
        assert_eq!(run.out, "", "{title}");
        assert!(!run.err.contains("panicked"), "{title}: {}", run.err);
        assert!(self.dir.contents() == before, "{title}: a file was touched");
        let _ = writeln!(
            self.text,
            "# {title}\n$ dwell {}\n{}\n",
            arguments.join(" "),
            run.err.trim_end()
        );
    }

    /// The same for a scene, in a file of its own.
    pub(crate) fn scene(&mut self, title: &str, command: &str, scene: impl AsRef<[u8]>) {
        self.dir.put("scene.toml", scene);
        self.refused(title, &[command, "scene.toml"]);
    }

    pub(crate) fn check(self, name: &str) {
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
    group.dir.put("four-bar.toml", four_bar_with(&[]));
    group.dir.put("case/scene.toml", four_bar_with(&[]));
    group.dir.put("program", b"\x7fELF\x02\x01\0\0\xff\xfe\0");
    group.refused("no such file", &["check", "six-bar.toml"]);
    group.refused("the ending left out", &["check", "four-bar"]);
    group.refused("a folder", &["reduce", "case"]);
    group.refused("a program", &["check", "program"]);
    group.scene("an empty file", "check", "");
    group.scene("Latin-1", "check", b"title = \"K\xf6rper\"\n");
    group.scene("broken off", "check", &four_bar_with(&[])[..190]);
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
        (
            "a speed beyond all bounds",
            "initial-velocity = 10.0",
            "initial-velocity = 1e150",
        ),
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
        group.scene(title, "check", four_bar_with(&[(old, new)]));
    }
    let long = format!("\"{}\"", "A title that goes on and on. ".repeat(8).trim());
    group.scene(
        "a long title",
        "check",
        four_bar_with(&[("\"Four-bar\"", &long)]),
    );
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
    (
        "[motion]\ninitial-coordinate = 1.0\ninitial-velocity = 10.0\nperiods = 2\n",
        "",
    ),
];

#[test]
fn mechanisms() {
    let mut group = Group::new();
    let short = [("C = [0.35, 0]", "C = [0.05, 0]")];
    group.scene("bars too short", "check", four_bar_with(&short));
    let open = [("coupler = 0.6\n", "")];
    group.scene("two ways to assemble", "check", four_bar_with(&open));
    let straight = [
        ("B = [0.1, 0]", "B = [0.05, 0]"),
        ("C = [0.35, 0]", "C = [0.15, 0]"),
        ("C = [0.3, 0]", "C = [0.2, 0]"),
        ("phi = 1.0", "phi = 0.0"),
    ];
    group.scene(
        "a start in a limit position",
        "check",
        four_bar_with(&straight),
    );
    group.scene("two degrees of freedom", "check", four_bar_with(&FIVE_BAR));
    group.scene(
        "two actuators on one",
        "check",
        four_bar_with(&TWO_ACTUATORS),
    );
    let both = [FIVE_BAR, TWO_ACTUATORS].concat();
    group.scene("two actuators on two", "reduce", four_bar_with(&both));
    let none = [
        ("[actuators.phi]\nangle = [\"ground\", \"crank\"]\n", ""),
        ("phi = 1.0\n", ""),
        TWO_ACTUATORS[1],
    ];
    group.scene("no actuator", "reduce", four_bar_with(&none));
    let braced = [(
        "[actuators.phi]",
        "E = { revolute = [\"ground.D\", \"coupler.C\"] }\n[actuators.phi]",
    )];
    group.scene("no degree of freedom", "check", four_bar_with(&braced));
    let loose = [(
        "[joints]",
        "[bodies.a]\npoints = { P = [0, 0] }\n[bodies.b]\npoints = { P = [0, 0] }\n[joints]\n\
         P = { revolute = [\"a.P\", \"b.P\"] }",
    )];
    group.scene("bodies held by nothing", "check", four_bar_with(&loose));
    group.check("mechanisms");
}

#[test]
fn motions() {
    let mut group = Group::new();
    let still = four_bar_with(&[TWO_ACTUATORS[1]]);
    group.scene("no motion", "simulate", still);
    for (title, old, new) in [
        ("at rest", "initial-velocity = 10.0", "initial-velocity = 0"),
        (
            "nearly at rest",
            "initial-velocity = 10.0",
            "initial-velocity = 1e-200",
        ),
        ("too short", "periods = 2", "duration = 1e-200"),
    ] {
        group.scene(title, "simulate", four_bar_with(&[(old, new)]));
    }
    let massless: String = four_bar_with(&[])
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
    group.scene(
        "periods without a whole turn",
        "simulate",
        four_bar_with(&near),
    );
    let outside = [
        &LIMITED[..],
        &[("initial-coordinate = 1.0", "initial-coordinate = 3.0")],
    ]
    .concat();
    group.scene(
        "a start outside the range",
        "simulate",
        four_bar_with(&outside),
    );
    let beyond = [&LIMITED[..], &[("phi = 1.0", "phi = 3.0")]].concat();
    group.scene(
        "an assembly outside the range",
        "reduce",
        four_bar_with(&beyond),
    );
    group.check("motions");
}

#[test]
fn calibrations() {
    let mut group = Group::new();
    group.dir.put("scene.toml", four_bar_with(&[]));
    let mut refused = |title: &str, value: &str, period: &str| {
        let arguments = [
            "calibrate",
            "scene.toml",
            "--parameter",
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
    let speed = four_bar_with(&[("initial-velocity = 10.0", "initial-velocity = 0")]);
    group.dir.put("scene.toml", speed);
    let arguments = [
        "calibrate",
        "scene.toml",
        "--parameter",
        "crank.mass",
        "--period",
        "1",
    ];
    group.refused("at rest", &arguments);
    let damper =
        "[loads]\nbrake = { rotational-damper = [\"ground\", \"rocker\"], damping = 1 }\n[motion]";
    let drive = "[drives]\npush = { applied-force = \"phi\", magnitude = 3 }\n[motion]";
    for (title, added) in [("with a damper", damper), ("with a drive", drive)] {
        group
            .dir
            .put("scene.toml", four_bar_with(&[("[motion]", added)]));
        group.refused(title, &arguments);
    }
    group.check("calibrations");
}

#[test]
fn validations() {
    let mut group = Group::new();
    group.refused("no folder of cases", &["validate"]);
    group.dir.put("cases/notes.txt", "");
    group.refused("no case in it", &["validate", "--folder", "cases"]);
    group.dir.put("cases/a/scene.toml", four_bar_with(&[]));
    group.refused("an unknown case", &["validate", "b", "--folder", "cases"]);
    group.dir.put(
        "cases/b/scene.toml",
        four_bar_with(&[("mass = 1.0", "mass = -1.0")]),
    );
    group.dir.put(
        "cases/c/scene.toml",
        four_bar_with(&[("D = [0.4, 0]", "D = [4, 0]")]),
    );
    group.dir.put("cases/d/scene.toml", "title = 3");
    group.refused(
        "three that cannot be validated",
        &["validate", "b", "c", "d", "--folder", "cases"],
    );
    group.dir.put("other/a/scene.toml", four_bar_with(&[]));
    group.refused("two of one name", &["validate", "cases/a", "other/a"]);
    group.refused("a scene file", &["validate", "cases/notes.txt"]);
    for (title, reference) in [
        ("no TOML", "source = \"me\"\nsamples = [ "),
        ("an unknown key", "sample = []"),
        ("no position", "samples = [{ m = 1 }]"),
        (
            "an unknown reaction",
            "samples = [{ q = 0, reactions = { \"E.x\" = { a = 1, b = 1 } } }]",
        ),
        (
            "half a reaction",
            "samples = [{ q = 0, reactions = { \"A.x\" = { a = 1 } } }]",
        ),
        ("a number in words", "samples = [{ q = \"one\" }]"),
        ("a misspelt quantity", "samples = [{ q = 1, m_kg_m2 = 1 }]"),
        ("nothing to compare", "samples = [{ q = 1 }]"),
        ("an unknown point", "samples = [{ q = 1, E_m = [0, 1] }]"),
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
        group.dir.put("cases/a/case.toml", reference);
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
    group.scene("nothing drives it", "cycle", four_bar_with(&[]));
    let drive = |change: &str, engine: &str| format!("{change}\n[drives]\nengine = {{ {engine} }}");
    let action = "applied-force = \"phi\", magnitude = 2.0";
    let limited = [LIMITED[0], LIMITED[1], LIMITED[2]];
    let text = drive("duration = 2", action);
    let limited: Vec<_> = limited
        .into_iter()
        .chain([("periods = 2", text.as_str())])
        .collect();
    group.scene(
        "a crank that does not turn",
        "cycle",
        four_bar_with(&limited),
    );
    let text = drive(
        "duration = 2",
        "applied-force = \"phi\", magnitude = \"2 + t\"",
    );
    group.scene(
        "a drive that follows time",
        "cycle",
        four_bar_with(&[("periods = 2", &text)]),
    );
    group.scene(
        "an equilibrium in time",
        "equilibria",
        four_bar_with(&[("periods = 2", &text)]),
    );
    let text = drive("duration = 2", action);
    group.scene(
        "a force that never ends",
        "linearise",
        four_bar_with(&[("periods = 2", &text)]),
    );
    group.dir.put("scene.toml", four_bar_with(&[]));
    for ratio in ["0", "-0.1", "3", "much"] {
        let arguments = ["cycle", "scene.toml", "--fluctuation", ratio];
        group.refused("a wrong fluctuation", &arguments);
    }
    group.check("machines");
}

#[test]
fn arguments() {
    let mut group = Group::new();
    group.dir.put("scene.toml", four_bar_with(&[]));
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
        "--table-accuracy",
        "1e-9",
    ];
    group.refused("an accuracy and a table", &both);
    group.refused("no scene", &["reduce"]);
    group.refused("an unknown command", &["animate", "scene.toml"]);
    let method = ["simulate", "scene.toml", "--method", "rk4"];
    group.refused("an unknown method", &method);
    group.dir.put("notes", "mine");
    group.refused(
        "a file for a folder",
        &["reduce", "scene.toml", "--out", "notes"],
    );
    group.check("arguments");
}
