//! The rows of `reduce`: inertia, coefficients of reactions, of loads, and the potential, against the motion of the same
//! positions as `runs` writes it (unit speed, no acceleration), by the equations of every body and by the rows' own slope.

use super::difference::Differences;
use super::equilibrium::{add_residuals, body_residuals, written_joint_wrenches};
use super::motion::Motion;
use super::reading::{Load, LoadKind, Magnitude, Reading, Source};
use super::rows::{Rows, largest};
use super::wrenches::Wrench;

/// Differences of a file of `reduce`.
#[derive(Debug, Default)]
pub(crate) struct Reduced {
    /// m, ½m′ and w by sums over bodies.
    pub(crate) sums: Differences,
    /// a, b and c by the equations of every body.
    pub(crate) bodies: Differences,
    /// m and V against the integrals of ½m′ and w between rows.
    pub(crate) slopes: Differences,
    /// a and b, m and ½m′ against the two runs.
    pub(crate) runs: Differences,
}

/// The file of `reduce` and both runs, at the same positions.
pub(crate) struct ReducedFiles<'a> {
    pub(crate) reduced: &'a Rows,
    pub(crate) run_i: &'a Rows,
    pub(crate) run_ii: &'a Rows,
}

/// Judges every row.
pub(crate) fn reduced(reading: &Reading, files: &ReducedFiles<'_>, coordinate: &str) -> Reduced {
    let mut found = Reduced::default();
    let (rows, run) = (files.reduced, files.run_i);
    if rows.count != run.count || rows.count == 0 {
        found.sums.fail(format!(
            "`reduce` has {} rows, `runs` {}",
            rows.count, run.count
        ));
        return found;
    }
    let Some(mut motions) = Motion::of_all(reading, run) else {
        let reason = "a column of a body is missing in the run";
        found.sums.fail(reason);
        return found;
    };
    // At the same positions all other columns are those of `reduce`.
    for motion in &mut motions {
        motion.rows = rows;
    }
    add_positions(&mut found.sums, rows, run, coordinate);
    let run_ii = (!differs(rows, files.run_ii, coordinate)).then_some(files.run_ii);
    add_sums(&mut found.sums, reading, rows, &motions);
    add_bodies(&mut found.bodies, reading, &motions);
    add_slopes(&mut found.slopes, reading, rows, &motions, coordinate);
    add_runs(&mut found.runs, [rows, run], run_ii, coordinate);
    found
}

/// Whether two files have other positions: `runs` begins a revolution where the mechanism was assembled if it does not
/// return to where it was.
fn differs(rows: &Rows, run: &Rows, coordinate: &str) -> bool {
    let of = |rows: &Rows| {
        Some([
            rows.get(0, coordinate)?,
            rows.get(rows.count - 1, coordinate)?,
        ])
    };
    let (Some(one), Some(other)) = (of(rows), of(run)) else {
        return true;
    };
    rows.count != run.count
        || (0..2).any(|k| (one[k] - other[k]).abs() > 1e-9 * (1.0 + one[k].abs()))
}

fn add_positions(to: &mut Differences, rows: &Rows, run: &Rows, coordinate: &str) {
    for row in 0..rows.count {
        let of = |rows: &Rows| rows.get(row, coordinate).unwrap_or(f64::NAN);
        let (q, expected) = (of(rows), of(run));
        to.add(q - expected, 1.0 + expected.abs(), "rad", || {
            format!("row {row}, {coordinate}")
        });
    }
}

/// A column against values of every row, relative to the largest of these and of the terms that they are sums of.
fn add_column(
    to: &mut Differences,
    rows: &Rows,
    name: &str,
    values: &[[f64; 2]],
    unit: &'static str,
) {
    let scale = values.iter().fold(0.0, |max: f64, [value, terms]| {
        max.max(value.abs()).max(*terms)
    });
    for (row, [value, _]) in values.iter().enumerate() {
        if let Some(written) = rows.get(row, name) {
            to.add(written - value, scale, unit, || {
                format!("row {row}, {name}")
            });
        }
    }
}

