//! Equilibria, linearised motions and jamming against closed forms.

use crate::machine::{DOUBLE, everything, machine, parse};
use dwell_dynamics::{DynamicsError, Machine, Stability, equilibria, equilibrium_near, linearise};
use dwell_geometry::JointId;
use dwell_kinetostatics::{
    Drive, DriveKind, Friction, FrictionContact, Guide, KinetostaticsError, Load, LoadKind,
    Magnitude, Motor, SpeedController,
};
use dwell_tests::fixtures::scene;
use std::f64::consts::{FRAC_PI_2, PI};

const G: f64 = 9.81;

fn torque(value: f64) -> Load {
    let scene = scene("pendulum-a01");
    Load {
        name: "push".into(),
        kind: LoadKind::couple(scene.mechanism.joints[0].bodies),
        magnitude: Magnitude::Constant(value),
    }
}

fn pendulum(push: f64) -> Machine {
    machine(&scene("pendulum-a01"), &[torque(push)], &[])
}

/// A pendulum under a constant torque M: cos φ = M/mgl, ω² = (g/l) sin; none beyond, one just there.
#[test]
fn equilibria_of_a_pushed_pendulum() {
    for part in [0.0_f64, 0.4, -0.9, 1.0 - 1e-9] {
        let found = equilibria(&pendulum(part * G), [-PI, PI]).expect("equilibria");
        assert_eq!(found.len(), 2, "{part}");
        let angle = part.acos();
        let stiff = G * (1.0 - part * part).sqrt();
        for (one, q) in found.iter().zip([-angle, angle]) {
            // The force is rounded at g l; its slope there is what the angle is worth.
            let tolerance = 4e-15 * G / stiff + 4e-16;
            assert!((one.y[0] - q).abs() < tolerance, "{part}: {} {q}", one.y[0]);
            let size = one.eigenvalues[0][0].hypot(one.eigenvalues[0][1]);
            assert!(
                (size * size / stiff - 1.0).abs() < 1e-14 * (G / stiff).powi(2),
                "{part}"
            );
        }
        assert_eq!(found[0].stability, Stability::Centre);
        assert_eq!(found[1].stability, Stability::Unstable);
        assert_eq!(found[0].modes().len(), 1);
        assert_eq!(found[0].modes()[0].damping_ratio.abs(), 0.0);
    }
    // Both meet at φ = 0, to the square root of a rounding.
    let one = equilibria(&pendulum(G), [-3.0, 3.1]).expect("equilibria");
    assert!(
        !one.is_empty() && one.iter().all(|e| e.y[0].abs() < 1e-7),
        "{one:?}"
    );
    assert!(
        equilibria(&pendulum(1.000_001 * G), [-PI, PI])
            .expect("none")
            .is_empty()
    );
}

/// The period of a small swing by quadrature is 2π over the natural frequency.
#[test]
fn natural_frequencies_agree_with_small_swings() {
    let machine = machine(&scene("pendulum-a01"), &[], &[]);
    let found = equilibria(&machine, [0.0, 6.0]).expect("equilibria");
    let hanging = found
        .iter()
        .find(|e| e.stability == Stability::Centre)
        .expect("one");
    let small = 1e-3;
    let start = dwell_dynamics::ReducedState {
        t: 0.0,
        q: hanging.y[0] + small,
        q_dot: 0.0,
    };
    let orbit = dwell_dynamics::Orbit::loaded(&machine, start).expect("an orbit");
    let swung = orbit.period * hanging.modes()[0].angular_frequency / (2.0 * PI);
    // The next term, 11 θ⁴/3072, is 4e-15; rounding over the amplitude 1e-12.
    assert!(
        (swung - 1.0 - small * small / 16.0).abs() < 2e-12,
        "{swung}"
    );
}

/// A double pendulum hangs down; its frequencies are roots of det(K − ω²M) written by hand.
#[test]
fn a_double_pendulum_hangs() {
    let machine = machine(&parse(DOUBLE), &[], &[]);
    let found = equilibrium_near(&machine, &machine.initial_state(&[-1.2, -2.0], &[0.5, 0.1]))
        .expect("one");
    for q in &found.y[..2] {
        assert!((q + FRAC_PI_2).abs() < 1e-14, "{q}");
    }
    assert_eq!(found.stability, Stability::Centre);
    let (m1, c1, i1, l, m2, c2, i2) = (1.3, 0.35, 0.05, 0.6, 0.8, 0.25, 0.02);
    let (a, b, c) = (
        i1 + m1 * c1 * c1 + m2 * l * l,
        m2 * l * c2,
        i2 + m2 * c2 * c2,
    );
    let (k1, k2) = (G * (m1 * c1 + m2 * l), G * m2 * c2);
    let (det, mixed) = (a * c - b * b, a * k2 + c * k1);
    let root = (mixed * mixed - 4.0 * det * k1 * k2).sqrt();
    let modes = found.modes();
    for (mode, square) in modes.iter().zip([mixed - root, mixed + root]) {
        let expected = (square / (2.0 * det)).sqrt();
        assert!(
            (mode.angular_frequency / expected - 1.0).abs() < 1e-13,
            "{mode:?} {expected}"
        );
        assert!(mode.damping_ratio.abs() < 1e-13);
    }
    assert_eq!(modes.len(), 2);
}

