//! Mechanical advantage and poles, on request.

use crate::table::{Table, WEIGHTS, case, scene, table};
use dwell_scene::PlaneScene;
use dwell_study::Analysis;

fn requesting(text: &str, variables: &str) -> PlaneScene {
    let variables = format!("[requests]\nvariables = [{variables}]");
    scene(&text.replace("[requests]", &variables))
}

/// The four-bar of `weights.toml`: crank, coupler, rocker and base, m.
const BARS: [f64; 4] = [0.1, 0.35, 0.3, 0.4];

fn columns<const N: usize>(table: &Table, names: [&str; N]) -> [Vec<f64>; N] {
    names.map(|name| table.column(name))
}

#[test]
fn the_advantage_of_a_four_bar_is_that_of_its_angles() {
    let text = WEIGHTS.replace("[0.0, 6.283185307179586]", "[0.05, 6.25]");
    let names = r#""coupler.angle", "rocker", "rocker.mechanical_advantage", "rocker.C.mechanical_advantage", "crank.mechanical_advantage""#;
    let table = table(&requesting(&text, names), Analysis::Kinematics, 300);
    let [phi, coupler, rocker, found, point, crank] = columns(
        &table,
        [
            "phi",
            "coupler.angle",
            "rocker.angle",
            "rocker.mechanical_advantage",
            "rocker.C.mechanical_advantage",
            "crank.mechanical_advantage",
        ],
    );
    let [a, _, c, _] = BARS;
    let mut largest = 0.0_f64;
    for i in 0..phi.len() {
        // a φ̇ sin(φ − β) = c ψ̇ sin(ψ − β): the speeds of B and C along the coupler are one.
        let expected = c * (rocker[i] - coupler[i]).sin() / (a * (phi[i] - coupler[i]).sin());
        // Towards a toggle the difference of two angles has lost as many digits as it is small.
        let tolerance = 1e-14 * (1.0 + expected.abs()) * expected.abs();
        assert!((found[i] - expected).abs() < tolerance, "{i}: {found:?}");
        assert!((point[i] - (expected / c).abs()).abs() < tolerance / c);
        assert!((crank[i] - 1.0).abs() < 1e-15);
        largest = largest.max(expected.abs());
    }
    assert!(largest > 50.0);
}

/// Without inertia, a couple of 1 N m on the rocker and the action of the actuator are in balance.
#[test]
fn advantage_is_resistance_over_effort() {
    let load = r#"resist = { torque = ["ground", "rocker"], magnitude = -1.0 }"#;
    let text = WEIGHTS
        .replace("weight = { gravity = [0, -9.81] }", load)
        .replace("[0.0, 6.283185307179586]", "[0.05, 6.25]");
    let names = r#""phi.actuator_force", "rocker.mechanical_advantage""#;
    let table = table(&requesting(&text, names), Analysis::Statics, 100);
    let [action, advantage] = columns(
        &table,
        ["phi.actuator_force", "rocker.mechanical_advantage"],
    );
    for (action, advantage) in action.iter().zip(&advantage) {
        // Positions lose digits towards the toggles, alike in both.
        assert!(
            (action * advantage - 1.0).abs() < 1e-12,
            "{action} {advantage}"
        );
    }
}

/// Where crank and coupler are in line the rocker stands still: its advantage is no number, and the
/// cells are empty in the table and no extreme in the peaks.
#[test]
fn a_toggle_has_no_advantage() {
    let [a, b, c, d] = BARS;
    let toggle = (((a + b) * (a + b) + d * d - c * c) / (2.0 * (a + b) * d)).acos();
    let text = WEIGHTS.replace("[0.0, 6.283185307179586]", &format!("[{toggle:?}, 2.0]"));
    let names = r#""rocker.mechanical_advantage", "rocker.C.mechanical_advantage", "rocker.velocity_pole", "coupler.velocity_pole""#;
    let scene = requesting(&text, names);
    let result = crate::table::analyse(&scene, Analysis::Kinematics, 3);
    for end in ["-kinematics.csv", "-extrema.csv", "-kinematics.md"] {
        let text = crate::table::file(&result, end);
        assert!(!text.contains("NaN") && !text.contains("inf"), "{text}");
    }
    let table = Table::parse(&crate::table::file(&result, "-kinematics.csv"));
    for name in [
        "rocker.mechanical_advantage",
        "rocker.C.mechanical_advantage",
        "rocker.velocity_pole.x",
    ] {
        let values = table.column(name);
        assert!(values[0].is_nan(), "{name}: {values:?}");
        assert!(values[1..].iter().all(|v| v.is_finite()), "{name}");
    }
    // The coupler rotates about C there.
    assert!(table.column("coupler.velocity_pole.x")[0].is_finite());
}

