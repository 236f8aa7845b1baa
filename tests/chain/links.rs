//! The chain as its definition has it, and its statics by hand.

use dwell_geometry::{Actuator, AssemblyConfiguration, Body, Joint, Mechanism, Vec2, vec2};
use dwell_kinetostatics::{Load, LoadKind, Magnitude, Mass, Model};
use std::f64::consts::FRAC_PI_2;

/// Acceleration of gravity in the definition, m/s².
pub const GRAVITY: f64 = 9.81;

/// N four-bars: links 1 m and 1 kg, ground pivots 1 m apart, and θ of the first link is q. The
/// pins in the order of [`by_hand`]: A₀, then B, C and A of every four-bar.
fn chain(n: usize) -> Mechanism {
    let tip = vec2(1.0, 0.0);
    let mut chain = Mechanism {
        bodies: ["ground", "link0"].map(Body::named).into(),
        joints: vec![Joint::revolute("A0", [0, 1], [Vec2::ZERO; 2])],
        actuators: vec![Actuator::angle("theta", [0, 1])],
        ..Mechanism::default()
    };
    for i in 1..=n {
        let [before, coupler, link] = [2 * i - 1, 2 * i, 2 * i + 1];
        let pivot = vec2(i as f64, 0.0);
        let bodies = [format!("coupler{i}"), format!("link{i}")];
        chain.bodies.extend(bodies.map(Body::named));
        chain.joints.extend([
            Joint::revolute(format!("B{i}"), [before, coupler], [tip, Vec2::ZERO]),
            Joint::revolute(format!("C{i}"), [coupler, link], [tip, tip]),
            Joint::revolute(format!("A{i}"), [0, link], [pivot, Vec2::ZERO]),
        ]);
    }
    chain
}

/// Its model with every reaction, under gravity.
pub fn model(n: usize) -> Model {
    let chain = chain(n);
    let bar = Mass::uniform_bar(1.0, 1.0);
    let mut masses = vec![bar; chain.bodies.len()];
    masses[0] = Mass::default();
    let upright = |b: usize| Some(if b % 2 == 1 { FRAC_PI_2 } else { 0.0 });
    let start = AssemblyConfiguration {
        q: vec![FRAC_PI_2],
        initial_guess: (0..chain.bodies.len()).map(upright).collect(),
        ..AssemblyConfiguration::default()
    };
    let gravity = Load {
        name: "gravity".into(),
        kind: LoadKind::Gravity {
            direction: vec2(0.0, -1.0),
        },
        magnitude: Magnitude::Constant(GRAVITY),
    };
    let model = Model::new(&chain, &masses, &start, &chain.reactions()).expect("a chain");
    model.with_loads(vec![gravity]).expect("gravity")
}

/// The torque and the forces of all pins, A₀ and then B, C, A of every four-bar, by statics from the free end.
///
/// With e along the links, every tip accelerates with p̈ = α e⊥ − ω² e, every coupler too, and the
/// links' centres with p̈/2. All masses are 1 kg, and I_A = 1/3. Of a coupler between B (of the
/// link before it on it) and C (of it on the link after it), with its weight g:
///
/// ```text
/// C_y = (g_y − p̈_y)/2,  B = C + p̈ − g             moments about B, forces             (1)
/// e × (C − B′) + e × g/2 = α/3,  B′ of the next    moments of a link about A: C_x     (2)
/// A + C − B′ + g = p̈/2                             forces on a link                    (3)
/// ```
///
/// (2) is divided by sin θ: flat, the chain is singular.
pub fn closed_form(n: usize, [theta, omega, alpha]: [f64; 3]) -> (f64, Vec<Vec2>) {
    let e = Vec2::from_angle(theta);
    let g = vec2(0.0, -GRAVITY);
    let tip = e.perp() * alpha - e * (omega * omega);
    let pull = 0.5 * (g.y - tip.y);
    let (mut next, mut forces) = (Vec2::ZERO, Vec::new());
    for _ in 0..n {
        let turning = e.x * (pull - next.y) + 0.5 * e.cross(g) - alpha / 3.0;
        let c = vec2(next.x + turning / e.y, pull);
        let b = c + tip - g;
        // Backwards.
        forces.extend([tip * 0.5 - g - c + next, c, b]);
        next = b;
    }
    forces.push(tip * 0.5 - g + next);
    forces.reverse();
    let torque = alpha / 3.0 + e.cross(next) - 0.5 * e.cross(g);
    (torque, forces)
}

/// The errors of the torque and of the worst force, relative to the largest force by hand.
pub fn errors(model: &Model, n: usize, state: [f64; 3]) -> [f64; 2] {
    let mut workspace = model.workspace::<f64>();
    let mut result = model.result_buffer();
    let [q, q_dot, q_ddot] = state.map(|v| [v]);
    model
        .kinetostatics(0.0, &q, &q_dot, &q_ddot, &mut workspace, &mut result)
        .expect("a pose");
    let (torque, forces) = closed_form(n, state);
    let scale = forces.iter().fold(0.0_f64, |s, f| s.max(f.norm()));
    let gaps = forces.iter().zip(result.reactions.chunks_exact(2));
    let worst = gaps.fold(0.0_f64, |worst, (f, got)| {
        worst.max((*f - vec2(got[0], got[1])).norm())
    });
    [(torque - result.tau[0]).abs() / scale, worst / scale]
}
