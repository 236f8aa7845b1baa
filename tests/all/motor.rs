//! A motor with a flywheel against closed forms.

use crate::machine::{final_state, machine, parse};
use dwell_dynamics::Method;
use dwell_kinetostatics::{Drive, DriveKind, Magnitude, Motor};

const WHEEL: &str = r#"
[bodies.ground]
points = { A = [0, 0] }
[bodies.wheel]
points = { A = [0, 0] }
inertia = 0.02
center = "A"
mass = 1.0
[joints]
A = { revolute = ["ground.A", "wheel.A"] }
[actuators.phi]
angle = ["ground", "wheel"]
"#;
const VOLTAGE: f64 = 24.0;
const RESISTANCE: f64 = 0.8;
/// Torque constant times gear ratio, and the inertia of wheel and rotor.
const KN: f64 = 0.05 * 5.0;
const INERTIA: f64 = 0.02 + 5.0 * 5.0 * 1e-4;
const END: f64 = 0.4;

/// The velocity of the wheel at the end, from rest.
fn final_velocity(inductance: f64, method: Method, tolerance: f64) -> f64 {
    let scene = parse(WHEEL);
    let motor = Drive {
        name: "motor".into(),
        coordinate: scene.mechanism.actuators[0].coordinate(),
        kind: DriveKind::Motor(Motor {
            voltage: Magnitude::Constant(VOLTAGE),
            torque_constant: 0.05,
            resistance: RESISTANCE,
            inductance,
            gear_ratio: 5.0,
            rotor_inertia: 1e-4,
            is_torque_speed_line: false,
        }),
    };
    let machine = machine(&scene, &[], &[motor]);
    let start = machine.initial_state(&[0.0], &[0.0]);
    final_state(&machine, &start, END, method, tolerance)[1]
}

/// Without inductance the velocity tends exponentially to the no-load speed.
#[test]
fn a_motor_accelerates_a_flywheel() {
    let velocity = final_velocity(0.0, Method::Bdf, 1e-12);
    let expected = VOLTAGE / KN * (1.0 - (-KN * KN / (RESISTANCE * INERTIA) * END).exp());
    // It has nearly reached its speed, and errs by less than its tolerance: 6e-13.
    assert!((velocity / expected - 1.0).abs() < 3e-11, "{velocity}");
}

/// With inductance: ω̈ + R/L ω̇ + (kN)²/(JL) ω = u kN/(JL), here with two real roots.
#[test]
fn the_inductance_of_a_motor_delays_its_flywheel() {
    let l = 0.01;
    let velocity = final_velocity(l, Method::Tsit45, 1e-12);
    // From rest the current rises within microseconds: the first step must become as short.
    let by_bdf = final_velocity(l, Method::Bdf, 1e-10);
    assert!((by_bdf / velocity - 1.0).abs() < 1e-9, "{by_bdf}");
    let (b, c) = (RESISTANCE / l, KN * KN / (INERTIA * l));
    let root = (b * b / 4.0 - c).sqrt();
    let [s1, s2] = [-b / 2.0 + root, -b / 2.0 - root];
    let shape = (s2 * (s1 * END).exp() - s1 * (s2 * END).exp()) / (s2 - s1);
    let expected = VOLTAGE / KN * (1.0 - shape);
    assert!((velocity / expected - 1.0).abs() < 5e-13, "{velocity}");
}
