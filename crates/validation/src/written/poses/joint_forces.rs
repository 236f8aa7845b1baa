//! Columns that repeat the force of a pin: its magnitude, its direction, and its components along the axes of a body.

use super::difference::Differences;
use super::motion::Motion;
use super::reading::{JointKind, Reading};
use super::rows::Rows;
use std::f64::consts::TAU;

/// Every such column of a file against the components along the axes of the ground.
pub(crate) fn joint_force_differences(reading: &Reading, rows: &Rows, file: &str) -> Differences {
    let mut all = Differences::default();
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
    all
}
