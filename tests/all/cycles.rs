//! Steady cycles against closed forms and long simulations.

use crate::machine::{final_state, machine, parse};
use dwell_dynamics::{
    DynamicsError, Machine, Method, Options, initial_transient, size_flywheel, steady_cycle,
};
use dwell_kinetostatics::{Drive, DriveKind, Magnitude, Motor, SpeedController};
use dwell_scene::PlaneScene;
use dwell_tests::fixtures::scene;
use std::f64::consts::TAU;

/// A wheel of 0.02 kg m² with a load on it.
fn wheel_scene(load: &str) -> PlaneScene {
    parse(&format!(
        r#"
[bodies.ground]
points = {{ A = [0, 0] }}
[bodies.wheel]
points = {{ A = [0, 0] }}
inertia = 0.02
center = "A"
mass = 1.0
[joints]
A = {{ revolute = ["ground.A", "wheel.A"] }}
[actuators.phi]
angle = ["ground", "wheel"]
[loads]
{load}
"#
    ))
}

fn drive(scene: &PlaneScene, kind: DriveKind) -> Drive {
    Drive {
        name: "drive".into(),
        coordinate: scene.mechanism.actuators[0].coordinate(),
        kind,
    }
}

fn motor(inductance: f64) -> DriveKind {
    DriveKind::Motor(Motor {
        voltage: Magnitude::Constant(24.0),
        torque_constant: 0.05,
        resistance: 0.8,
        inductance,
        gear_ratio: 5.0,
        rotor_inertia: 1e-4,
        is_torque_speed_line: false,
    })
}

const FINE: Options = Options {
    method: Method::Tsit45,
    rtol: 1e-12,
    atol: 1e-12,
    max_steps: 100_000,
    max_step: None,
    sample_interval: None,
};

/// A constant torque against a viscous damper: ω = M/c, and a disturbance shrinks by exp(−c T/J).
#[test]
fn a_damped_flywheel() {
    let scene =
        wheel_scene("drag = { rotational-damper = [\"ground\", \"wheel\"], damping = 0.003 }");
    let push = drive(&scene, DriveKind::AppliedForce(Magnitude::Constant(-0.06)));
    let machine = machine(&scene, &[], &[push]);
    for method in [Method::Tsit45, Method::Bdf] {
        let options = Options { method, ..FINE };
        let cycle =
            steady_cycle(&machine, &machine.initial_state(&[0.3], &[-9.0]), &options).expect("one");
        assert!(
            (cycle.mean_speed / -20.0 - 1.0).abs() < 1e-11,
            "{}",
            cycle.mean_speed
        );
        assert!((cycle.period * 20.0 / TAU - 1.0).abs() < 1e-11);
        assert!(cycle.fluctuation.abs() < 1e-10, "{:e}", cycle.fluctuation);
        let expected = (-0.003 * TAU / 20.0 / 0.02_f64).exp();
        let [[multiplier, im]] = cycle.floquet_multipliers[..] else {
            panic!("{:?}", cycle.floquet_multipliers)
        };
        // BDF errs by hundreds of its tolerance.
        assert!(
            (multiplier / expected - 1.0).abs() < 1e-9 && im == 0.0,
            "{multiplier}"
        );
        assert!(cycle.is_stable());
        // What the drive gives the damper takes: 0.06 N·m over a turn.
        assert!(
            (cycle.works[1] - 0.06 * TAU).abs() < 1e-11,
            "{:?}",
            cycle.works
        );
        assert!(cycle.works.iter().sum::<f64>().abs() < 1e-10);
    }
}

