//! Velocity ratios and transmission angles of written rows: a velocity over that of the only actuator, and the angle between two
//! links at their pin.

use super::difference::Differences;
use super::motion::Motion;
use super::reading::{Joint, JointKind, Place, Reading};
use super::rows::{Rows, largest};
use std::f64::consts::PI;

/// Every such column of a file.
pub(crate) fn quotient_differences(reading: &Reading, rows: &Rows, file: &str) -> Differences {
    let mut all = velocity_ratios(reading, rows, file);
    for joint in &reading.joints {
        let name = format!("{}.transmission_angle", joint.name);
        if let (Some(values), Some(ends)) = (rows.columns.get(&name), links(reading, joint)) {
            let expected = |row: usize| {
                let motion = Motion::new(reading, rows, row);
                motion.map_or(f64::NAN, |motion| angle(&motion, joint, ends))
            };
            let differences = values.iter().enumerate();
            let differences = differences.map(|(row, value)| value - expected(row));
            all.add_rows(differences, PI, "rad", |row| {
                format!("{file}, row {row}, {name}")
            });
        }
    }
    all
}

/// A velocity is its ratio times the velocity of the actuator.
fn velocity_ratios(reading: &Reading, rows: &Rows, file: &str) -> Differences {
    let mut all = Differences::default();
    let Some(driver) = reading.coordinates.first() else {
        return all;
    };
    let Some(speeds) = rows.columns.get(&format!("{}.velocity", driver.name)) else {
        return all;
    };
    for (name, ratios) in &rows.columns {
        let Some(stem) = name.strip_suffix(".velocity_ratio") else {
            continue;
        };
        let columns =
            ["angular_velocity", "velocity"].map(|end| rows.columns.get(&format!("{stem}.{end}")));
        let Some(velocities) = columns.into_iter().flatten().next() else {
            continue;
        };
        // Where a body does not turn, its velocity is compared with that of the others' rounding.
        let scale = largest(velocities).max(1e-3 * largest(speeds));
        let velocities = velocities.iter().zip(speeds);
        let pairs = ratios.iter().zip(velocities);
        let differences = pairs.map(|(ratio, (velocity, speed))| ratio * speed - velocity);
        all.add_rows(differences, scale, "", |row| {
            format!("{file}, row {row}, {name}")
        });
    }
    all
}

/// The other pins of the two links of a pin, where each has exactly one more joint, which is a pin.
fn links(reading: &Reading, pin: &Joint) -> Option<[Place; 2]> {
    let outer = |place: Place| {
        let has = |joint: &&Joint| joint.places.iter().any(|p| p.body == place.body);
        let mut others = reading
            .joints
            .iter()
            .filter(has)
            .filter(|joint| joint.name != pin.name);
        let other = others.next().filter(|_| others.next().is_none())?;
        let at = other.places.into_iter().find(|p| p.body == place.body)?;
        (other.kind == JointKind::Revolute).then_some(at)
    };
    let [one, two] = pin.places;
    Some([outer(one)?, outer(two)?])
}

/// The angle between the lines from the pin to the others, from 0 to π rad.
fn angle(motion: &Motion<'_>, pin: &Joint, ends: [Place; 2]) -> f64 {
    let line = |k: usize| {
        let [from, to] = [motion.point(pin.places[k]), motion.point(ends[k])];
        [to.x.value() - from.x.value(), to.y.value() - from.y.value()]
    };
    let [a, b] = [line(0), line(1)];
    (a[0] * b[1] - a[1] * b[0])
        .abs()
        .atan2(a[0] * b[0] + a[1] * b[1])
}
