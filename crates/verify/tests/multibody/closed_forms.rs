//! Motions whose solutions are known without any multibody program.
//!
//! Tolerances: a step is wrong by 1e-13 of the scale at most, a run of tens of steps by some of that.

use crate::plant::{DOWN, GROUND, Plant, close};
use dwell_geometry::{ActuatorId, ActuatorKind, JointKind, vec2};
use dwell_kinetostatics::{
    DriveKind, Friction, FrictionContact, Guide, LoadKind, Magnitude, Motor, SpeedController,
};
use std::f64::consts::{FRAC_PI_2, PI};

const G: f64 = 9.81;

/// The complete elliptic integral of the first kind, by the arithmetic and the geometric mean.
fn complete_elliptic(k: f64) -> f64 {
    let (mut a, mut b) = (1.0, (1.0 - k * k).sqrt());
    for _ in 0..8 {
        (a, b) = (0.5 * (a + b), (a * b).sqrt());
    }
    FRAC_PI_2 / a
}

/// A pendulum let go at θ₀ from below: a quarter of its period 4 K(sin ½θ₀)/ω₀ later it hangs down,
/// with the speed 2 ω₀ sin ½θ₀, and its pin bears m g + m l θ̇².
#[test]
fn val_pendulum_by_elliptic_integral() {
    let (mass, arm, inertia, swing) = (1.3, 0.4, 0.05, 2.5_f64);
    let mut plant = Plant::new();
    // Its frame stands off the pin, the centre off the frame.
    let bob = plant.body("bob", mass, [0.1 + arm, 0.2], inertia, None);
    plant.pin("O", (GROUND, [0.5, 0.7]), (bob, [0.1, 0.2]));
    plant.constant("weight", DOWN, G);
    plant.free([GROUND, bob], ActuatorKind::Angle, [0.0, 0.0]);
    let about = inertia + mass * arm * arm;
    let omega = (mass * G * arm / about).sqrt();
    let quarter = complete_elliptic((0.5 * swing).sin()) / omega;
    let angle = swing - FRAC_PI_2;
    let origin = vec2(0.5, 0.7) - vec2(0.1, 0.2).rotate(dwell_geometry::Vec2::from_angle(angle));
    let start = vec![[0.0; 3], [origin.x, origin.y, angle]];
    let times = [quarter, 2.0 * quarter, 4.0 * quarter, 5.0 * quarter];
    let samples = plant.integrate(start, vec![[0.0; 3]; 2], &times);
    let speed = 2.0 * omega * (0.5 * swing).sin();
    let wanted = [
        (swing, 0.0),
        (0.0, -speed),
        (-swing, 0.0),
        (swing, 0.0),
        (0.0, -speed),
    ];
    for (sample, (theta, rate)) in samples.iter().zip(wanted) {
        close(sample.poses[1][2] + FRAC_PI_2, theta, 1.0, 1e-11);
        close(sample.velocities[1][2], rate, speed, 1e-11);
        // Along the rod and across it.
        let along = mass * arm * rate * rate + mass * G * theta.cos();
        let across = mass * G * theta.sin() * (1.0 - mass * arm * arm / about);
        let [x, y] = [-theta.sin() * along, theta.cos() * along];
        let [x, y] = [x + theta.cos() * across, y + theta.sin() * across];
        let largest = mass * (G + arm * speed * speed);
        close(sample.reactions[0], x, largest, 1e-11);
        close(sample.reactions[1], y, largest, 1e-11);
        close(
            sample.kinetic + sample.potential,
            samples[0].kinetic + samples[0].potential,
            mass * G * arm,
            1e-12,
        );
    }
}

/// θ̈ of two rods of length l and mass m (angles from below; the classical equations with
/// 2·(4/3), 1·(1/3) and ½ cos(θ₁ − θ₂) of m l²).
fn double_rods([one, two, w, u]: [f64; 4], length: f64) -> [f64; 4] {
    let (c, s) = ((one - two).cos(), (one - two).sin());
    let (a, b, d) = (4.0 / 3.0, 0.5 * c, 1.0 / 3.0);
    let f = -0.5 * s * u * u - 1.5 * G / length * one.sin();
    let h = 0.5 * s * w * w - 0.5 * G / length * two.sin();
    let det = a * d - b * b;
    [w, u, (d * f - b * h) / det, (a * h - b * f) / det]
}