/// A sliding body has no pole, and its mechanical advantage follows from virtual work.
#[test]
fn a_piston_has_no_pole_but_an_advantage() {
    let mut scene = case("slider-crank");
    let names = [
        "piston",
        "piston.velocity_pole",
        "piston.mechanical_advantage",
        "piston.C.mechanical_advantage",
        "phi.velocity",
    ]
    .map(str::to_owned);
    scene.requests.variables = Some(names.to_vec());
    let table = table(&scene, Analysis::Kinematics, 37);
    let [pole, turning, speed, phi, force] = columns(
        &table,
        [
            "piston.velocity_pole.x",
            "piston.mechanical_advantage",
            "piston.C.vx",
            "phi.velocity",
            "piston.C.mechanical_advantage",
        ],
    );
    assert!(pole.iter().chain(&turning).all(|v| v.is_nan()));
    for i in 0..phi.len() {
        let expected = (phi[i] / speed[i]).abs();
        // At a dead centre the speed is rounding, and the cell empty.
        let tolerance = 1e-13 * expected;
        assert!(force[i].is_nan() && expected > 1e8 || (force[i] - expected).abs() < tolerance);
    }
}

#[test]
fn the_poles_of_a_four_bar_are_where_its_bars_meet() {
    let names =
        r#""crank.velocity_pole", "coupler", "coupler.velocity_pole", "rocker.velocity_pole""#;
    let text = WEIGHTS.replace("[0.0, 6.283185307179586]", "[0.05, 6.25]");
    let table = table(&requesting(&text, names), Analysis::Kinematics, 200);
    let pair = |name: &str| {
        let both = ["x", "y"].map(|axis| table.column(&format!("{name}.{axis}")));
        let [x, y] = both;
        x.into_iter().zip(y).collect::<Vec<_>>()
    };
    let [crank, coupler, rocker] = [
        "crank.velocity_pole",
        "coupler.velocity_pole",
        "rocker.velocity_pole",
    ]
    .map(pair);
    let [b, c] = ["coupler.B", "coupler.C"].map(pair);
    let mut near_count = 0;
    for i in 0..b.len() {
        let gap = |p: (f64, f64), at: (f64, f64)| (p.0 - at.0).hypot(p.1 - at.1);
        // Positions of half a metre, to rounding; the rocker's over a speed down to a thousandth.
        assert!(gap(crank[i], (0.1, -0.2)) < 1e-15, "{:?}", crank[i]);
        assert!(gap(rocker[i], (0.5, -0.2)) < 1e-12, "{:?}", rocker[i]);
        let p = coupler[i];
        let line_distance = |from: (f64, f64), to: (f64, f64)| {
            let (along, away) = ((to.0 - from.0, to.1 - from.1), (p.0 - from.0, p.1 - from.1));
            (along.0 * away.1 - along.1 * away.0).abs() / along.0.hypot(along.1)
        };
        // On both lines, to rounding of the distance; far away the speeds' digits count.
        let distance = 1.0 + gap(p, b[i]);
        if distance < 20.0 {
            near_count += 1;
            assert!(
                line_distance((0.1, -0.2), b[i]) < 1e-13 * distance * distance,
                "{i}"
            );
            assert!(
                line_distance((0.5, -0.2), c[i]) < 1e-13 * distance * distance,
                "{i}"
            );
        }
    }
    assert!(near_count > 150);
}

/// At the acceleration pole, reckoned from another point of the body, there is no acceleration; a
/// crank at constant speed has it at its pivot.
#[test]
fn the_acceleration_pole_has_no_acceleration() {
    let names = r#""crank", "coupler", "rocker", "crank.acceleration_pole", "coupler.acceleration_pole", "rocker.acceleration_pole""#;
    let table = table(&requesting(WEIGHTS, names), Analysis::Kinematics, 100);
    for (body, point) in [("crank", "B"), ("coupler", "C"), ("rocker", "C")] {
        let of = |name: &str| table.column(&format!("{body}.{name}"));
        let at = |part: &str| of(&format!("{point}.{part}"));
        let (w, alpha) = (of("angular_velocity"), of("angular_acceleration"));
        let [x, y, ax, ay] = ["x", "y", "ax", "ay"].map(at);
        let [px, py] = ["x", "y"].map(|axis| of(&format!("acceleration_pole.{axis}")));
        for i in 0..w.len() {
            let (rx, ry) = (px[i] - x[i], py[i] - y[i]);
            let residual = [
                ax[i] - alpha[i] * ry - w[i] * w[i] * rx,
                ay[i] + alpha[i] * rx - w[i] * w[i] * ry,
            ];
            // Rounding of some tens of m/s².
            assert!(
                residual.iter().all(|a| a.abs() < 1e-12),
                "{body}: {residual:?}"
            );
            if body == "crank" {
                assert!((px[i] - 0.1).hypot(py[i] + 0.2) < 1e-15);
            }
        }
    }
}

#[test]
fn neither_is_told_unasked() {
    for scene in [
        scene(WEIGHTS),
        requesting(WEIGHTS, r#""coupler", "rocker.C""#),
    ] {
        let table = table(&scene, Analysis::Kinematics, 3);
        let is_optional = |n: &String| n.contains("advantage") || n.contains("pole");
        assert!(!table.names.iter().any(is_optional), "{:?}", table.names);
    }
}