/// A motor against a constant torque: its line of torque over speed; with inductance, both multipliers
/// are those of the linear equations, exp(λT), here of a swinging pair; a regulator holds its speed.
#[test]
// Long: one derivation by hand.
fn motors_against_a_constant_torque() {
    let scene = wheel_scene("load = { torque = \"wheel\", magnitude = -1.5 }");
    let (u, kn, r, j) = (24.0, 0.25, 0.8, 0.02 + 25.0 * 1e-4);
    let speed = (u - r * 1.5 / kn) / kn;
    let pair = |solution: f64, determinant: f64, period: f64| {
        let inside = 0.25 * solution * solution - determinant;
        assert!(inside < 0.0);
        let size = (0.5 * solution * period).exp();
        let (sin, cos) = ((-inside).sqrt() * period).sin_cos();
        [size * cos, size * sin.abs()]
    };
    let plain = machine(&scene, &[], &[drive(&scene, motor(0.0))]);
    let cycle =
        steady_cycle(&plain, &plain.initial_state(&[0.0], &[40.0]), &FINE).expect("a cycle");
    assert!(
        (cycle.mean_speed / speed - 1.0).abs() < 1e-11,
        "{}",
        cycle.mean_speed
    );
    let expected = (-kn * kn / (r * j) * TAU / speed).exp();
    assert!((cycle.floquet_multipliers[0][0] / expected - 1.0).abs() < 1e-9);

    let l = 0.3;
    let coil = machine(&scene, &[], &[drive(&scene, motor(l))]);
    let guess = initial_transient(&coil, &coil.initial_state(&[0.0], &[0.0]), 2, &FINE)
        .expect("a start from rest");
    assert!(
        (guess[0] - 2.0 * TAU).abs() < 1e-12 && guess[1] > 0.0,
        "{guess:?}"
    );
    let cycle = steady_cycle(&coil, &guess, &FINE).expect("a cycle");
    assert!(
        (cycle.mean_speed / speed - 1.0).abs() < 1e-10,
        "{}",
        cycle.mean_speed
    );
    assert!(
        (cycle.initial_state[2] / (1.5 / kn) - 1.0).abs() < 1e-10,
        "{:?}",
        cycle.initial_state
    );
    let [re, im] = pair(-r / l, kn * kn / (j * l), TAU / speed);
    let found = cycle.floquet_multipliers[0];
    assert!(
        (found[0] - re).abs() < 1e-9 && (found[1].abs() - im).abs() < 1e-9,
        "{found:?} {re} {im}"
    );

    let (p, i, w) = (0.05, 0.4, 30.0);
    let held = machine(
        &scene,
        &[],
        &[drive(
            &scene,
            DriveKind::SpeedController(SpeedController {
                reference_speed: Magnitude::Constant(w),
                proportional_gain: p,
                integral_gain: i,
                limit: 1e3,
            }),
        )],
    );
    let cycle = steady_cycle(&held, &held.initial_state(&[0.0], &[20.0]), &FINE).expect("a cycle");
    assert!(
        (cycle.mean_speed / w - 1.0).abs() < 1e-11,
        "{}",
        cycle.mean_speed
    );
    assert!(
        (cycle.initial_state[2] - 1.5 / i).abs() < 1e-10,
        "{:?}",
        cycle.initial_state
    );
    let [re, im] = pair(-p / 0.02, i / 0.02, TAU / w);
    let found = cycle.floquet_multipliers[0];
    assert!(
        (found[0] - re).abs() < 1e-9 && (found[1].abs() - im).abs() < 1e-9,
        "{found:?} {re} {im}"
    );
}

/// A wheel under M + A sin φ − c ω²: E = ½Jω² follows a linear equation over φ,
/// E = JM/2c + A (β sin φ − cos φ)/(1 + β²), β = 2c/J; a disturbance of E shrinks by exp(−2πβ).
struct Windmill {
    inertia: f64,
}

const PUSH: f64 = 1.5;
const SWAY: f64 = 0.9;
const DRAG: f64 = 0.002;

impl Windmill {
    fn energy(&self, phi: f64) -> f64 {
        let beta = 2.0 * DRAG / self.inertia;
        let swing = SWAY * (beta * phi.sin() - phi.cos()) / (1.0 + beta * beta);
        self.inertia * PUSH / (2.0 * DRAG) + swing
    }

    fn speed(&self, phi: f64) -> f64 {
        (2.0 * self.energy(phi) / self.inertia).sqrt()
    }

    fn period(&self) -> f64 {
        let points = 4096;
        let slow = |k: i32| 1.0 / self.speed(TAU * f64::from(k) / f64::from(points));
        (0..points).map(slow).sum::<f64>() * TAU / f64::from(points)
    }

    fn fluctuation(&self) -> f64 {
        let beta = 2.0 * DRAG / self.inertia;
        let max_speed = std::f64::consts::PI - beta.atan();
        let [max, min] = [max_speed, max_speed + 0.5 * TAU].map(|phi| self.speed(phi));
        (max - min) * self.period() / TAU
    }