/// By hand-written equations and the classical Runge–Kutta rule in 20 000 parts: its error is far
/// below 1e-12 there.
#[test]
fn val_double_pendulum_by_hand() {
    let (length, mass) = (0.6, 0.8);
    let mut plant = Plant::new();
    let upper = plant.bar("upper", mass, length, None);
    let lower = plant.bar("lower", mass, length, None);
    plant.pin("O", (GROUND, [0.0, 0.0]), (upper, [0.0, 0.0]));
    plant.pin("P", (upper, [length, 0.0]), (lower, [0.0, 0.0]));
    plant.constant("weight", DOWN, G);
    plant.free([GROUND, upper], ActuatorKind::Angle, [0.0, 0.0]);
    plant.free([upper, lower], ActuatorKind::Angle, [0.0, 0.0]);
    let mut y = [1.2, -0.4, 0.5, 2.0];
    let from = [y[0] - FRAC_PI_2, y[1] - FRAC_PI_2];
    let end = [length * from[0].cos(), length * from[0].sin()];
    let speed = [-end[1] * y[2], end[0] * y[2]];
    let samples = plant.integrate(
        vec![[0.0; 3], [0.0, 0.0, from[0]], [end[0], end[1], from[1]]],
        vec![[0.0; 3], [0.0, 0.0, y[2]], [speed[0], speed[1], y[3]]],
        &[1.0],
    );
    let h = 1.0 / 20_000.0;
    for _ in 0..20_000 {
        let along = |by: f64, k: [f64; 4]| [0, 1, 2, 3].map(|i| y[i] + by * k[i]);
        let k1 = double_rods(y, length);
        let k2 = double_rods(along(0.5 * h, k1), length);
        let k3 = double_rods(along(0.5 * h, k2), length);
        let k4 = double_rods(along(h, k3), length);
        y = [0, 1, 2, 3].map(|i| y[i] + h / 6.0 * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]));
    }
    let last = &samples[1];
    for (b, i) in [(1, 0), (2, 1)] {
        close(last.poses[b][2] + FRAC_PI_2, y[i], 1.0, 1e-10);
        close(last.velocities[b][2], y[i + 2], 10.0, 1e-10);
    }
    // What the upper pin bears, by the accelerations of both centres.
    let [_, _, alpha, beta] = double_rods(y, length);
    let second_derivative = |angle: f64, w: f64, a: f64| {
        [
            a * angle.cos() - w * w * angle.sin(),
            a * angle.sin() + w * w * angle.cos(),
        ]
    };
    let (first, second) = (
        second_derivative(y[0], y[2], alpha),
        second_derivative(y[1], y[3], beta),
    );
    let force = |i: usize| mass * length * (1.5 * first[i] + 0.5 * second[i]);
    close(last.reactions[0], force(0), 2.0 * mass * G, 1e-9);
    close(
        last.reactions[1],
        force(1) + 2.0 * mass * G,
        2.0 * mass * G,
        1e-9,
    );
}