fn motor(inductance: f64) -> Motor {
    Motor {
        voltage: Magnitude::Constant(6.0),
        torque_constant: 0.1,
        resistance: 2.0,
        inductance,
        gear_ratio: 20.0,
        rotor_inertia: 1e-4,
        is_torque_speed_line: false,
    }
}

/// A motor holds a pendulum up: the stall torque balances the weight, and the linearised motion is that
/// written by hand, inputs and outputs too.
#[test]
fn a_motor_holds_a_pendulum() {
    let scene = scene("pendulum-a01");
    let drive = Drive {
        name: "motor".into(),
        coordinate: scene.mechanism.actuators[0].coordinate(),
        kind: DriveKind::Motor(motor(0.05)),
    };
    let machine = machine(&scene, &[], &[drive]);
    let (kn, r, l, j) = (2.0, 2.0, 0.05, 1.0 + 400.0 * 1e-4);
    let found = equilibria(&machine, [-PI, PI]).expect("equilibria");
    let angle = (kn * 6.0 / r / G).acos();
    assert_eq!(found.len(), 2);
    for (one, q) in found.iter().zip([-angle, angle]) {
        assert!(
            (one.y[0] - q).abs() < 1e-14 && (one.y[2] - 3.0).abs() < 1e-14,
            "{:?}",
            one.y
        );
        let k = -G * q.sin() / j;
        let expected = [
            vec![0.0, 1.0, 0.0],
            vec![-k, 0.0, kn / j],
            vec![0.0, -kn / l, -r / l],
        ];
        for (row, expected) in one.state_space.a.iter().zip(&expected) {
            for (a, e) in row.iter().zip(expected) {
                assert!(
                    (a - e).abs() < 1e-13 * (1.0 + e.abs()),
                    "{:?}",
                    one.state_space.a
                );
            }
        }
        assert_eq!(one.state_space.b, [[0.0], [0.0], [1.0 / l]]);
        // Coordinate, speed, the motor's torque.
        assert_eq!(
            one.state_space.c,
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, kn]]
        );
        assert_eq!(one.state_space.d, [[0.0]; 3]);
        assert!(
            one.state_space
                .state_derivative
                .iter()
                .all(|rate| rate.abs() < 1e-12)
        );
    }
    assert_eq!(found[0].stability, Stability::Asymptotic);
    assert_eq!(found[1].stability, Stability::Unstable);
    // Newton's method finds the current with the angle.
    let near = equilibrium_near(&machine, &machine.initial_state(&[-0.8], &[1.0])).expect("one");
    assert!((near.y[0] + angle).abs() < 1e-14 && (near.y[2] - 3.0).abs() < 1e-14);
}

/// A drive that integrates towards a speed never settles at rest.
#[test]
fn a_regulator_of_speed_has_no_equilibrium() {
    let scene = scene("pendulum-a01");
    let drive = Drive {
        name: "regulator".into(),
        coordinate: scene.mechanism.actuators[0].coordinate(),
        kind: DriveKind::SpeedController(SpeedController {
            reference_speed: Magnitude::Constant(1.0),
            proportional_gain: 1.0,
            integral_gain: 1.0,
            limit: 5.0,
        }),
    };
    let machine = machine(&scene, &[], &[drive]);
    let none = equilibria(&machine, [-PI, PI]);
    assert!(
        matches!(none, Err(DynamicsError::NoEquilibrium { .. })),
        "{none:?}"
    );
}

/// B, C and D of a machine with every kind of load and drive against differences.
#[test]
// Long: one comparison, matrix by matrix.
fn linearised_inputs_and_outputs_agree_with_differences() {
    let (machine, y) = everything();
    let linear = linearise(&machine, 0.0, &y).expect("a linearisation");
    let states = machine.work_offset();
    let mut workspace = machine.workspace();
    let h = 1e-4;
    let mut at = |column: usize, times: f64| {
        let mut perturbed = y.clone();
        workspace.input_offsets.fill(0.0);
        if column < states {
            perturbed[column] += times * h;
        } else {
            workspace.input_offsets[column - states] = times * h;
        }
        let mut rates = vec![0.0; machine.state_count()];
        let state = machine
            .evaluate(0.0, &perturbed, &mut workspace)
            .expect("rates");
        state.derivative(&mut rates);
        rates.truncate(states);
        let outputs = [
            state.q(),
            state.q_dot(),
            &state.inverse_dynamics().reactions,
            state.drive_forces(),
        ];
        rates.extend(outputs.into_iter().flatten());
        rates
    };
    let rows = linear
        .a
        .iter()
        .zip(&linear.b)
        .chain(linear.c.iter().zip(&linear.d));
    let rows: Vec<Vec<f64>> = rows.map(|(x, u)| [x.as_slice(), u].concat()).collect();
    let scale = rows
        .iter()
        .flatten()
        .fold(0.0_f64, |most, e| most.max(e.abs()));
    let exact = at(0, 0.0);
    let values: Vec<f64> = linear
        .state_derivative
        .iter()
        .chain(&linear.outputs)
        .copied()
        .collect();
    assert_eq!(values.len(), rows.len());
    assert_eq!(values, exact);
    assert!(linear.c.len() == 4 + 4 + 2 && linear.d[0].len() == 2);
    // The voltage over the inductance; the regulator's share at once.
    assert_eq!(linear.b[4..], [[20.0, 0.0], [0.0, 1.0]]);
    assert_eq!(linear.d[8..], [[0.0, 0.0], [0.0, 0.4]]);
    for j in 0..states + 2 {
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|times| at(j, times));
        for (i, row) in rows.iter().enumerate() {
            let slope = (8.0 * (c[i] - b[i]) - (d[i] - a[i])) / (12.0 * h);
            // Rounding over h, and h⁴ times a fifth derivative of order 10⁴.
            assert!(
                (slope - row[j]).abs() < 1e-10 * scale,
                "∂{i}/∂{j}: {slope} {}",
                row[j]
            );
        }
    }
}

