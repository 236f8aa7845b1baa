//! Loads that begin long after the start, switch or are steep, on a mechanism that rests until then: as users met them.

use crate::table::{Table, file, scene};
use dwell_dynamics::Method;
use dwell_study::{SolverSettings, simulate};

const METHODS: [Method; 5] = [
    Method::Bdf,
    Method::Esdirk34,
    Method::TrBdf2,
    Method::Tsit45,
    Method::Dop853,
];

/// The last values of some columns of a slider of 2 kg under a force (N) over a time (s).
fn slider<const N: usize>(force: &str, end: f64, method: Method, columns: [&str; N]) -> [f64; N] {
    let text = format!(
        "[bodies.ground]\npoints = {{ O = [0, 0] }}\n[bodies.block]\npoints = {{ O = [0, 0] }}\nmass = 2\ncenter = [0, 0]\n\
         inertia = 1\n[joints]\nslide = {{ prismatic = [\"ground.O\", \"block.O\"], axis = [1, 0] }}\n[actuators]\n\
         s = {{ length = \"slide\" }}\n[drives]\npush = {{ applied-force = \"s\", magnitude = {force} }}\n[motion]\n\
         duration = {end}\n"
    );
    let settings = SolverSettings {
        method,
        rtol: 1e-9,
        atol: 1e-9,
        ..SolverSettings::default()
    };
    let found = simulate(&scene(&text), &settings, &|_| {}).unwrap();
    assert!(found.early_stop.is_none(), "{force} by {method:?}");
    let table = Table::parse(&file(&found, "-motion.csv"));
    columns.map(|column| table.column(column).last().copied().unwrap())
}

/// Impulse over mass: a bell of 0.1 s at 200 of 300 s; no method passes over it.
#[test]
fn a_slider_that_is_pushed_at_200_s_moves() {
    let speed = 4.0 * 0.1 * std::f64::consts::PI.sqrt() / 2.0;
    for method in METHODS {
        let force = "\"4*exp(-((t - 200)/0.1)^2)\"";
        let [reached] = slider(force, 300.0, method, ["s.velocity"]);
        assert!(
            (reached - speed).abs() < 1e-6,
            "{method:?}: {reached}, {speed}"
        );
    }
}

/// A rectangle of 10 ms, and one of 1 s, in 300 s.
#[test]
fn short_pulses_in_a_long_rest_are_met() {
    for (width, method) in [0.01, 1.0]
        .into_iter()
        .flat_map(|w| METHODS.map(|m| (w, m)))
    {
        let force = format!("\"if(abs(t - 123.4) < {width}/2, 6, 0)\"");
        let [reached] = slider(&force, 300.0, method, ["s.velocity"]);
        assert!(
            (reached - 3.0 * width).abs() < 1e-8,
            "{method:?}, {width} s: {reached}"
        );
    }
}

/// A force that rises from 0 to 4 N within some tenths of a millisecond; and at once.
#[test]
fn a_step_of_force_moves_what_was_in_equilibrium() {
    let end = 2.0;
    // ∫ 4/(1 + exp(−(t − 0.7)/r)) dt = 4 r ln(1 + exp((t − 0.7)/r)): 4 (t − 0.7) but for exp(−13 000).
    let after = end - 0.7;
    for method in METHODS {
        let [smooth] = slider("\"4/(1+exp(-(t-0.7)/1e-4))\"", end, method, ["s.velocity"]);
        assert!((smooth - 2.0 * after).abs() < 1e-6, "{method:?}: {smooth}");
        let [at, speed] = slider("\"if(t > 0.7, 4, 0)\"", end, method, ["s", "s.velocity"]);
        assert!((speed - 2.0 * after).abs() < 1e-8, "{method:?}: {speed}");
        assert!((at - after * after).abs() < 1e-8, "{method:?}: {at}");
    }
}

/// A blow of 2 ms among points that are far apart: a load is not made of what lies between its points.
#[test]
fn a_table_of_a_load_stays_between_its_points() {
    let force = "{ of = \"t\", table = [[0, 0], [0.5, 0], [0.501, 10], [0.502, 0], [1, 0]] }";
    for method in [Method::Bdf, Method::Dop853] {
        let [speed] = slider(force, 1.0, method, ["s.velocity"]);
        // The monotone curve rises and falls symmetrically: half of the highest, over 2 ms.
        assert!((speed - 0.005).abs() < 1e-9, "{method:?}: {speed}");
    }
}