fn add_sums(to: &mut Differences, reading: &Reading, rows: &Rows, motions: &[Motion<'_>]) {
    let inertia = |motion: &Motion<'_>, orders: [usize; 2]| {
        let bodies = reading.bodies.iter().enumerate();
        let terms = bodies.map(|(b, body)| {
            let center = motion.center(b);
            let [[ux, uy], [vx, vy]] = orders.map(|k| center.order(k));
            let angle = motion.bodies[b].angle.0;
            let moment = match orders[1] {
                2 => body.inertia_moment(angle),
                _ => body.inertia_at(angle[0])[0] * angle[1],
            };
            let of_angle = angle[1] * moment;
            let size = body.mass * ux.hypot(uy) * vx.hypot(vy) + of_angle.abs();
            [body.mass * (ux * vx + uy * vy) + of_angle, size]
        });
        terms.fold([0.0; 2], |[a, b], [c, d]| [a + c, b + d])
    };
    for (name, orders) in [("m", [1, 1]), ("half_dm", [1, 2])] {
        let all: Vec<[f64; 2]> = motions.iter().map(|m| inertia(m, orders)).collect();
        add_column(to, rows, name, &all, "kg m2");
    }
    add_known_coefficients(to, reading, rows, motions);
    for load in &reading.loads {
        let power = |motion: &Motion<'_>| {
            let powers = load.coefficient_wrenches(motion);
            let powers = powers.iter().map(|w| w.power(motion));
            powers.fold([0.0; 2], |[a, b], p| [a + p, b + p.abs()])
        };
        let values: Vec<[f64; 2]> = motions.iter().map(power).collect();
        add_column(to, rows, &format!("{}.w", load.name), &values, "m");
    }
}

/// a and b of the reactions that the scene gives over the angle of a body, at unit speed of the coordinate.
fn add_known_coefficients(
    to: &mut Differences,
    reading: &Reading,
    rows: &Rows,
    motions: &[Motion<'_>],
) {
    for (b, body) in reading.bodies.iter().enumerate() {
        let Some(table) = &body.varying else { continue };
        let at = |motion: &Motion<'_>| {
            let [angle, ratio, second] = motion.bodies[b].angle.0;
            let found = table.reactions_at(angle, [ratio, second]).into_iter();
            found.map(|r| [r.a * ratio, r.value]).collect()
        };
        let values: Vec<Vec<[f64; 2]>> = motions.iter().map(at).collect();
        for (k, reaction) in table.reactions.iter().enumerate() {
            for (c, end) in ["a", "b"].into_iter().enumerate() {
                let of = values.iter().filter_map(|all| all.get(k));
                let of: Vec<[f64; 2]> = of.map(|pair| [pair[c], pair[c].abs()]).collect();
                add_column(to, rows, &format!("{}.{end}", reaction.name), &of, "kg m");
            }
        }
    }
}

impl Load {
    /// Its forces for a coefficient of 1: a force of 1 N, or a stiffness of 1 N/m.
    fn coefficient_wrenches(&self, motion: &Motion<'_>) -> Vec<Wrench> {
        let factor = match &self.kind {
            LoadKind::Along(measure, Source::Spring { free, .. }) => {
                free - motion.measure(*measure).value()
            }
            // The magnitude of a damper pulls together, or back.
            LoadKind::Along(_, Source::Damper(_)) => -1.0,
            LoadKind::Gravity(_)
            | LoadKind::Force { .. }
            | LoadKind::Along(_, Source::Given(_)) => 1.0,
        };
        let unit = self.unit_wrenches(motion);
        unit.iter().map(|w| w.times(factor)).collect()
    }

    /// Its constant coefficient, if it has a potential that V counts: weights, forces of a fixed direction and springs.
    fn potential_coefficient(&self, motion: &Motion<'_>) -> Option<f64> {
        let constant = |m: &Magnitude| match m {
            Magnitude::Expression(e) if !e.mentions(&|_| true) => m.at(motion),
            Magnitude::Expression(_) | Magnitude::Table { .. } => None,
        };
        match &self.kind {
            LoadKind::Gravity([x, y]) => Some(x.hypot(*y)),
            LoadKind::Force {
                magnitude, in_body, ..
            } => constant(magnitude).filter(|_| !in_body),
            LoadKind::Along(_, Source::Spring { stiffness, .. }) => constant(stiffness),
            LoadKind::Along(_, Source::Given(_) | Source::Damper(_)) => None,
        }
    }
}

fn add_bodies(to: &mut Differences, reading: &Reading, motions: &[Motion<'_>]) {
    // Teeth with a pressure angle have a force that is not linear in the others.
    if reading
        .joints
        .iter()
        .any(|joint| joint.pressure_angle != 0.0)
    {
        return;
    }
    let of = |motion: &Motion<'_>, name: &str| motion.get(name).unwrap_or(f64::NAN);
    for (end, actuator, order) in [(".a", "m", 1), (".b", "half_dm", 2)] {
        let residuals = |motion: &Motion<'_>| {
            let wrenches = written_joint_wrenches(motion, end, &[of(motion, actuator)])?;
            Some((motion.row, body_residuals(motion, &wrenches, Some(order))))
        };
        let all: Vec<_> = motions.iter().filter_map(residuals).collect();
        add_residuals(to, reading, &all, end);
    }
    for load in &reading.loads {
        let (end, w) = (format!(".c.{}", load.name), format!("{}.w", load.name));
        let residuals = |motion: &Motion<'_>| {
            let mut wrenches = written_joint_wrenches(motion, &end, &[-of(motion, &w)])?;
            wrenches.extend(load.coefficient_wrenches(motion));
            Some((motion.row, body_residuals(motion, &wrenches, None)))
        };
        let all: Vec<_> = motions.iter().filter_map(residuals).collect();
        add_residuals(to, reading, &all, &end);
    }
}