const TRAMMEL: &str = r#"
[bodies.ground]
points = { O = [0, 0] }
[bodies.along]
points = { P = [0, 0] }
mass = 0.3
center = "P"
inertia = 0.001
[bodies.across]
points = { Q = [0, 0] }
mass = 2.0
center = "Q"
inertia = 0.001
[bodies.bar]
points = { P = [0, 0], Q = [1, 0] }
[joints]
x-guide = { prismatic = ["ground.O", "along.P"], axis = [1, 0] }
y-guide = { prismatic = ["ground.O", "across.Q"], axes = [[0, 1], [0, 1]] }
P = { revolute = ["along.P", "bar.P"] }
Q = { revolute = ["across.Q", "bar.Q"] }
[actuators]
s = { length = "x-guide" }
[assembly]
s = 0.6
along = 0.0
across = 0.0
bar = 2.2
[loads]
press = { force = "across.Q", direction = [0, -1], magnitude = 40.0 }
"#;

/// A bar presses a block against its guide and along it. With k = x/y, P the press less what centrifugal
/// forces take, m₁ the block's mass and m₂ the other's, where the block moves as it is pressed:
///
/// ```text
/// (m₁ + m₂k² − µ m₂k) ẍ = (k − µ) P,    µ_crit = k + m₁/(m₂k)
/// ```
///
/// Just below µ_crit it moves so (and is slowed down at once); above, its effective inertia is negative and
/// it jams. Moving the other way it never does.
#[test]
fn a_pressed_block_jams() {
    let scene = parse(TRAMMEL);
    let guide = &scene.mechanism.joints[0];
    let with = |coefficient: f64| {
        let friction = Load {
            name: "rub".into(),
            kind: LoadKind::slide_force(Guide {
                bodies: guide.bodies,
                points: guide.points,
                axis: dwell_geometry::vec2(1.0, 0.0),
            }),
            magnitude: Magnitude::Friction(Friction {
                joint: JointId(0),
                coefficient,
                static_coefficient: coefficient,
                contact: FrictionContact::Guide { length: 0.0 },
                regularization_speed: Some(1e-4),
            }),
        };
        machine(&scene, &[friction], &[])
    };
    let (x, y, m1, m2) = (0.6_f64, 0.8_f64, 0.3, 2.0);
    let k = x / y;
    let critical = k + m1 / (m2 * k);
    let acceleration = |coefficient: f64, speed: f64| {
        let machine = with(coefficient);
        let state = machine.initial_state(&[x], &[speed]);
        let mut workspace = machine.workspace();
        machine
            .evaluate(0.0, &state, &mut workspace)
            .map(|state| state.q_ddot()[0])
    };
    for part in [0.0, 0.5, 0.9, 0.999] {
        for speed in [-0.2, 0.2] {
            let mu = part * critical * f64::signum(speed);
            // ÿ = −k ẍ + y″ ẋ², y″ = −1/y³.
            let press = 40.0 - m2 * speed * speed / y.powi(3);
            let inertia = m1 + m2 * k * k - mu * m2 * k;
            let expected = (k - mu) * press / inertia;
            let found = acceleration(part * critical, speed)
                .unwrap_or_else(|e| panic!("{part} {speed}: {e}"));
            // Rounding over what is left of the inertia.
            let tolerance = 1e-14 * m2 / inertia;
            assert!(
                (found / expected - 1.0).abs() < tolerance,
                "{part} {speed}: {found} {expected}"
            );
        }
    }
    for beyond in [1.000_001, 1.2, 5.0] {
        let jams = acceleration(beyond * critical, 0.2);
        let expected = DynamicsError::Load(KinetostaticsError::SelfLocking { load: 1 });
        assert_eq!(jams, Err(expected), "{beyond}");
        assert!(acceleration(beyond * critical, -0.2).is_ok());
    }
}
