//! Every row of a file meets the constraint equations of the scene's text: values, velocities and accelerations of joints,
//! points, coordinates, and laws of motion.

use super::difference::Differences;
use super::jet::Jet;
use super::motion::{Motion, point_in};
use super::reading::{Joint, JointKind, Place, Reading};
use super::rows::{Rows, largest};
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
    let motions = Motion::of_all(reading, rows);
    let Some(motions) = motions.filter(|motions| !motions.is_empty()) else {
        let reason = format!("{file}: a column of a body is missing");
        closure.joints.fail(reason);
        return closure;
    };
    let scale = scale(reading, &motions);
    for (row, motion) in motions.iter().enumerate() {
        for residual in residuals(motion, &motions[0]) {
            add(&mut closure.joints, &residual, &scale, file, row);
        }
        for residual in law_residuals(motion) {
            add(&mut closure.laws, &residual, &scale, file, row);
        }
    }
    closure
}

fn add(to: &mut Differences, residual: &Residual, scale: &Scale, file: &str, row: usize) {
    let (factor, unit) = match residual.is_angle {
        true => (1.0, "rad"),
        false => (scale.size, "m"),
    };
    let rates = ["", ", its velocity", ", its acceleration"];
    for (order, rate) in rates.into_iter().enumerate() {
        let size = factor * scale.angular[order];
        to.add(residual.jet.0[order], size, unit, || {
            format!("{file}, row {row}, {}{rate}", residual.what)
        });
    }
}

fn scale(reading: &Reading, motions: &[Motion<'_>]) -> Scale {
    let (mut size, mut angular) = (0.0_f64, [1.0, 0.0, 0.0_f64]);
    for motion in motions {
        for (body, of) in reading.bodies.iter().enumerate() {
            for (_, point) in &of.points {
                let [x, y] = motion
                    .point(Place {
                        body,
                        point: *point,
                    })
                    .order(0);
                size = size.max(x.hypot(y));
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
    let frames = motions.iter().flat_map(|m| &m.bodies);
    angular[0] = largest(frames.map(|frame| &frame.angle.0[0])).max(1.0);
    Scale { size, angular }
}

fn residuals(motion: &Motion<'_>, first: &Motion<'_>) -> Vec<Residual> {
    let reading = motion.reading;
    let mut all = Vec::new();
    let mut add = |what: String, jet: Jet, is_angle: bool| {
        all.push(Residual {
            what,
            jet,
            is_angle,
        });
    };
    let bodies = reading.bodies.iter().enumerate();
    for (body, of) in bodies.filter(|(_, body)| !body.is_ground) {
        for (name, point) in &of.points {
            if let Some(written) = point_in(motion.rows, motion.row, &of.name, name) {
                let open = written.minus(motion.point(Place {
                    body,
                    point: *point,
                }));
                add(format!("{}.{name}.x", of.name), open.x, false);
                add(format!("{}.{name}.y", of.name), open.y, false);
            }
        }
    }
    for joint in &reading.joints {
        for (jet, is_angle) in joint_residuals(joint, motion, first) {
            add(format!("joint {}", joint.name), jet, is_angle);
        }
    }
    for coordinate in &reading.coordinates {
        if let Some(written) = written(motion, &coordinate.name) {
            let is_angle = coordinate.measure.is_angle();
            let open = written - motion.measure(coordinate.measure);
            let open = match is_angle {
                true => without_revolutions(open, TAU),
                false => open,
            };
            // A file of statics has no velocities, and its bodies rest.
            add(format!("coordinate {}", coordinate.name), open, is_angle);
        }
    }
    all
}

/// A coordinate as written.
fn written(motion: &Motion<'_>, name: &str) -> Option<Jet> {
    let ends = ["", ".velocity", ".acceleration"];
    motion.rows.jet(motion.row, name, ends)
}

fn law_residuals(motion: &Motion<'_>) -> Vec<Residual> {
    let mut all = Vec::new();
    let reading = motion.reading;
    for (coordinate, law) in reading.coordinates.iter().zip(&reading.laws) {
        let written = written(motion, &coordinate.name);
        let (Some(law), Some(written), Some(t)) = (law, written, motion.get("t")) else {
            continue;
        };
        let is_near = |corner: &f64| (corner - t).abs() <= 1e-12 * (1.0 + t.abs());
        let at_corner = law.corners().iter().any(is_near);
        let names = |name: &str| (name == "t").then_some(Jet([t, 1.0, 0.0]));
        let Some(expected) = law.at(Jet([t, 1.0, 0.0]), &names) else {
            continue;
        };
        let mut open = written - expected;
        // On a corner of the law the second derivative has two values.
        if at_corner {
            open.0[2] = 0.0;
        }
        all.push(Residual {
            what: format!("law of {}", coordinate.name),
            jet: open,
            is_angle: coordinate.measure.is_angle(),
        });
    }
    all
}

fn without_revolutions(jet: Jet, revolution: f64) -> Jet {
    jet - Jet::constant(revolution * (jet.value() / revolution).round())
}

/// What a joint keeps at zero, and whether it is an angle. Meshing and rolling keep what they have in the first row.
// Long: an arm for each kind of joint.
fn joint_residuals(joint: &Joint, motion: &Motion<'_>, first: &Motion<'_>) -> Vec<(Jet, bool)> {
    let places = joint.places;
    let bodies = places.map(|p| p.body);
    let gap = motion.gap(places);
    let along = |axis: [f64; 2]| motion.direction(bodies[0], axis);
    let kept = |of: &dyn Fn(&Motion<'_>) -> Jet| of(motion) - Jet::constant(of(first).value());
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
        } => {
            let s = if *is_internal { -s } else { *s };
            let rolled = |m: &Motion<'_>| {
                let line = m.gap(places);
                let line = line.y.atan2(line.x);
                let [a, b] = bodies.map(|b| m.bodies[b].angle - line);
                Jet::constant(*r) * a + Jet::constant(s) * b
            };
            let open = without_revolutions(kept(&rolled), (r + s).abs() * TAU);
            vec![(open, false)]
        }
        JointKind::Rack { axis, radius } | JointKind::Rolling { axis, radius } => {
            let rolled = |m: &Motion<'_>| {
                let travel = m.gap(places).dot(m.direction(bodies[0], *axis));
                travel + Jet::constant(*radius) * m.relative_angle(bodies)
            };
            let mut all = vec![(kept(&rolled), false)];
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
            let value = law.at(motion.measure(*independent), &|_| None);
            let open = |value: Jet| (motion.measure(*dependent) - value, dependent.is_angle());
            value.map(open).into_iter().collect()
        }
    }
}
