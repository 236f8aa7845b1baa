//! Newton's and Euler's equations of every body with the forces as they are written, and what follows from them: shaking
//! forces, powers, and the forces of loads.

use super::difference::Differences;
use super::motion::Motion;
use super::reading::{Body, Coordinate, Joint, Reading};
use super::rows::{Rows, largest};
use super::totals::Totals;
use super::wrenches::{Wrench, along, components, joint_wrenches};
use std::collections::BTreeMap;

/// Differences of the forces of a file.
#[derive(Debug, Default)]
pub(crate) struct Equilibrium {
    /// Newton's and Euler's equations of the bodies.
    pub(crate) bodies: Differences,
    /// Magnitudes of loads.
    pub(crate) loads: Differences,
    /// Shaking force and powers.
    pub(crate) totals: Differences,
}

/// The wrenches of all joints of a row, by columns of reactions with this ending, and of the actuators' forces; none where a column is missing
/// (statically indeterminate reactions).
pub(crate) fn written_joint_wrenches(
    motion: &Motion<'_>,
    end: &str,
    actuators: &[f64],
) -> Option<Vec<Wrench>> {
    let mut all = Vec::new();
    for joint in &motion.reading.joints {
        let reaction = reaction(motion, joint, end)?;
        all.extend(joint_wrenches(joint, motion, &reaction)?);
    }
    for (coordinate, force) in motion.reading.coordinates.iter().zip(actuators) {
        all.extend(along(motion, coordinate.measure, *force));
    }
    Some(all)
}

/// The components of a reaction as written.
pub(crate) fn reaction(motion: &Motion<'_>, joint: &Joint, end: &str) -> Option<Vec<f64>> {
    let of = |component: &&str| motion.get(&format!("{}.{component}{end}", joint.name));
    components(joint).iter().map(of).collect()
}

/// What is left of the forces on a body after m a and I α, with the sums of absolute terms: x, y, moment about its centre.
pub(crate) fn residual(
    wrenches: &[Wrench],
    body: usize,
    center: [f64; 2],
    inertia: [f64; 3],
) -> ([f64; 3], [f64; 2]) {
    let mut sum = inertia.map(|x| -x);
    let mut terms = [inertia[0].hypot(inertia[1]), inertia[2].abs()];
    for wrench in wrenches.iter().filter(|w| w.body == body) {
        let ([fx, fy], arm) = (
            wrench.force,
            [wrench.point[0] - center[0], wrench.point[1] - center[1]],
        );
        sum[0] += fx;
        sum[1] += fy;
        let moment = match wrench.force {
            [0.0, 0.0] => 0.0,
            _ => arm[0] * fy - arm[1] * fx,
        };
        sum[2] += moment + wrench.couple;
        let size = fx.hypot(fy);
        terms[0] = terms[0].max(size);
        terms[1] = terms[1].max(wrench.couple.abs());
        if size > 0.0 {
            terms[1] = terms[1].max(size * arm[0].hypot(arm[1]));
        }
    }
    (sum, terms)
}

/// A body, what is left of its forces (x, y, moment), and the sums of absolute terms (force, moment).
pub(crate) type BodyResidual = (usize, [f64; 3], [f64; 2]);

/// Newton's and Euler's equations of a row, with an order of the derivative as acceleration: 2, or 1 where velocities
/// stand for accelerations, or none at rest.
pub(crate) fn body_residuals(
    motion: &Motion<'_>,
    wrenches: &[Wrench],
    order: Option<usize>,
) -> Vec<BodyResidual> {
    let bodies = motion.reading.bodies.iter().enumerate();
    let moving = bodies.filter(|(_, body)| !body.is_ground);
    let of = |(b, body): (usize, &Body)| {
        let center = motion.center(b);
        let inertia = order.map_or([0.0; 3], |k| {
            let [x, y] = center.order(k);
            [
                body.mass * x,
                body.mass * y,
                match motion.bodies[b].angle.0 {
                    angle if k == 2 => body.inertia_moment(angle),
                    angle => body.inertia_at(angle[0])[0] * angle[k],
                },
            ]
        });
        let (sum, mut terms) = residual(wrenches, b, center.order(0), inertia);
        if let (Some(2), Some(_)) = (order, &body.varying) {
            terms[1] += body.inertia_terms(motion.bodies[b].angle.0);
        }
        (b, sum, terms)
    };
    moving.map(of).collect()
}

