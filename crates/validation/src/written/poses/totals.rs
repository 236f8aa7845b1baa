//! Sums over the whole mechanism in a row: shaking force by the momentum, powers and the kinetic energy.

use super::difference::Differences;
use super::equilibrium::actuator_forces;
use super::motion::Motion;
use super::reading::{LoadKind, Reading};
use super::rows::Rows;
use super::wrenches::Wrench;

/// Adds the differences of a row; the loads' forces are those of the second reading.
pub(crate) fn add(
    to: &mut Differences,
    reading: &Reading,
    rows: &Rows,
    row: usize,
    motion: &Motion,
    loads: &[Wrench],
    file: &str,
) {
    let mut compare = |name: &str, [value, scale]: [f64; 2], unit: &'static str| {
        if let Some(written) = rows.get(row, name) {
            to.add(written - value, scale, unit, || {
                format!("{file}, row {row}, {name}")
            });
        }
    };
    let mut shaking = [[0.0; 2]; 3];
    let mut push = |[fx, fy]: [f64; 2], [x, y]: [f64; 2], couple: f64| {
        let moment = x * fy - y * fx + couple;
        let size = fx.hypot(fy);
        let terms = [size, size, size * x.hypot(y) + couple.abs()];
        for (k, value) in [fx, fy, moment].into_iter().enumerate() {
            shaking[k][0] += value;
            shaking[k][1] += terms[k];
        }
    };
    for wrench in external(reading, motion, rows.time(row)) {
        push(wrench.force, wrench.point, wrench.couple);
    }
    let (mut kinetic, mut rate, mut rate_terms) = (0.0, 0.0, 0.0);
    for (b, body) in reading.bodies.iter().enumerate() {
        let center = motion.center(reading, b);
        let ([vx, vy], [ax, ay]) = (center.order(1), center.order(2));
        let [_, omega, alpha] = motion.bodies[b].angle.0;
        push(
            [-body.mass * ax, -body.mass * ay],
            center.order(0),
            -body.inertia * alpha,
        );
        kinetic += 0.5 * (body.mass * (vx * vx + vy * vy) + body.inertia * omega * omega);
        rate += body.mass * (vx * ax + vy * ay) + body.inertia * omega * alpha;
        rate_terms +=
            body.mass * vx.hypot(vy) * ax.hypot(ay) + (body.inertia * omega * alpha).abs();
    }
    for (k, name) in ["fx", "fy", "moment"].iter().enumerate() {
        compare(
            &format!("shaking.{name}"),
            shaking[k],
            if k < 2 { "N" } else { "N m" },
        );
    }
    compare("energy.kinetic_bodies", [kinetic, kinetic], "J");
    compare("power.kinetic", [rate, rate_terms], "W");
    let rates = reading
        .coordinates
        .iter()
        .map(|c| motion.measure(c.measure).0[1]);
    let powers = actuator_forces(reading, rows, row)
        .into_iter()
        .zip(rates)
        .map(|(f, v)| f * v);
    let powers: Vec<f64> = powers.collect();
    let sum = |values: &[f64]| [values.iter().sum(), values.iter().map(|v| v.abs()).sum()];
    compare("power.actuators", sum(&powers), "W");
    if reading.frictions.is_empty() {
        let powers: Vec<f64> = loads.iter().map(|load| load.power(motion)).collect();
        compare("power.loads", sum(&powers), "W");
    }
}

/// The loads that act on the mechanism from outside: weights and single forces.
fn external(reading: &Reading, motion: &Motion, t: f64) -> Vec<Wrench> {
    let is_external =
        |kind: &LoadKind| matches!(kind, LoadKind::Gravity(_) | LoadKind::Force { .. });
    let mut all = Vec::new();
    for load in reading.loads.iter().filter(|load| is_external(&load.kind)) {
        let magnitude = load.magnitude(reading, motion, t).unwrap_or(f64::NAN);
        all.extend(
            load.unit_wrenches(reading, motion)
                .iter()
                .map(|w| w.times(magnitude)),
        );
    }
    all
}
