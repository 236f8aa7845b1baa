//! Groups that no result needs are not modelled, and the remaining results are the same to the last bit.

use crate::table::{Table, WEIGHTS, analyse, file, scene};
use dwell_study::{Analysis, StudyError, check};
use std::f64::consts::PI;

/// The crank-rocker with a massless dyad on its coupler, and these variables.
fn extended(tip: f64, variables: &str) -> String {
    let bodies = format!(
        "[bodies.arm]\npoints = {{ E = [0, 0], F = [0.4, 0] }}\n\
         [bodies.tip]\npoints = {{ G = [0, 0], F = [{tip}, 0] }}\n[joints]\n\
         E = {{ revolute = [\"coupler.E\", \"arm.E\"] }}\n\
         F = {{ revolute = [\"arm.F\", \"tip.F\"] }}\n\
         G = {{ revolute = [\"ground.G\", \"tip.G\"] }}"
    );
    WEIGHTS
        .replace("D = [0.5, -0.2]", "D = [0.5, -0.2], G = [0.6, 0.1]")
        .replace("C = [0.35, 0], G", "C = [0.35, 0], E = [0.15, 0.07], G")
        .replace("[joints]", &bodies)
        .replace("coupler = 0.6", "coupler = 0.6\narm = 0.5")
        .replace(
            "[requests]",
            &format!("[requests]\nvariables = [{variables}]"),
        )
}

const FEW: &str =
    r#""rocker", "coupler.C", "phi.actuator_force", "A", "C", "shaking", "power", "energy""#;
const COMMANDS: [Analysis; 3] = [
    Analysis::Kinematics,
    Analysis::Statics,
    Analysis::Kinetostatics,
];

#[test]
fn a_run_without_what_nothing_needs_agrees_to_the_last_bit() {
    for command in COMMANDS {
        let run = |variables: &str| {
            let result = analyse(&scene(&extended(0.35, variables)), command, 181);
            assert!(result.early_stop.is_none());
            let table = Table::parse(&file(&result, &format!("-{}.csv", command.name())));
            (table, result.outcome.summary)
        };
        let (pruned, summary) = run(FEW);
        let (full, full_summary) = run(&format!("{FEW}, \"tip.angle\""));
        assert!(
            summary.contains("no inertia, load or requested result: arm, tip\n"),
            "{summary}"
        );
        assert!(!full_summary.contains("not modelled"), "{full_summary}");
        assert!(full.has("tip.angle") && !pruned.has("tip.angle"));
        assert!(pruned.names.len() > 4);
        for name in &pruned.names {
            let bits = |table: &Table| -> Vec<u64> {
                // A zero may have either sign.
                let values = table.column(name).into_iter();
                values.map(|v| (v + 0.0).to_bits()).collect()
            };
            assert_eq!(bits(&pruned), bits(&full), "{command:?} {name}");
        }
    }
}

#[test]
fn check_tells_what_is_modelled_and_for_what() {
    let summary = |text: &str| check(&scene(text)).unwrap().summary;
    let pruned = summary(&extended(0.35, FEW));
    for line in [
        "    1. coupler, rocker: inertia, requests\n",
        "    2. arm, tip: skipped, it affects no inertia, load or requested result\n",
    ] {
        assert!(pruned.contains(line), "{pruned}");
    }
    let requested = summary(&extended(0.35, "\"F.magnitude\""));
    assert!(
        requested.contains("    2. arm, tip: requests\n"),
        "{requested}"
    );
    let loaded = extended(0.35, FEW).replace(
        "weight = {",
        "push = { force = \"tip.F\", direction = [1, 0], magnitude = 1.0 }\nweight = {",
    );
    let loaded = summary(&loaded);
    assert!(loaded.contains("    2. arm, tip: loads\n"), "{loaded}");
    let all = extended(0.35, FEW).replace(&format!("variables = [{FEW}]"), "");
    assert!(summary(&all).contains("every group"), "{}", summary(&all));
    let few = extended(0.35, FEW).replace("[requests]", "[requests]\nreactions = [\"A\"]");
    let few = summary(&few);
    assert!(few.contains("by `reduce` and `simulate`"), "{few}");
}