/// Adds residuals of several rows, relative to the largest terms among all of them. A moment is at least relative to the
/// largest force times the size of a body: forces without an arm have its rounding.
pub(crate) fn add_residuals(
    to: &mut Differences,
    reading: &Reading,
    all: &[(usize, Vec<BodyResidual>)],
    what: &str,
) {
    let terms = all.iter().flat_map(|(_, r)| r).map(|(.., terms)| terms);
    let [force, moment] = [0, 1].map(|k| terms.clone().map(|t| t[k]).fold(0.0, f64::max));
    let moment = moment.max(force * reading.size());
    let axes = [
        ("x", force, "N"),
        ("y", force, "N"),
        ("moment", moment, "N m"),
    ];
    for (row, residuals) in all {
        for (body, sum, _) in residuals {
            for (k, (axis, scale, unit)) in axes.into_iter().enumerate() {
                let name = &reading.bodies[*body].name;
                to.add(sum[k], scale, unit, || {
                    format!("{what}, row {row}, {name} {axis}")
                });
            }
        }
    }
}

/// The forces of a file of kinetostatics, or of statics.
pub(crate) fn equilibrium(
    reading: &Reading,
    rows: &Rows,
    file: &str,
    at_rest: bool,
) -> Equilibrium {
    let mut found = Equilibrium::default();
    let mut residuals = Vec::new();
    let mut loads = LoadDifferences::default();
    let mut totals = Totals::default();
    for row in 0..rows.count {
        let Some(motion) = Motion::new(reading, rows, row) else {
            found
                .bodies
                .fail(format!("{file}: a column of a body is missing"));
            return found;
        };
        let motion = if at_rest { motion.at_rest() } else { motion };
        let Some(mut wrenches) = loads.wrenches(&motion) else {
            found
                .loads
                .fail(format!("{file}, row {row}: a load has no value"));
            return found;
        };
        totals.add(&motion, &wrenches);
        loads.add_known_reactions(&motion);
        // Statically indeterminate reactions are in no file.
        let joints = written_joint_wrenches(&motion, "", &actuator_forces(&motion));
        let Some(joints) = joints else {
            continue;
        };
        wrenches.extend(joints);
        for friction in &reading.frictions {
            let joint = &reading.joints[friction.joint];
            let reaction = reaction(&motion, joint, "").unwrap_or_default();
            wrenches.extend(friction.wrenches(&motion, &reaction).into_iter().flatten());
        }
        let order = (!at_rest).then_some(2);
        residuals.push((row, body_residuals(&motion, &wrenches, order)));
    }
    add_residuals(&mut found.bodies, reading, &residuals, file);
    loads.add(&mut found.loads, reading, file);
    found.totals = totals.differences(reading.size(), file);
    found
}

/// The written magnitudes of loads less those of the second reading.
#[derive(Default)]
struct LoadDifferences {
    /// Row, load, difference.
    differences: Vec<(usize, usize, f64)>,
    /// By load: the largest magnitude.
    largest: BTreeMap<usize, f64>,
    /// Of reactions that the scene gives over an angle: row, name, written and expected value.
    known: Vec<(usize, String, [f64; 2])>,
}

impl LoadDifferences {
    /// The forces of all loads in a row; none where one has no value.
    fn wrenches(&mut self, motion: &Motion<'_>) -> Option<Vec<Wrench>> {
        let mut all = Vec::new();
        for (k, load) in motion.reading.loads.iter().enumerate() {
            let magnitude = load.magnitude(motion)?;
            let column = |end: &&str| motion.get(&format!("{}.load_{end}", load.name));
            if let Some(written) = ["force", "moment"].iter().find_map(column) {
                let largest = self.largest.entry(k).or_default();
                *largest = largest.max(magnitude.abs());
                self.differences.push((motion.row, k, written - magnitude));
            }
            all.extend(load.wrenches(motion)?);
        }
        Some(all)
    }

    /// The written reactions that the scene gives over the angle of a body.
    fn add_known_reactions(&mut self, motion: &Motion<'_>) {
        for (b, body) in motion.reading.bodies.iter().enumerate() {
            let [angle, omega, alpha] = motion.bodies[b].angle.0;
            let Some(table) = &body.varying else { continue };
            for reaction in table.reactions_at(angle, [omega, alpha]) {
                if let Some(written) = motion.get(reaction.name) {
                    let name = reaction.name.to_owned();
                    self.known
                        .push((motion.row, name, [written, reaction.value]));
                }
            }
        }
    }

    fn add(self, to: &mut Differences, reading: &Reading, file: &str) {
        let largest = largest(self.known.iter().map(|(.., [_, expected])| expected));
        for (row, name, [written, expected]) in &self.known {
            to.add(written - expected, largest, "N", || {
                format!("{file}, row {row}, {name}")
            });
        }
        for (row, k, difference) in self.differences {
            let scale = self.largest.get(&k).copied().unwrap_or(0.0);
            let name = &reading.loads[k].name;
            to.add(difference, scale, "N", || {
                format!("{file}, row {row}, load {name}")
            });
        }
    }
}

/// The actuator forces of a row.
pub(crate) fn actuator_forces(motion: &Motion<'_>) -> Vec<f64> {
    let force = |c: &Coordinate| motion.get(&format!("{}.actuator_force", c.name));
    let actuators = motion.reading.actuators().iter();
    actuators.map(|c| force(c).unwrap_or(f64::NAN)).collect()
}
