//! Drag −c |v| v of a point and −c |ω| ω of a fan, in the plane and in space, against closed forms.
#![allow(clippy::unwrap_used, reason = "a test")]

use dwell::{Error, Scene, Solver};

const G: f64 = 9.81;
const MASS: f64 = 2.0;
const INERTIA: f64 = 0.03;
/// Of the falling body and of the fan.
const COEFFICIENTS: [f64; 2] = [0.5, 0.004];
const START: f64 = 40.0;

/// A body that falls along a guide, and a rotor with a fan.
fn falling_body_and_fan(is_plane: bool) -> String {
    let [origin, point, down, inertia, axis, fan] = match is_plane {
        true => [
            "[0, 0]",
            "[0.3, 0.1]",
            "[0, -1]",
            "0.03",
            "",
            r#"["ground", "rotor"]"#,
        ],
        false => [
            "[0, 0, 0]",
            "[0.3, 0.1, 0]",
            "[0, -1, 0]",
            "[0.03, 0.03, 0.03]",
            ", axis = [0, 0, 1]",
            r#""turn""#,
        ],
    };
    let travel = if is_plane { "length" } else { "travel" };
    let [drag, fan_drag] = COEFFICIENTS;
    let gravity = down.replace("-1", "-9.81");
    format!(
        "
[bodies]
ground = {{ points = {{ O = {origin} }} }}
body = {{ points = {{ O = {origin}, P = {point} }}, mass = {MASS}, center = {origin}, inertia = {inertia} }}
rotor = {{ points = {{ O = {origin} }}, mass = 1.0, center = {origin}, inertia = {inertia} }}
[joints]
slide = {{ prismatic = [\"ground.O\", \"body.O\"], axis = {down} }}
turn = {{ revolute = [\"ground.O\", \"rotor.O\"]{axis} }}
[actuators]
s = {{ {travel} = \"slide\" }}
q = {{ angle = {fan} }}
[assembly]
s = 0.0
q = 0.0
[loads]
weight = {{ gravity = {gravity} }}
wind = {{ drag = \"body.P\", coefficient = {drag} }}
fan = {{ rotational-drag = {fan}, coefficient = {fan_drag} }}
[motion]
duration = 1.5
initial-velocity = {{ s = 0.0, q = {START} }}
"
    )
}

/// v = v∞ tanh(g t/v∞) with v∞² = m g/c; ω = ω₀/(1 + c ω₀ t/J).
#[test]
fn falling_bodies_reach_their_speed_and_fans_slow_down() -> Result<(), Error> {
    let [drag, fan] = COEFFICIENTS;
    let final_speed = (MASS * G / drag).sqrt();
    let rate = fan * START / INERTIA;
    for is_plane in [true, false] {
        let scene = Scene::parse(&falling_body_and_fan(is_plane))?;
        let motion = scene.assemble()?.simulate(&Solver::accuracy(1e-11))?;
        let column = |name: &str| motion.column(name);
        let (time, balance) = (column("t")?, column("energy.balance_error")?);
        let [s, v] = [column("s")?, column("s.velocity")?];
        let [q, omega] = [column("q")?, column("q.velocity")?];
        for (k, &t) in time.iter().enumerate() {
            let x = G * t / final_speed;
            let slowed = 1.0 + rate * t;
            let expected = [
                (v[k], final_speed * x.tanh(), final_speed),
                (s[k], final_speed * final_speed / G * x.cosh().ln(), 1.0),
                (omega[k], START / slowed, START),
                (q[k], INERTIA / fan * slowed.ln(), 1.0),
                (balance[k], 0.0, INERTIA * START * START),
            ];
            for (value, wanted, scale) in expected {
                // Seen: 2.5e-13.
                assert!(
                    (value - wanted).abs() < 2e-11 * scale,
                    "{t}: {value} {wanted}"
                );
            }
        }
    }
    Ok(())
}

/// A slider-crank with drag of its piston, of a point of its rod and of its crank.
const SLIDER_CRANK: &str = r#"
[bodies]
ground = { points = { A = [0, 0], G = [0, 0.02] } }
crank = { points = { A = [0, 0], B = [0.1, 0] }, mass = 0.7, center = [0.04, 0.01], inertia = 0.002 }
rod = { points = { B = [0, 0], C = [0.3, 0], P = [0.2, 0.05] }, mass = 0.5, center = [0.14, 0.01], inertia = 0.004 }
piston = { points = { C = [0, 0] }, mass = 0.4, center = [0, 0], inertia = 0.001 }
[joints]
A = { revolute = ["ground.A", "crank.A"] }
B = { revolute = ["crank.B", "rod.B"] }
C = { revolute = ["rod.C", "piston.C"] }
guide = { prismatic = ["ground.G", "piston.C"], axis = [1, 0] }
[actuators]
q = { angle = ["ground", "crank"] }
[assembly]
q = 0.3
rod = -0.1
[loads]
piston = { drag = "piston.C", coefficient = 3.0 }
rod = { drag = "rod.P", coefficient = 7.0 }
fan = { rotational-drag = ["crank", "rod"], coefficient = 0.2 }
[motion]
duration = 0.5
initial-velocity = 20
"#;

/// R = a q̈ + b q̇² + Σ c F and τ = m q̈ + ½m′ q̇² − Σ w F with F = c |q̇| q̇, as well by the table; forwards and backwards.
#[test]
fn reduced_models_and_tables_have_drag() -> Result<(), Error> {
    let machine = Scene::parse(SLIDER_CRANK)?.assemble()?;
    let reduced = machine.reduced(["A"])?;
    let table = reduced.table(1e-8)?;
    for (k, speed) in [3.0, -4.0, 2.5, -6.0, 1.0, 7.0].into_iter().enumerate() {
        let (q, acceleration) = (0.9 * k as f64, 2.0);
        let exact = machine.inverse_dynamics(0.0, &[q], &[speed], &[acceleration])?;
        // Seen: 2.1e-16 and 3.5e-11.
        for (at, tolerance) in [(reduced.at(q)?, 1e-14), (table.at(q)?, 2e-9)] {
            let forces = [3.0, 7.0, 0.2].map(|c| c * f64::abs(speed) * speed);
            let sum = |of: &dyn Fn(usize) -> f64| (0..3).map(|l| of(l) * forces[l]).sum::<f64>();
            let torque = at.m * acceleration + at.half_dm * speed * speed - sum(&|l| at.w[l]);
            let wanted = exact.actuator_force("q")?;
            assert!((torque - wanted).abs() < tolerance * wanted.abs().max(1.0));
            for (r, name) in ["A.x", "A.y"].into_iter().enumerate() {
                let loads = sum(&|l| at.c[l][r]);
                let reaction = at.a[r] * acceleration + at.b[r] * speed * speed + loads;
                let wanted = exact.reaction(name)?;
                assert!((reaction - wanted).abs() < tolerance * wanted.abs().max(10.0));
            }
        }
    }
    Ok(())
}