/// v̇ = a − b tanh(v/w) with a = g sin α and b = µ g cos α, so that
/// (a² − b²) t = a v + b w ln(cosh(v/w) − (b/a) sinh(v/w)). The centre is above the guide: its couple
/// moves the pressure to one end, but as long as both ends press, their sum is the weight's part.
#[test]
fn val_slider_with_friction_on_an_incline() {
    let (slope, mu, regularization_speed, mass, height) = (0.5_f64, 0.3, 0.2, 2.0, 0.1);
    let mut plant = Plant::new();
    let block = plant.body("block", mass, [0.0, height], 0.01, None);
    let axis = vec2(-slope.cos(), -slope.sin());
    // The block's frame is turned so that its x axis points down the slope, y off the ground.
    let axes = [axis, vec2(-1.0, 0.0)];
    let guide = plant.joint(
        "guide",
        (GROUND, [0.0, 0.0]),
        (block, [0.0, 0.0]),
        JointKind::Prismatic { axes },
    );
    plant.constant("weight", DOWN, G);
    let friction = Friction {
        joint: guide,
        coefficient: mu,
        static_coefficient: mu,
        contact: FrictionContact::Guide { length: 0.5 },
        regularization_speed: Some(regularization_speed),
    };
    let along = Guide {
        bodies: [GROUND, block],
        points: [vec2(0.0, 0.0); 2],
        axis,
    };
    plant.load(
        "friction",
        LoadKind::slide_force(along),
        Magnitude::Friction(friction),
    );
    plant.free([GROUND, block], ActuatorKind::Travel(guide), [0.0, 0.0]);
    let times = [0.05, 0.2, 1.0];
    let samples = plant.integrate(vec![[0.0; 3], [0.0, 0.0, slope]], vec![[0.0; 3]; 2], &times);
    let (a, b) = (G * slope.sin(), mu * G * slope.cos());
    let press = mass * G * slope.cos();
    for sample in &samples {
        let v = axis.dot(vec2(sample.velocities[1][0], sample.velocities[1][1]));
        let r = v / regularization_speed;
        let t = (a * v + b * regularization_speed * (r.cosh() - b / a * r.sinh()).ln())
            / (a * a - b * b);
        close(t, sample.t, 1.0, 1e-12);
        // The normal points into the ground: the axis, down the slope, turned by +90°.
        close(sample.reactions[0], -press, press, 1e-12);
        let tilt = -height * mu * press * r.tanh();
        close(sample.reactions[1].abs(), tilt.abs(), press * height, 1e-12);
        let lost = sample.kinetic + sample.potential - sample.work;
        close(lost, samples[0].potential, press, 1e-12);
    }
    assert!(samples[3].work < -1.0);
}

fn flywheel(inertia: f64) -> (Plant, ActuatorId) {
    let mut plant = Plant::new();
    let wheel = plant.body("wheel", 0.0, [0.0, 0.0], inertia, None);
    plant.pin("O", (GROUND, [0.0, 0.0]), (wheel, [0.0, 0.0]));
    let phi = plant.free([GROUND, wheel], ActuatorKind::Angle, [0.0, 0.0]);
    (plant, phi)
}

/// Without inductance the speed comes nearer to u/K exponentially; with it, it swings:
/// ω̈ + (R/L) ω̇ + K²/(L J) ω = K u/(L J), K = k N, J with the rotor's N² J_r.
#[test]
fn val_motor_on_a_flywheel() {
    let (u, k, resistance, ratio, rotor, wheel) = (12.0, 0.05, 0.8, 3.0, 2e-4, 3e-3);
    let (gain, inertia) = (k * ratio, wheel + ratio * ratio * rotor);
    for inductance in [0.0, 0.05] {
        let (mut plant, phi) = flywheel(wheel);
        let motor = Motor {
            voltage: Magnitude::Constant(u),
            torque_constant: k,
            resistance,
            inductance,
            gear_ratio: ratio,
            rotor_inertia: rotor,
            is_torque_speed_line: false,
        };
        plant.drive(phi, DriveKind::Motor(motor));
        let samples = plant.integrate(vec![[0.0; 3]; 2], vec![[0.0; 3]; 2], &[0.03, 0.1, 0.5]);
        let top = u / gain;
        for sample in &samples {
            let t = sample.t;
            let (speed, rate) = if inductance == 0.0 {
                let fall = (-gain * gain / (resistance * inertia) * t).exp();
                (top * (1.0 - fall), gain * u / (resistance * inertia) * fall)
            } else {
                let damp = resistance / (2.0 * inductance);
                let swing = (gain * gain / (inductance * inertia) - damp * damp).sqrt();
                let (fall, (s, c)) = ((-damp * t).exp(), (swing * t).sin_cos());
                let rate = top * fall * (swing + damp * damp / swing) * s;
                (top * (1.0 - fall * (c + damp / swing * s)), rate)
            };
            close(sample.velocities[1][2], speed, top, 1e-12);
            close(
                sample.drive_forces[0],
                inertia * rate,
                gain * u / resistance,
                1e-12,
            );
            close(
                sample.kinetic,
                0.5 * inertia * speed * speed,
                inertia * top * top,
                1e-12,
            );
            close(sample.work, sample.kinetic, inertia * top * top, 1e-12);
        }
    }
}