/// Current (A) and speed of a motor on a slider a time after a voltage, L di/dt = u − R i − k v, m dv/dt = k i, in closed form.
fn motor_and_slider(u: f64, [i, v]: [f64; 2], t: f64) -> [f64; 2] {
    let [resistance, inductance, k, m] = [1.5, 0.01, 0.8, 2.0];
    let half_trace: f64 = -0.5 * resistance / inductance;
    let root = (half_trace * half_trace - k * k / (inductance * m)).sqrt();
    let [fast, slow] = [half_trace - root, half_trace + root];
    let (last, acceleration) = (u / k, k * i / m);
    let first = (acceleration - slow * (v - last)) / (fast - slow);
    let second = v - last - first;
    let [e, f] = [first * (fast * t).exp(), second * (slow * t).exp()];
    [m * (fast * e + slow * f) / k, last + e + f]
}

/// Steps of some hundredths of a second are limited by stability: L/R is 7 ms. The current decays within them.
#[test]
fn rows_within_long_steps_are_as_good_as_their_ends() {
    let text = "[bodies.ground]\npoints = { O = [0, 0] }\n[bodies.block]\npoints = { O = [0, 0] }\nmass = 2\ncenter = [0, 0]\n\
        inertia = 1\n[joints]\nslide = { prismatic = [\"ground.O\", \"block.O\"], axis = [1, 0] }\n[actuators]\n\
        s = { length = \"slide\" }\n[drives]\npush = { motor = \"s\", voltage = \"if(t < 0.5, 6, -4)\", torque-constant = 0.8, \
        resistance = 1.5, inductance = 0.01 }\n[motion]\nduration = 1\n";
    let half = motor_and_slider(6.0, [0.0; 2], 0.5);
    let exact = |t: f64| {
        if t <= 0.5 {
            motor_and_slider(6.0, [0.0; 2], t)
        } else {
            motor_and_slider(-4.0, half, t - 0.5)
        }
    };
    for tolerance in [1e-5, 1e-7, 1e-10] {
        let settings = SolverSettings {
            method: Method::Dop853,
            rtol: tolerance,
            atol: tolerance,
            sample_interval: Some(1e-3),
            ..SolverSettings::default()
        };
        let found = simulate(&scene(text), &settings, &|_| {}).unwrap();
        let table = Table::parse(&file(&found, "-motion.csv"));
        let currents = table.column("push.current");
        let largest = currents.iter().fold(0.0_f64, |all, i| all.max(i.abs()));
        let times = table.column("t");
        let errors = times.iter().zip(&currents);
        let errors = errors.map(|(&t, i)| (i - exact(t)[0]).abs());
        let error = errors.fold(0.0, f64::max) / largest;
        // With one polynomial a step it was 350 and 160 tolerances at 1e-5 and 1e-10.
        assert!(error < 50.0 * tolerance, "{tolerance:e}: {error:e}");
    }
}

/// What switches too often for a motion is named, not the weight beside it.
#[test]
fn the_load_that_switches_too_often_is_named() {
    let loads = "weight = { gravity = [0, -9.81] }\nsquare = { torque = \"shaft\", magnitude = \"if(sin(314*t) > 0.9, 1, 0)\" }\n";
    let text = format!(
        "[bodies.ground]\npoints = {{ A = [0, 0] }}\n[bodies.shaft]\npoints = {{ A = [0, 0] }}\nmass = 2\ncenter = [0.1, 0]\n\
         inertia = 1\n[joints]\nA = {{ revolute = [\"ground.A\", \"shaft.A\"] }}\n[actuators]\n\
         phi = {{ angle = [\"ground\", \"shaft\"] }}\n[loads]\n{loads}[motion]\nduration = 86400\n"
    );
    let refused = simulate(&scene(&text), &SolverSettings::default(), &|_| {});
    let refused = refused.err().unwrap().to_string();
    assert!(refused.contains("load `square` varies within"), "{refused}");
}
