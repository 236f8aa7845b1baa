//! Every row of a file meets the constraint equations of the scene's text: values, velocities and accelerations of joints,
//! points, coordinates, and laws of motion.

use super::difference::Differences;
use super::jet::Jet;
use super::motion::{Motion, point_in};
use super::reading::{Joint, JointKind, Reading};
use super::rows::Rows;
use std::f64::consts::TAU;

/// What should be zero, with its derivatives, and what it is relative to: 1 of an angle, the size of a length.
struct Residual {
    what: String,
    jet: Jet,
    is_angle: bool,
}

/// The largest distances of points and rates of bodies, which residuals are relative to.
struct Scale {
    size: f64,
    /// Of angles: value, velocity, acceleration.
    angular: [f64; 3],
}

/// Differences of joints and coordinates of all rows, and those of laws.
#[derive(Debug, Default)]
pub(crate) struct Closure {
    pub(crate) joints: Differences,
    pub(crate) laws: Differences,
}

/// The closure of a file. The rows of a sweep have no time; rates are those of the file.
pub(crate) fn closure(reading: &Reading, rows: &Rows, file: &str) -> Closure {
    let mut closure = Closure::default();
    let motions: Option<Vec<Motion>> = (0..rows.count)
        .map(|row| Motion::new(reading, rows, row))
        .collect();
    let Some(motions) = motions.filter(|motions| !motions.is_empty()) else {
        closure
            .joints
            .fail(format!("{file}: a column of a body is missing"));
        return closure;
    };
    let scale = scale(reading, &motions);
    for (row, motion) in motions.iter().enumerate() {
        for residual in residuals(reading, rows, row, motion, &motions[0]) {
            add(&mut closure.joints, &residual, &scale, file, row);
        }
        for residual in law_residuals(reading, rows, row, motion) {
            add(&mut closure.laws, &residual, &scale, file, row);
        }
    }
    closure
}

fn add(to: &mut Differences, residual: &Residual, scale: &Scale, file: &str, row: usize) {
    for (order, rate) in ["", ", its velocity", ", its acceleration"]
        .iter()
        .enumerate()
    {
        let factor = if residual.is_angle { 1.0 } else { scale.size };
        let size = factor * scale.angular[order];
        let unit = if residual.is_angle { "rad" } else { "m" };
        to.add(residual.jet.0[order], size, unit, || {
            format!("{file}, row {row}, {}{rate}", residual.what)
        });
    }
}

fn scale(reading: &Reading, motions: &[Motion]) -> Scale {
    let (mut size, mut angular) = (0.0_f64, [1.0, 0.0, 0.0_f64]);
    for motion in motions {
        for (b, body) in reading.bodies.iter().enumerate() {
            for (_, point) in &body.points {
                let p = motion.point(super::reading::Place {
                    body: b,
                    point: *point,
                });
                size = size.max(p.x.value().hypot(p.y.value()));
            }
        }
    }
    for motion in motions {
        for frame in &motion.bodies {
            let rates = |k: usize| {
                let [x, y] = frame.origin.order(k);
                (x.hypot(y) / size).max(frame.angle.0[k].abs())
            };
            angular[1] = angular[1].max(rates(1));
            angular[2] = angular[2].max(rates(2)).max(rates(1).powi(2));
        }
    }
    // Angles of many revolutions are rounded as such.
    let largest = motions
        .iter()
        .flat_map(|m| &m.bodies)
        .map(|f| f.angle.value().abs());
    angular[0] = largest.fold(1.0, f64::max);
    Scale { size, angular }
}

fn residuals(
    reading: &Reading,
    rows: &Rows,
    row: usize,
    motion: &Motion,
    first: &Motion,
) -> Vec<Residual> {
    let mut all = Vec::new();
    let mut add = |what: String, jet: Jet, is_angle: bool| {
        all.push(Residual {
            what,
            jet,
            is_angle,
        });
    };
    for (b, body) in reading
        .bodies
        .iter()
        .enumerate()
        .filter(|(_, body)| !body.is_ground)
    {
        for (name, point) in &body.points {
            if let Some(written) = point_in(rows, row, &body.name, name) {
                let open = written.minus(motion.point(super::reading::Place {
                    body: b,
                    point: *point,
                }));
                add(format!("{}.{name}.x", body.name), open.x, false);
                add(format!("{}.{name}.y", body.name), open.y, false);
            }
        }
    }
    for joint in &reading.joints {
        for (jet, is_angle) in joint_residuals(joint, motion, first) {
            add(format!("joint {}", joint.name), jet, is_angle);
        }
    }
    for coordinate in &reading.coordinates {
        let ends = ["", ".velocity", ".acceleration"];
        if let Some(written) = rows.jet(row, &coordinate.name, ends) {
            let is_angle = reading.unit_of(coordinate.measure) == reading.units.angle
                && matches!(coordinate.measure, super::reading::Measure::Angle(_));
            let open = written - motion.measure(coordinate.measure);
            let open = if is_angle {
                without_revolutions(open, TAU)
            } else {
                open
            };
            // A file of statics has no velocities, and its bodies rest.
            add(format!("coordinate {}", coordinate.name), open, is_angle);
        }
    }
    all
}