/// At its limit a speed controller accelerates the wheel uniformly and does not integrate; from
/// P (w − ω) = limit on J ë + P ė + I e = 0, critically damped here.
#[test]
fn val_regulator_through_its_limit() {
    let (inertia, proportional, limit, wanted) = (0.02, 0.4, 1.0, 10.0);
    let integral = proportional * proportional / (4.0 * inertia);
    let (mut plant, phi) = flywheel(inertia);
    let regulator = SpeedController {
        reference_speed: Magnitude::Constant(wanted),
        proportional_gain: proportional,
        integral_gain: integral,
        limit,
    };
    plant.drive(phi, DriveKind::SpeedController(regulator));
    let samples = plant.integrate(vec![[0.0; 3]; 2], vec![[0.0; 3]; 2], &[0.1, 0.2, 0.4]);
    let error = limit / proportional;
    let leaves = (wanted - error) * inertia / limit;
    assert!(leaves > 0.1 && leaves < 0.2);
    for sample in &samples {
        let speed = if sample.t < leaves {
            limit / inertia * sample.t
        } else {
            // e = (e₀ + c t) exp(−r t) with J ė = −limit at first.
            let (t, r) = (sample.t - leaves, proportional / (2.0 * inertia));
            let c = r * error - limit / inertia;
            wanted - (error + c * t) * (-r * t).exp()
        };
        // The kink is crossed by short steps.
        close(sample.velocities[1][2], speed, wanted, 1e-11);
    }
}

/// A massless link between a block and a flywheel, and a wheel driven by a law: what the law takes is
/// the couple of both, by the projectile's equations of nothing but sines.
#[test]
fn val_led_wheel_with_a_free_weight() {
    // A scotch yoke: the pin of a led wheel in the slot of a block that slides upright.
    let (radius, mass, speed) = (0.2, 1.5, 7.0);
    let mut plant = Plant::new();
    let wheel = plant.body("wheel", 0.0, [0.0, 0.0], 0.0, None);
    let block = plant.body("block", mass, [0.3, 0.0], 0.0, None);
    plant.pin("O", (GROUND, [0.0, 0.0]), (wheel, [0.0, 0.0]));
    let along = vec2(1.0, 0.0);
    plant.joint(
        "slot",
        (block, [0.0, 0.0]),
        (wheel, [radius, 0.0]),
        JointKind::Slot { axis: along },
    );
    let upright = vec2(0.0, 1.0);
    plant.joint(
        "guide",
        (GROUND, [0.0, 0.0]),
        (block, [0.0, 0.0]),
        JointKind::Prismatic {
            axes: [upright, upright],
        },
    );
    plant.constant("weight", DOWN, G);
    let law = dwell_laws::Polynomial::motion(0.3, speed, 0.0);
    plant.prescribed([GROUND, wheel], dwell_laws::Law::Polynomial(law));
    let y = radius * 0.3_f64.sin();
    let rise = radius * speed * 0.3_f64.cos();
    let samples = plant.integrate(
        vec![[0.0; 3], [0.0, 0.0, 0.3], [0.0, y, 0.0]],
        vec![[0.0; 3], [0.0, 0.0, speed], [0.0, rise, 0.0]],
        &[0.2, 0.5, 2.0 * PI / speed],
    );
    for sample in &samples {
        let angle = 0.3 + speed * sample.t;
        close(sample.poses[2][1], radius * angle.sin(), radius, 1e-13);
        let lift = mass * (G - radius * speed * speed * angle.sin());
        close(
            sample.tau[0],
            lift * radius * angle.cos(),
            mass * G * radius,
            1e-12,
        );
        // The block pushes the wheel down; the weight's moment about its slider.
        close(sample.reactions[2], -lift, mass * G, 1e-12);
        close(
            sample.work,
            sample.kinetic + sample.potential - samples[0].kinetic - samples[0].potential,
            mass * G,
            1e-12,
        );
    }
}