/// The machine stops where any part of it does, whether the part is modelled or not.
#[test]
fn a_part_that_is_not_modelled_still_ends_the_way() {
    let stop = |text: &str| {
        let result = analyse(&scene(text), Analysis::Kinematics, 61);
        let Some(StudyError::Scene(error)) = result.early_stop else {
            panic!("it did not stop");
        };
        (error.message, result.outcome.summary)
    };
    let one = |variables: &str| stop(&extended(0.12, variables));
    // Two cranks of their own, whose ends a massless dyad joins.
    let two = |variables: &str| {
        let text = format!(
            "[bodies.ground]\npoints = {{ A = [0, 0], D = [1, 0] }}\n\
             [bodies.one]\npoints = {{ A = [0, 0], B = [0.3, 0] }}\nmass = 1.0\ncenter = [0, 0]\ninertia = 0.1\n\
             [bodies.two]\npoints = {{ D = [0, 0], C = [0.3, 0] }}\nmass = 1.0\ncenter = [0, 0]\ninertia = 0.1\n\
             [bodies.left]\npoints = {{ B = [0, 0], E = [0.4, 0] }}\n\
             [bodies.right]\npoints = {{ C = [0, 0], E = [0.4, 0] }}\n[joints]\n\
             A = {{ revolute = [\"ground.A\", \"one.A\"] }}\nD = {{ revolute = [\"ground.D\", \"two.D\"] }}\n\
             B = {{ revolute = [\"one.B\", \"left.B\"] }}\nC = {{ revolute = [\"two.C\", \"right.C\"] }}\n\
             E = {{ revolute = [\"left.E\", \"right.E\"] }}\n\
             [actuators]\nphi = {{ angle = [\"ground\", \"one\"] }}\npsi = {{ angle = [\"ground\", \"two\"] }}\n\
             [assembly]\nphi = 0.0\npsi = {PI:?}\nleft = 1.0\n[coordinate-sweep]\nphi = [0.0, 3.0]\npsi = {PI:?}\n\
             [requests]\nvariables = [{variables}]\n"
        );
        stop(&text)
    };
    for (pruned, full) in [
        (one("\"rocker\""), one("\"rocker\", \"tip\"")),
        (two("\"one\""), two("\"one\", \"left\"")),
    ] {
        assert_eq!(pruned.0, full.0);
        assert!(pruned.1.contains("not modelled") && !full.1.contains("not modelled"));
    }
    // B is then 0.8 m from C = (0.7, 0): 0.09 + 0.49 − 0.42 cos φ = 0.64.
    let (message, _) = two("\"one\"");
    let stated = message.split("phi = ").nth(1).unwrap();
    let stated: f64 = stated.split(' ').next().unwrap().parse().unwrap();
    // Eight digits are printed.
    assert!((stated - (-1.0_f64 / 7.0).acos()).abs() < 1e-7, "{message}");
}

/// Three cranks hold one coupler and share its forces in no unique proportion, but those of a dyad on it are
/// determined: `reduce` gives these alone, and each under its own name.
#[test]
fn reduce_leaves_out_reactions_that_are_not_unique() {
    let home = concat!(env!("CARGO_MANIFEST_DIR"), "/../../validation/");
    let path = format!("{home}parallelogram-three-cranks/scene.toml");
    let dyad = "[bodies.arm]\npoints = { H = [0, 0], P = [0.4, 0] }\nmass = 0.5\ncenter = [0.2, 0]\n\
                inertia = 0.01\n[bodies.tip]\npoints = { G = [0, 0], P = [0.4, 0] }\nmass = 0.4\n\
                center = [0.2, 0]\ninertia = 0.01\n[joints]\n\
                H = { revolute = [\"coupler.H\", \"arm.H\"] }\n\
                G = { revolute = [\"ground.G\", \"tip.G\"] }\n\
                P = { revolute = [\"arm.P\", \"tip.P\"] }";
    let text = std::fs::read_to_string(path).unwrap();
    let text = text
        .replace("E = [0.9, 0.1] }", "E = [0.9, 0.1], G = [0.9, 0.8] }")
        .replace("F = [0.9, 0.1] }", "F = [0.9, 0.1], H = [0.45, 0.3] }")
        .replace("[joints]", dyad)
        .replace("[assembly]", "[assembly]\narm = 0.0");
    let reduced = |reactions: &str| {
        let requests = format!("[requests]\nreactions = [{reactions}]");
        let scene = scene(&text.replace("[requests]", &requests));
        let outcome = dwell_study::reduce(&scene, None, None).unwrap();
        let mut files = outcome.files.iter();
        let is_table = |path: &std::path::Path| path.to_str().unwrap().ends_with("-reduced.csv");
        let (_, bytes) = files.find(|(path, _)| is_table(path)).unwrap();
        let table = Table::parse(std::str::from_utf8(bytes).unwrap());
        (table, outcome.summary)
    };
    let (all, summary) = reduced(r#""A", "P", "C", "G.y""#);
    assert_eq!(
        all.names[..9],
        [
            "phi", "m", "half_dm", "P.x.a", "P.x.b", "P.y.a", "P.y.b", "G.y.a", "G.y.b"
        ]
    );
    // Then what the weight gives the coordinate, and these three.
    let unit_loads = [
        "V",
        "weight.w",
        "P.x.c.weight",
        "P.y.c.weight",
        "G.y.c.weight",
        "relative_error",
    ];
    assert_eq!(all.names[9..], unit_loads);
    assert!(
        summary.contains("share the load), so in no table: A.x, A.y, C.x, C.y\n"),
        "{summary}"
    );
    let (alone, summary) = reduced(r#""G.y""#);
    assert!(!summary.contains("share"), "{summary}");
    for name in ["m", "half_dm", "G.y.a", "G.y.b"] {
        assert_eq!(all.column(name), alone.column(name), "{name}");
    }
}