/// An estimated error of the quadrature counts this many times: the next order of it is unknown.
const ERROR_FACTOR: f64 = 4.0;

/// m′ = 2·½m′ and V′ = −Σ w F between rows, by Simpson's rule over two intervals, with its error from four.
fn add_slopes(
    to: &mut Differences,
    reading: &Reading,
    rows: &Rows,
    motions: &[Motion<'_>],
    coordinate: &str,
) {
    let Some(q) = rows.columns.get(coordinate) else {
        return;
    };
    let mut compare = |what: &str, value: &[f64], slope: &[f64]| {
        let range = q.last().zip(q.first()).map_or(1.0, |(b, a)| b - a);
        let scale = largest(value).max(largest(slope) * range);
        for i in 2..value.len().saturating_sub(2) {
            let h = q[i + 1] - q[i];
            let simpson = |k: usize| {
                let sum = slope[i - k] + 4.0 * slope[i] + slope[i + k];
                value[i + k] - value[i - k] - h * k as f64 / 3.0 * sum
            };
            let estimate = simpson(2).abs() / 32.0;
            let difference = (simpson(1).abs() - ERROR_FACTOR * estimate).max(0.0);
            to.add(difference, scale * h / range, "J", || {
                format!("row {i}, {what}")
            });
        }
    };
    if let [Some(m), Some(half)] = ["m", "half_dm"].map(|name| rows.columns.get(name)) {
        compare("m", m, &half.iter().map(|x| 2.0 * x).collect::<Vec<_>>());
    }
    let has_potential = |load: &&Load| {
        let mut first = motions.iter().take(1);
        first.any(|motion| load.potential_coefficient(motion).is_some())
    };
    let loads: Vec<&Load> = reading.loads.iter().filter(has_potential).collect();
    let force = |motion: &Motion<'_>| {
        let of = |load: &&Load| {
            let coefficient = load.potential_coefficient(motion)?;
            Some(-coefficient * motion.get(&format!("{}.w", load.name))?)
        };
        loads.iter().map(of).sum::<Option<f64>>()
    };
    let slope: Option<Vec<f64>> = motions.iter().map(force).collect();
    if let (Some(potential), Some(slope)) = (rows.columns.get("V"), slope) {
        compare("V", potential, &slope);
    }
}

/// Every a and b against the reactions of both runs, m and ½m′ against their actuator forces. Each is relative to the
/// largest of its unit: a coefficient may be zero throughout.
fn add_runs(
    to: &mut Differences,
    [reduced, run_i]: [&Rows; 2],
    run_ii: Option<&Rows>,
    coordinate: &str,
) {
    let count = reduced.count;
    let mut pairs = vec![(
        "m".to_owned(),
        "half_dm".to_owned(),
        format!("{coordinate}.actuator_force"),
    )];
    for name in reduced
        .columns
        .keys()
        .filter_map(|name| name.strip_suffix(".a"))
    {
        pairs.push((format!("{name}.a"), format!("{name}.b"), name.to_owned()));
    }
    let of = |rows: &Rows, name: &str| rows.columns.get(name).filter(|c| c.len() == count).cloned();
    let speed = run_ii.and_then(|run| of(run, &format!("{coordinate}.velocity")));
    let scale = |is_moment: bool| {
        let columns = pairs
            .iter()
            .filter(|pair| is_moment_column(&pair.2) == is_moment);
        let columns = columns
            .flat_map(|(a, b, _)| [a, b])
            .filter_map(|name| of(reduced, name));
        columns.flatten().fold(0.0, |max: f64, v| max.max(v.abs()))
    };
    let scales = [scale(false), scale(true)];
    for (a, b, force) in &pairs {
        let [Some(a_column), Some(b_column), Some(in_i)] =
            [of(reduced, a), of(reduced, b), of(run_i, force)]
        else {
            continue;
        };
        let scale = scales[usize::from(is_moment_column(force))];
        let in_ii = run_ii.and_then(|run| of(run, force));
        for row in 0..count {
            to.add(b_column[row] - in_i[row], scale, "kg m", || {
                format!("row {row}, {b}")
            });
            if let (Some(speed), Some(in_ii)) = (&speed, &in_ii) {
                let centrifugal = b_column[row] * speed[row] * speed[row];
                let of_a = a_column[row] + centrifugal - in_ii[row];
                to.add(of_a, scale + centrifugal.abs(), "kg m", || {
                    format!("row {row}, {a}")
                });
            }
        }
    }
}

fn is_moment_column(force: &str) -> bool {
    force.ends_with(".moment") || force.ends_with(".actuator_force")
}
