//! A machine drawn at random, as a scene.

use crate::draws::Draws;
use std::f64::consts::{PI, TAU};

/// A scene with the times at which its loads switch.
pub(super) struct RandomMachine {
    /// What it is, in a few words.
    pub(super) kind: &'static str,
    pub(super) text: String,
    /// The duration of its motion, s.
    pub(super) span: f64,
    /// Where its loads switch in time, s, in ascending order.
    pub(super) switches: Vec<f64>,
}

/// A mechanism: its name, its bodies, joints, actuators and assembly, and the names of its free coordinates.
type Mechanism = (&'static str, &'static str, &'static [&'static str]);

const ALL: [Mechanism; 6] = [
    (
        "cart",
        r#"[bodies.ground]
points = { O = [0, 0] }
[bodies.cart]
points = { O = [0, 0] }
mass = 1.5
center = [0, 0]
inertia = 0.1
[joints]
guide = { prismatic = ["ground.O", "cart.O"], axis = [1, 0.2] }
[actuators]
q = { length = "guide" }
"#,
        &["q"],
    ),
    (
        "pendulum",
        r#"[bodies.ground]
points = { O = [0, 0] }
[bodies.bob]
points = { O = [0, 0] }
mass = 1.2
center = [0.1, -0.9]
inertia = 0.05
[joints]
O = { revolute = ["ground.O", "bob.O"] }
[actuators]
q = { angle = ["ground", "bob"] }
"#,
        &["q"],
    ),
    (
        "four-bar",
        r#"[bodies.ground]
points = { A = [0, 0], D = [2, 0] }
[bodies.crank]
points = { A = [0, 0], B = [0.5, 0] }
mass = 1.0
center = [0.2, 0.01]
inertia = 0.3
[bodies.coupler]
points = { B = [0, 0], C = [1.75, 0] }
mass = 0.8
center = [0.8, 0.1]
inertia = 0.2
[bodies.rocker]
points = { C = [1.5, 0], D = [0, 0] }
mass = 0.7
center = [0.7, 0]
inertia = 0.15
[joints]
A = { revolute = ["ground.A", "crank.A"] }
B = { revolute = ["crank.B", "coupler.B"] }
C = { revolute = ["coupler.C", "rocker.C"] }
D = { revolute = ["ground.D", "rocker.D"] }
[actuators]
q = { angle = ["ground", "crank"] }
[assembly]
q = 0.8
coupler = 0.6
rocker = 1.9
"#,
        &["q"],
    ),
    (
        "slider-crank",
        r#"[bodies.ground]
points = { A = [0, 0], G = [0, 0.1] }
[bodies.crank]
points = { A = [0, 0], B = [0.4, 0] }
mass = 1.0
center = [0.1, 0.02]
inertia = 0.4
[bodies.rod]
points = { B = [0, 0], C = [1.3, 0] }
mass = 0.6
center = [0.5, 0]
inertia = 0.08
[bodies.piston]
points = { C = [0, 0] }
mass = 0.9
center = [0.02, 0]
inertia = 0.01
[joints]
A = { revolute = ["ground.A", "crank.A"] }
B = { revolute = ["crank.B", "rod.B"] }
C = { revolute = ["rod.C", "piston.C"] }
guide = { prismatic = ["ground.G", "piston.C"], axis = [1, 0] }
[actuators]
q = { angle = ["ground", "crank"] }
[assembly]
q = 0.5
rod = 0.0
piston = 0.0
"#,
        &["q"],
    ),
    (
        "double pendulum",
        r#"[bodies.ground]
points = { O = [0, 0] }
[bodies.one]
points = { O = [0, 0], P = [0, -0.8] }
mass = 1.0
center = [0, -0.4]
inertia = 0.06
[bodies.two]
points = { P = [0, 0] }
mass = 0.6
center = [0.02, -0.5]
inertia = 0.04
[joints]
O = { revolute = ["ground.O", "one.O"] }
P = { revolute = ["one.P", "two.P"] }
[actuators]
q = { angle = ["ground", "one"] }
r = { angle = ["ground", "two"] }
"#,
        &["q", "r"],
    ),
    (
        "crane",
        r#"[bodies.ground]
points = { O = [0, 0] }
[bodies.cart]
points = { O = [0, 0] }
mass = 2.0
center = [0, 0]
inertia = 0.1
[bodies.load]
points = { O = [0, 0] }
mass = 0.8
center = [0, -0.7]
inertia = 0.02
[joints]
guide = { prismatic = ["ground.O", "cart.O"], axis = [1, 0] }
O = { revolute = ["cart.O", "load.O"] }
[actuators]
q = { length = "guide" }
r = { angle = ["ground", "load"] }
"#,
        &["q", "r"],
    ),
];

