//! Sums over the whole mechanism in a row: shaking force by the momentum, powers and the kinetic energy.

use super::difference::Differences;
use super::equilibrium::actuator_forces;
use super::motion::Motion;
use super::reading::{Load, LoadKind};
use super::wrenches::Wrench;

/// The written sums of a file, and those of its bodies.
#[derive(Debug, Default)]
pub(crate) struct Totals {
    /// Row, column, written less expected, size of the terms.
    sums: Vec<(usize, &'static str, [f64; 2])>,
    /// The largest force of a joint in the file.
    largest_force: f64,
}

/// The columns and the kind whose largest terms they are relative to.
const KINDS: [(&str, usize); 7] = [
    ("shaking.fx", 0),
    ("shaking.fy", 0),
    ("shaking.moment", 1),
    ("energy.kinetic_bodies", 2),
    ("power.kinetic", 3),
    ("power.actuators", 3),
    ("power.loads", 3),
];
const UNITS: [&str; 4] = ["N", "N m", "J", "W"];

impl Totals {
    /// Adds a row; the loads' forces are those of the second reading.
    pub(crate) fn add(&mut self, motion: &Motion<'_>, loads: &[Wrench]) {
        let reading = motion.reading;
        let [fx, fy, moment] = shaking(motion);
        let [energy, power] = kinetic(motion);
        let sum = |values: &[f64]| [values.iter().sum(), values.iter().map(|v| v.abs()).sum()];
        let coordinates = reading.coordinates.iter().zip(actuator_forces(motion));
        let powers = coordinates.map(|(c, force)| force * motion.measure(c.measure).0[1]);
        let actuators = sum(&powers.collect::<Vec<_>>());
        let powers = loads.iter().map(|load| load.power(motion));
        let loads = sum(&powers.collect::<Vec<_>>());
        let sums = [fx, fy, moment, energy, power, actuators, loads];
        for ((name, _), [value, terms]) in KINDS.into_iter().zip(sums) {
            // What friction does is not among the loads.
            let is_known = name != "power.loads" || reading.frictions.is_empty();
            if let Some(written) = motion.get(name).filter(|_| is_known) {
                let sum = (motion.row, name, [written - value, terms]);
                self.sums.push(sum);
            }
        }
        for joint in &reading.joints {
            let force = motion.get(&format!("{}.magnitude", joint.name));
            self.largest_force = self.largest_force.max(force.unwrap_or(0.0));
        }
    }

    /// The differences, each relative to the largest of its kind in the file.
    pub(crate) fn differences(&self, size: f64, file: &str) -> Differences {
        let kind = |name: &str| {
            let known = KINDS.iter().find(|(known, _)| *known == name);
            known.map_or(0, |k| k.1)
        };
        let mut scales = [self.largest_force, self.largest_force * size, 0.0, 0.0];
        for (_, name, [_, terms]) in &self.sums {
            scales[kind(name)] = scales[kind(name)].max(*terms);
        }
        let mut all = Differences::default();
        for (row, name, [difference, _]) in &self.sums {
            let kind = kind(name);
            all.add(*difference, scales[kind], UNITS[kind], || {
                format!("{file}, row {row}, {name}")
            });
        }
        all
    }
}

/// What the ground feels: the loads from outside less the rate of the momentum; each sum with its absolute terms.
fn shaking(motion: &Motion<'_>) -> [[f64; 2]; 3] {
    let mut sums = [[0.0; 2]; 3];
    let mut push = |[fx, fy]: [f64; 2], [x, y]: [f64; 2], couple: f64| {
        let size = fx.hypot(fy);
        let terms = [size, size, size * x.hypot(y) + couple.abs()];
        for (k, value) in [fx, fy, x * fy - y * fx + couple].into_iter().enumerate() {
            sums[k][0] += value;
            sums[k][1] += terms[k];
        }
    };
    for wrench in external(motion) {
        push(wrench.force, wrench.point, wrench.couple);
    }
    for (b, body) in motion.reading.bodies.iter().enumerate() {
        let center = motion.center(b);
        let force = center.order(2).map(|a| -body.mass * a);
        let couple = -body.inertia_moment(motion.bodies[b].angle.0);
        push(force, center.order(0), couple);
    }
    sums
}

/// The kinetic energy and its rate, with absolute terms.
fn kinetic(motion: &Motion<'_>) -> [[f64; 2]; 2] {
    let mut sums = [[0.0; 2]; 2];
    for (b, body) in motion.reading.bodies.iter().enumerate() {
        let center = motion.center(b);
        let ([vx, vy], [ax, ay]) = (center.order(1), center.order(2));
        let [angle, omega, alpha] = motion.bodies[b].angle.0;
        let inertia = body.inertia_at(angle)[0];
        let of_angle = omega * body.inertia_moment([angle, omega, alpha]);
        let energy = 0.5 * (body.mass * (vx * vx + vy * vy) + inertia * omega * omega);
        let rate = body.mass * (vx * ax + vy * ay) + of_angle;
        let terms = body.mass * vx.hypot(vy) * ax.hypot(ay) + of_angle.abs();
        for (sum, [value, size]) in sums.iter_mut().zip([[energy, energy], [rate, terms]]) {
            sum[0] += value;
            sum[1] += size;
        }
    }
    sums
}

/// The loads that act on the mechanism from outside: weights and single forces.
fn external(motion: &Motion<'_>) -> Vec<Wrench> {
    let is_external = |load: &&Load| !matches!(load.kind, LoadKind::Along(..));
    let loads = motion.reading.loads.iter().filter(is_external);
    loads
        .filter_map(|load| load.wrenches(motion))
        .flatten()
        .collect()
}