fn law_residuals(reading: &Reading, rows: &Rows, row: usize, motion: &Motion) -> Vec<Residual> {
    let mut all = Vec::new();
    for (coordinate, law) in reading.coordinates.iter().zip(&reading.laws) {
        let written = rows.jet(row, &coordinate.name, ["", ".velocity", ".acceleration"]);
        let (Some(law), Some(written), Some(t)) = (law, written, rows.get(row, "t")) else {
            continue;
        };
        let at_corner = law
            .corners()
            .iter()
            .any(|corner| (corner - t).abs() <= 1e-12 * (1.0 + t.abs()));
        let names = |name: &str| (name == "t").then_some(Jet([t, 1.0, 0.0]));
        let Some(expected) = law.at(Jet([t, 1.0, 0.0]), &names) else {
            continue;
        };
        let mut open = written - expected;
        // On a corner of the law the second derivative has two values.
        if at_corner {
            open.0[2] = 0.0;
        }
        let is_angle = matches!(coordinate.measure, super::reading::Measure::Angle(_));
        all.push(Residual {
            what: format!("law of {}", coordinate.name),
            jet: open,
            is_angle,
        });
    }
    let _ = motion;
    all
}

fn without_revolutions(jet: Jet, revolution: f64) -> Jet {
    jet - Jet::constant(revolution * (jet.value() / revolution).round())
}

/// What a joint keeps at zero, and whether it is an angle. Meshing and rolling keep what they have in the first row.
// Long: an arm for each kind of joint.
fn joint_residuals(joint: &Joint, motion: &Motion, first: &Motion) -> Vec<(Jet, bool)> {
    let places = joint.places;
    let bodies = places.map(|p| p.body);
    let gap = motion.gap(places);
    let along = |axis: [f64; 2]| motion.direction(bodies[0], axis);
    let kept = |of: &dyn Fn(&Motion) -> Jet, revolution: f64| {
        let change = of(motion) - Jet::constant(of(first).value());
        if revolution == 0.0 {
            change
        } else {
            without_revolutions(change, revolution)
        }
    };
    match &joint.kind {
        JointKind::Revolute => vec![(gap.x, false), (gap.y, false)],
        JointKind::Prismatic { axes } => {
            let across = along(axes[0]).cross(motion.direction(bodies[1], axes[1]));
            vec![(along(axes[0]).normal().dot(gap), false), (across, true)]
        }
        JointKind::Slot { axis } => vec![(along(*axis).normal().dot(gap), false)],
        JointKind::Weld { angle } => {
            let open = motion.relative_angle(bodies) - Jet::constant(*angle);
            vec![
                (gap.x, false),
                (gap.y, false),
                (without_revolutions(open, TAU), true),
            ]
        }
        JointKind::Gear {
            radii: [r, s],
            is_internal,
            ..
        } => {
            let s = if *is_internal { -s } else { *s };
            let rolled = |m: &Motion| {
                let line = m.gap(places);
                let line = line.y.atan2(line.x);
                let [a, b] = bodies.map(|b| m.bodies[b].angle - line);
                Jet::constant(*r) * a + Jet::constant(s) * b
            };
            vec![(kept(&rolled, (r + s).abs() * TAU), false)]
        }
        JointKind::Rack { axis, radius, .. } | JointKind::Rolling { axis, radius } => {
            let rolled = |m: &Motion| {
                let travel = m.gap(places).dot(m.direction(bodies[0], *axis));
                travel + Jet::constant(*radius) * m.relative_angle(bodies)
            };
            let mut all = vec![(kept(&rolled, 0.0), false)];
            if matches!(joint.kind, JointKind::Rolling { .. }) {
                let height = along(*axis).normal().dot(gap) - Jet::constant(*radius);
                all.push((height, false));
            }
            all
        }
        JointKind::Distance { length } => vec![(gap.length() - Jet::constant(*length), false)],
        JointKind::Coupling {
            dependent,
            independent,
            law,
        } => {
            let of = |m: super::reading::Measure| motion.measure(m);
            let value = law.at(of(*independent), &|_| None);
            let is_angle = matches!(dependent, super::reading::Measure::Angle(_));
            value
                .map(|value| (of(*dependent) - value, is_angle))
                .into_iter()
                .collect()
        }
    }
}