    fn machine() -> Machine {
        let law = format!("{PUSH} + {SWAY}*sin(phi) - {DRAG}*phi.velocity^2");
        let scene = wheel_scene(&format!(
            "wind = {{ torque = \"wheel\", magnitude = \"{law}\" }}"
        ));
        machine(&scene, &[], &[])
    }
}

#[test]
fn a_fluctuating_wheel() {
    let machine = Windmill::machine();
    let exact = Windmill { inertia: 0.02 };
    let phi = 1.1;
    let cycle =
        steady_cycle(&machine, &machine.initial_state(&[phi], &[40.0]), &FINE).expect("a cycle");
    println!("{:?} {:e}", cycle.newton_steps, cycle.fluctuation);
    assert!((cycle.initial_state[1] / exact.speed(phi) - 1.0).abs() < 1e-11);
    assert!((cycle.period / exact.period() - 1.0).abs() < 1e-11);
    // The speeds at the extremes are read off the dense output, of order 4.
    assert!((cycle.fluctuation / exact.fluctuation() - 1.0).abs() < 1e-9);
    let multiplier = (-TAU * 2.0 * DRAG / 0.02_f64).exp();
    assert!((cycle.floquet_multipliers[0][0] / multiplier - 1.0).abs() < 1e-10);
    // Newton's method doubles the digits: its error is half the square of the last, over the speed.
    for pair in cycle.newton_steps.windows(2).filter(|pair| pair[1] > 1e-9) {
        assert!(
            pair[1] < 2.0 * pair[0] * pair[0],
            "{:?}",
            cycle.newton_steps
        );
    }
    assert!(cycle.newton_steps.len() < 8);
    for point in &cycle.samples {
        assert!((point.y[1] / exact.speed(point.y[0]) - 1.0).abs() < 1e-9);
    }
    assert_eq!(cycle.samples.len(), 361);
}

/// The flywheel for a wanted fluctuation: the closed form with its inertia has that fluctuation, and for
/// a small one it is the classical ΔE/(δ ω²).
#[test]
fn flywheels() {
    let machine = Windmill::machine();
    let guess = machine.initial_state(&[0.0], &[27.0]);
    for target in [0.1, 0.02, 0.002] {
        let found = size_flywheel(&machine, &guess, target, &FINE).expect("a flywheel");
        let whole = Windmill {
            inertia: 0.02 + found.inertia,
        };
        // The trials end at 1e-9 of the fluctuation.
        assert!(
            (whole.fluctuation() / target - 1.0).abs() < 3e-9,
            "{target}"
        );
        assert!((found.cycle.fluctuation / target - 1.0).abs() < 1e-9);
        if target == 0.002 {
            let classical = 2.0 * SWAY / (target * found.cycle.mean_speed.powi(2));
            // Its error is of the order of (c/J)² and δ².
            assert!((whole.inertia / classical - 1.0).abs() < 1e-5);
        }
    }
    let none = size_flywheel(&machine, &guess, 10.0, &FINE).expect("no flywheel");
    assert_eq!(none.inertia, 0.0);
}

/// A press of slider and crank with a motor (and its coil) against the end of a long simulation.
#[test]
fn a_press_against_a_long_simulation() {
    let scene = scene("slider-crank");
    for inductance in [0.0, 0.02] {
        let machine = machine(&scene, &[], &[drive(&scene, motor(inductance))]);
        let mut guess = machine.initial_state(&[0.5], &[60.0]);
        if inductance > 0.0 {
            guess[2] = 5.0;
        }
        let cycle = steady_cycle(&machine, &guess, &FINE).expect("a cycle");
        println!(
            "{:?} {:?} {}",
            cycle.floquet_multipliers, cycle.newton_steps, cycle.fluctuation
        );
        assert!(cycle.is_stable());
        // After so many periods nothing is left of the guess.
        let size = cycle
            .floquet_multipliers
            .iter()
            .map(|[re, im]| re.hypot(*im))
            .fold(0.0, f64::max);
        let periods = (1e-14_f64.ln() / size.ln()).ceil();
        let mut start = guess.clone();
        start[1] *= 1.02;
        // A cycle later, the same state comes back.
        let there = final_state(
            &machine,
            &start,
            periods * cycle.period,
            Method::Tsit45,
            1e-12,
        );
        let one_period_later = final_state(&machine, &there, cycle.period, Method::Tsit45, 1e-12);
        assert!(
            (one_period_later[0] - there[0] - TAU).abs() < 1e-9,
            "{}",
            one_period_later[0] - there[0]
        );
        // At the position where that simulation ended, the cycle has its speed and current.
        let mut from = guess.clone();
        (from[0], from[1]) = (there[0], 1.1 * there[1]);
        let cycle = steady_cycle(&machine, &from, &FINE).expect("a cycle");
        let same = cycle
            .initial_state
            .iter()
            .zip(&there)
            .take(machine.work_offset());
        for (found, simulated) in same.skip(1) {
            let error = found / simulated - 1.0;
            assert!(error.abs() < 1e-9, "{found}: {error:e}");
        }
        assert!(cycle.works.iter().sum::<f64>().abs() < 1e-8);
    }
}