impl RandomMachine {
    /// The machine of some draws.
    pub(super) fn draw(draws: &mut Draws) -> Self {
        let (kind, mechanism, free) = draws.choose(&ALL);
        let span = (100.0 * draws.between(0.6, 2.5)).round() / 100.0;
        let mut switches = Vec::new();
        let mut drives = String::new();
        for k in 0..1 + draws.below(3) {
            let name = ["one", "two", "three"][k];
            drives += &drive(draws, name, free, span, &mut switches);
        }
        let weight = match draws.happens(0.6) {
            true => "weight = { gravity = [0, -9.81] }\n",
            false => "",
        };
        let velocities = free.iter().map(|name| {
            // At rest, or not.
            let velocity = match draws.happens(0.4) {
                true => 0.0,
                false => draws.between(-2.0, 2.0),
            };
            format!("{name} = {velocity:.3}")
        });
        let velocities: Vec<String> = velocities.collect();
        let text = format!(
            "{mechanism}[loads]\n{weight}[drives]\n{drives}[motion]\n\
             initial-velocity = {{ {} }}\nduration = {span}\n",
            velocities.join(", ")
        );
        switches.retain(|&t| t > 0.0 && t < span);
        switches.sort_by(f64::total_cmp);
        Self {
            kind,
            text,
            span,
            switches,
        }
    }
}

/// A drive along one of the free coordinates; its switches in time are added to the others.
fn drive(
    draws: &mut Draws,
    name: &str,
    free: &[&str],
    span: f64,
    switches: &mut Vec<f64>,
) -> String {
    let q = draws.choose(free);
    match draws.below(5) {
        0 => {
            let (voltage, inductance) = (
                switched(draws, 12.0, span, switches),
                draws.choose(&[0.0, 0.01]),
            );
            format!(
                "{name} = {{ motor = \"{q}\", voltage = \"{voltage}\", torque-constant = 0.2, resistance = 1.5, inductance = \
                 {inductance}, gear-ratio = 4, inertia = 0.01 }}\n"
            )
        }
        1 => {
            let speed = switched(draws, 2.0, span, switches);
            let (proportional, limit) = (draws.between(1.0, 10.0), draws.between(0.5, 5.0));
            let integral = draws.choose(&[0.0, 4.0]);
            format!(
                "{name} = {{ speed-controller = \"{q}\", speed = \"{speed}\", proportional = {proportional:.3}, integral = \
                 {integral}, limit = {limit:.3} }}\n"
            )
        }
        kind => {
            let force = match kind {
                2 => switched(draws, 4.0, span, switches),
                _ => of_the_state(draws, q),
            };
            format!("{name} = {{ applied-force = \"{q}\", magnitude = \"{force}\" }}\n")
        }
    }
}

/// A function of time of about a size that switches.
fn switched(draws: &mut Draws, size: f64, span: f64, switches: &mut Vec<f64>) -> String {
    let at = (1000.0 * draws.between(0.1, 0.9) * span).round() / 1000.0;
    let [a, b] = [0; 2].map(|_| (100.0 * draws.between(-size, size)).round() / 100.0);
    match draws.below(4) {
        0 => {
            switches.push(at);
            format!("if(t > {at}, {a}, {b})")
        }
        1 => {
            let half = (1e6 * span * draws.power_of_ten(-4.0, -1.0)).round() / 1e6 + 1e-5;
            switches.extend([at - half, at + half]);
            format!("if(abs(t - {at}) < {half}, {a}, {b})")
        }
        2 => {
            let omega = (10.0 * draws.between(3.0, 30.0)).round() / 10.0;
            let [on, off] = [0.3_f64.asin(), PI - 0.3_f64.asin()];
            let periods = 0..(omega * span / TAU).ceil() as usize;
            switches.extend(periods.flat_map(|k| [on, off].map(|x| (x + TAU * k as f64) / omega)));
            format!("if(sin({omega}*t) > 0.3, {a}, {b})")
        }
        _ => {
            switches.push(at);
            format!("{a}*sin(3*t) + {b}*max(0, t - {at})")
        }
    }
}

/// A force that switches, or has a kink, with the coordinate or its speed.
fn of_the_state(draws: &mut Draws, q: &str) -> String {
    let at = (100.0 * draws.between(-0.5, 1.2)).round() / 100.0;
    let [a, b] = [0; 2].map(|_| (100.0 * draws.between(0.2, 4.0)).round() / 100.0);
    match draws.below(6) {
        0 => format!("if({q} > {at}, {a}, {b})"),
        1 => format!("-{}*max(0, {q} - {at})", 100.0 * a),
        // On both sides in the same direction.
        2 => format!("{a} - {}*sign({q} - {at})", 0.2 * b.min(a)),
        // Away from the switch on both sides: it is passed, never held.
        3 => format!("if({q}.velocity > {at}, {}, {a})", a + b),
        4 => format!("-{a}*{q}.velocity*abs({q}.velocity) - {b}*{q}"),
        _ => format!("if({q} > {at}, -{a}*{q}.velocity, {b}*cos(2*t))"),
    }
}
