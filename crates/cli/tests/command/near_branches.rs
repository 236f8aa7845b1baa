//! Mechanisms next to a change point: status and messages.

use crate::test_dir::{Run, TestDir};

/// A free parallelogram whose coupler has this length, m.
fn parallelogram(coupler: &str) -> String {
    format!(
        r#"
[bodies.ground]
points = {{ A = [0, 0], D = [0.4, 0] }}
[bodies.crank]
points = {{ A = [0, 0], B = [0.2, 0] }}
mass = 1.0
center = [0.1, 0]
inertia = 0.01
[bodies.coupler]
points = {{ B = [0, 0], C = [{coupler}, 0] }}
mass = 2.0
center = [0.2, 0.05]
inertia = 0.03
[bodies.rocker]
points = {{ D = [0, 0], C = [0.2, 0] }}
mass = 0.5
center = [0.1, 0]
inertia = 0.002
[joints]
A = {{ revolute = ["ground.A", "crank.A"] }}
B = {{ revolute = ["crank.B", "coupler.B"] }}
C = {{ revolute = ["coupler.C", "rocker.C"] }}
D = {{ revolute = ["ground.D", "rocker.D"] }}
[actuators.phi]
angle = ["ground", "crank"]
[assembly]
phi = 1.0
coupler = 0.0
rocker = 1.0
[motion]
initial-coordinate = {{ phi = 1.0 }}
initial-velocity = {{ phi = 10.0 }}
duration = 1.3
"#
    )
}

fn simulate(coupler: &str, arguments: &[&str]) -> Run {
    let dir = TestDir::new();
    dir.put("bar.toml", parallelogram(coupler));
    let command = ["simulate", "bar.toml", "--sample-interval", "0.013"];
    dir.run(&[&command, arguments, &["--out", "o"]].concat())
}

#[test]
fn what_rounding_does_not_decide_is_status_1() {
    for coupler in ["0.400000000001", "0.39999999999999"] {
        for how in [
            ["--method", "bdf"],
            ["--method", "dop853"],
            ["--method", "tsit45"],
            ["--accuracy", "1e-6"],
        ] {
            let run = simulate(coupler, &how);
            assert_eq!(run.status, Some(1), "{coupler} {how:?}: {}", run.err);
            let words = run.err.replace("\n  │ ", " ");
            for part in ["coupler", "rocker", "nearly meet", "rounding does not show"] {
                assert!(words.contains(part), "{coupler} {how:?}: {}", run.err);
            }
            assert!(!run.err.contains("0 steps"), "{}", run.err);
        }
    }
}

/// An exact change point is crossed by every method, at rough tolerances too: no status 2 for a valid scene.
#[test]
fn an_exact_change_point_is_crossed() {
    for how in [
        ["--method", "bdf"],
        ["--method", "dop853"],
        ["--rtol", "1e-4"],
        ["--accuracy", "1e-6"],
        ["--accuracy", "1e-3"],
    ] {
        let run = simulate("0.4", &how);
        assert_eq!((run.status, run.err.as_str()), (Some(0), ""), "{how:?}");
        assert!(run.out.contains("change point crossed"), "{}", run.out);
        assert!(run.out.contains("over the whole motion"), "{}", run.out);
    }
}

/// A four-bar whose crank does not rotate fully, on a carriage that moves: no two coordinates are continued across a
/// dead point. Every method ends there by name; two implicit ones stayed there with 0.7 of the energy lost and status 0,
/// or took the scene for an invalid one.
#[test]
fn a_dead_point_of_two_freedoms_is_status_1() {
    let carriage = "points = { O = [0, 0] }\n[bodies.carriage]\npoints = { O = [0, 0], A = [0, 0], D = [0.4, 0] }\n\
                    mass = 3.0\ncenter = [0.2, 0]\ninertia = 0.1";
    let rail = "[joints]\nrail = { prismatic = [\"ground.O\", \"carriage.O\"], axis = [1, 0] }";
    let text = parallelogram("0.5")
        .replace("points = { A = [0, 0], D = [0.4, 0] }", carriage)
        .replace("[joints]", rail)
        .replace("\"ground.A\"", "\"carriage.A\"")
        .replace("\"ground.D\"", "\"carriage.D\"")
        .replace("[\"ground\", \"crank\"]", "[\"carriage\", \"crank\"]")
        .replace(
            "[assembly]",
            "[actuators.x]\nlength = \"rail\"\n[assembly]\nx = 0.0",
        )
        .replace("{ phi = 1.0 }", "{ phi = 1.0, x = 0.0 }")
        .replace("{ phi = 10.0 }", "{ phi = 10.0, x = 0.3 }");
    for method in ["tr-bdf2", "esdirk34", "tsit45", "dop853"] {
        let dir = TestDir::new();
        dir.put("bar.toml", &text);
        let run = dir.run(&["simulate", "bar.toml", "--method", method, "--out", "o"]);
        assert_eq!(run.status, Some(1), "{method}: {} {}", run.out, run.err);
        let words = run.err.replace("\n  │ ", " ");
        let said = [
            "cannot be assembled",
            "singular",
            "too small",
            "energy balance closes",
        ];
        assert!(
            said.iter().any(|part| words.contains(part)),
            "{method}: {words}"
        );
        assert!(!dir.files("o").is_empty(), "{method}");
    }
}