/// What a turn makes of a disturbance, by differences of turns simulated over time.
#[test]
fn multipliers_agree_with_differences() {
    let scene = scene("slider-crank");
    let machine = machine(&scene, &[], &[drive(&scene, motor(0.02))]);
    let near = initial_transient(&machine, &machine.initial_state(&[0.5], &[150.0]), 2, &FINE)
        .expect("a start");
    assert!((near[0] - 0.5 - 2.0 * TAU).abs() < 1e-12, "{}", near[0]);
    let cycle = steady_cycle(&machine, &near, &FINE).expect("a cycle");
    let h = 1e-3;
    let mut columns = [[0.0; 2]; 2];
    for (j, column) in columns.iter_mut().enumerate() {
        let after = |times: f64| {
            let mut start = cycle.initial_state.clone();
            start[j + 1] += times * h;
            initial_transient(&machine, &start, 1, &FINE).expect("a turn")
        };
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(after);
        for (i, slope) in column.iter_mut().enumerate() {
            let i = i + 1;
            *slope = (8.0 * (c[i] - b[i]) - (d[i] - a[i])) / (12.0 * h);
        }
    }
    let [[a, c], [b, d]] = columns;
    let [[one, _], [two, _]] = cycle.floquet_multipliers[..] else {
        panic!("{:?}", cycle.floquet_multipliers)
    };
    println!("{columns:?} {:?}", cycle.floquet_multipliers);
    // The integration's error of 1e-10 rad/s over h.
    assert!((a + d - one - two).abs() < 1e-6, "{columns:?}");
    assert!((a * d - b * c - one * two).abs() < 1e-6, "{columns:?}");
    // Both are real here, and what disturbs the current disturbs the speed.
    assert!(b.abs() > 0.01 && cycle.floquet_multipliers[0][1] == 0.0);
}

#[test]
fn cycles_that_there_are_not() {
    let reason = |scene: &PlaneScene, drives: &[Drive], q_dot: f64| {
        let machine = machine(scene, &[], drives);
        steady_cycle(&machine, &machine.initial_state(&[0.0], &[q_dot]), &FINE)
            .expect_err("no cycle")
    };
    // Nothing brakes it; time drives it; a spring winds up; too slow to get over the top.
    let free = reason(&wheel_scene(""), &[], 3.0);
    assert!(matches!(free, DynamicsError::NoCycle { .. }), "{free}");
    let time_dependent = reason(
        &wheel_scene("m = { torque = \"wheel\", magnitude = \"sin(t)\" }"),
        &[],
        3.0,
    );
    assert!(
        matches!(time_dependent, DynamicsError::NoCycle { .. }),
        "{time_dependent}"
    );
    let wound =
        "s = { torsion-spring = [\"ground\", \"wheel\"], stiffness = 1.0, free-angle = 0.0 }";
    let wound = reason(&wheel_scene(wound), &[], 3.0);
    assert!(matches!(wound, DynamicsError::NoCycle { .. }), "{wound}");
    let hill = "m = { torque = \"wheel\", magnitude = \"-2*sin(phi) - 0.1*phi.velocity\" }";
    let hill = reason(&wheel_scene(hill), &[], 3.0);
    assert!(matches!(hill, DynamicsError::ComesToRest { .. }), "{hill}");
}
