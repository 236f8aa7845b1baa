//! Newton's and Euler's equations of every body with the forces as they are written, and what follows from them: shaking
//! forces, powers, and the forces of loads.

use super::difference::Differences;
use super::motion::Motion;
use super::reading::Reading;
use super::rows::Rows;
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

/// Names of the columns of a column group: reactions with this ending, and of the actuators.
pub(crate) struct ForceColumns<'a> {
    pub(crate) reaction_end: &'a str,
    pub(crate) actuators: Vec<f64>,
}

/// Forces and inertia of a body are relative to the largest of a file.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct ForceScale {
    pub(crate) force: f64,
    pub(crate) moment: f64,
}

/// The wrenches of all joints of a row; none where a column is missing (statically indeterminate reactions).
pub(crate) fn written_joint_wrenches(
    reading: &Reading,
    rows: &Rows,
    row: usize,
    motion: &Motion,
    columns: &ForceColumns<'_>,
) -> Option<Vec<Wrench>> {
    let mut all = Vec::new();
    for joint in &reading.joints {
        let reaction = reaction(rows, row, joint, columns.reaction_end)?;
        all.extend(joint_wrenches(joint, motion, &reaction)?);
    }
    for (coordinate, force) in reading.coordinates.iter().zip(&columns.actuators) {
        all.extend(along(motion, coordinate.measure, *force));
    }
    Some(all)
}

/// The components of a reaction as written.
pub(crate) fn reaction(
    rows: &Rows,
    row: usize,
    joint: &super::reading::Joint,
    end: &str,
) -> Option<Vec<f64>> {
    let of = |component: &&str| rows.get(row, &format!("{}.{component}{end}", joint.name));
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
    reading: &Reading,
    motion: &Motion,
    wrenches: &[Wrench],
    order: Option<usize>,
) -> Vec<BodyResidual> {
    let moving = reading
        .bodies
        .iter()
        .enumerate()
        .filter(|(_, body)| !body.is_ground);
    let of = |(b, body): (usize, &super::reading::Body)| {
        let center = motion.center(reading, b);
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
    let terms = |k: usize| {
        all.iter()
            .flat_map(|(_, r)| r)
            .map(move |(_, _, t)| t[k])
            .fold(0.0, f64::max)
    };
    let scale = ForceScale {
        force: terms(0),
        moment: terms(1).max(terms(0) * reading.size()),
    };
    for (row, residuals) in all {
        for (body, sum, _) in residuals {
            for (k, axis) in ["x", "y", "moment"].iter().enumerate() {
                let (scale, unit) = if k < 2 {
                    (scale.force, "N")
                } else {
                    (scale.moment, "N m")
                };
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
        let Some(mut wrenches) = loads.wrenches(reading, rows, row, &motion) else {
            found
                .loads
                .fail(format!("{file}, row {row}: a load has no value"));
            return found;
        };
        let columns = ForceColumns {
            reaction_end: "",
            actuators: actuator_forces(reading, rows, row),
        };
        totals.add(reading, rows, row, &motion, &wrenches);
        loads.add_known_reactions(reading, rows, row, &motion);
        // Statically indeterminate reactions are in no file.
        let Some(joints) = written_joint_wrenches(reading, rows, row, &motion, &columns) else {
            continue;
        };
        wrenches.extend(joints);
        for friction in &reading.frictions {
            let reaction =
                reaction(rows, row, &reading.joints[friction.joint], "").unwrap_or_default();
            wrenches.extend(
                friction
                    .wrenches(reading, &motion, &reaction)
                    .into_iter()
                    .flatten(),
            );
        }
        let order = (!at_rest).then_some(2);
        residuals.push((row, body_residuals(reading, &motion, &wrenches, order)));
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
    fn wrenches(
        &mut self,
        reading: &Reading,
        rows: &Rows,
        row: usize,
        motion: &Motion,
    ) -> Option<Vec<Wrench>> {
        let t = rows.time(row);
        let mut all = Vec::new();
        for (k, load) in reading.loads.iter().enumerate() {
            let magnitude = load.magnitude(reading, motion, t)?;
            let column = |end: &&str| rows.get(row, &format!("{}.load_{end}", load.name));
            if let Some(written) = ["force", "moment"].iter().find_map(column) {
                let largest = self.largest.entry(k).or_default();
                *largest = largest.max(magnitude.abs());
                self.differences.push((row, k, written - magnitude));
            }
            let unit = load.unit_wrenches(reading, motion);
            all.extend(unit.iter().map(|wrench| wrench.times(magnitude)));
        }
        Some(all)
    }

    /// The written reactions that the scene gives over the angle of a body.
    fn add_known_reactions(&mut self, reading: &Reading, rows: &Rows, row: usize, motion: &Motion) {
        for (b, body) in reading.bodies.iter().enumerate() {
            let [angle, omega, alpha] = motion.bodies[b].angle.0;
            let Some(table) = &body.varying else { continue };
            for reaction in table.reactions_at(angle, [omega, alpha]) {
                if let Some(written) = rows.get(row, reaction.name) {
                    let name = reaction.name.to_owned();
                    self.known.push((row, name, [written, reaction.value]));
                }
            }
        }
    }

    fn add(self, to: &mut Differences, reading: &Reading, file: &str) {
        let largest = self
            .known
            .iter()
            .fold(0.0_f64, |max, (.., [_, x])| max.max(x.abs()));
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
pub(crate) fn actuator_forces(reading: &Reading, rows: &Rows, row: usize) -> Vec<f64> {
    let actuators = reading.coordinates.iter().take(reading.actuator_count);
    let force =
        |c: &super::reading::Coordinate| rows.get(row, &format!("{}.actuator_force", c.name));
    actuators.map(|c| force(c).unwrap_or(f64::NAN)).collect()
}
