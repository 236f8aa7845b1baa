//! Columns that repeat the force of a pin: its magnitude, its direction, and its components along the axes of a body; and the power of a
//! joint's friction, which its force has along the written motion.

use super::difference::Differences;
use super::motion::Motion;
use super::reading::{JointKind, Reading};
use super::rows::Rows;
use std::f64::consts::TAU;

/// Every such column of a file against the components along the axes of the ground.
pub(crate) fn joint_force_differences(reading: &Reading, rows: &Rows, file: &str) -> Differences {
    let mut all = Differences::default();
    let mut frictions = slide_frictions(reading, rows);
    let pins = reading.joints.iter();
    for pin in pins.filter(|joint| joint.kind == JointKind::Revolute) {
        let name = &pin.name;
        let columns = ["x", "y"].map(|axis| rows.columns.get(&format!("{name}.{axis}")));
        let [Some(x), Some(y)] = columns else {
            continue;
        };
        let sizes: Vec<f64> = x.iter().zip(y).map(|(x, y)| x.hypot(*y)).collect();
        let scale = sizes.iter().copied().fold(0.0, f64::max);
        for (row, size) in sizes.iter().enumerate() {
            let of = |column: &str| rows.get(row, &format!("{name}.{column}"));
            let mut add = |column: &str, difference: Option<f64>| {
                let place = || format!("{file}, row {row}, {name}.{column}");
                if let Some(difference) = difference {
                    all.add(difference, scale, "N", place);
                }
            };
            add("magnitude", of("magnitude").map(|value| value - size));
            // A direction counts by the force that it turns.
            let direction = of("direction").map(|direction| {
                let turned = (direction - y[row].atan2(x[row])) / TAU;
                (turned - turned.round()) * TAU * size
            });
            add("direction", direction);
            let Some(motion) = Motion::new(reading, rows, row) else {
                continue;
            };
            let [first, second] = pin.places.map(|place| motion.bodies[place.body].angle.0[1]);
            let of = |what: &str| rows.get(row, &format!("{name}.friction.{what}"));
            if let (Some(moment), Some(power)) = (of("load_moment"), of("power")) {
                frictions.push((row, name.as_str(), moment, second - first, power));
            }
            for place in pin.places {
                let body = &reading.bodies[place.body];
                let (sin, cos) = motion.bodies[place.body].angle.value().sin_cos();
                let along = [cos * x[row] + sin * y[row], cos * y[row] - sin * x[row]];
                for (axis, expected) in ["x", "y"].into_iter().zip(along) {
                    let column = format!("{axis}@{}", body.name);
                    let difference = of(&column).map(|value| value - expected);
                    add(&column, difference);
                }
            }
        }
    }
    let largest = frictions.iter().map(|of| of.4.abs()).fold(0.0, f64::max);
    for (row, name, force, velocity, power) in frictions {
        all.add(power - force * velocity, largest, "W", || {
            format!("{file}, row {row}, {name}.friction.power")
        });
    }
    all
}

/// Of slides with friction: row, joint, the force on the second body, N, the velocity along the guide, m/s, and the power, W.
fn slide_frictions<'a>(reading: &'a Reading, rows: &Rows) -> Vec<(usize, &'a str, f64, f64, f64)> {
    let mut found = Vec::new();
    for joint in &reading.joints {
        let name = joint.name.as_str();
        let column = |what: &str| rows.columns.get(&format!("{name}.{what}"));
        let columns = ["friction.load_force", "travel.velocity", "friction.power"].map(column);
        let [Some(forces), Some(velocities), Some(powers)] = columns else {
            continue;
        };
        for (row, ((force, velocity), power)) in
            forces.iter().zip(velocities).zip(powers).enumerate()
        {
            found.push((row, name, *force, *velocity, *power));
        }
    }
    found
}
