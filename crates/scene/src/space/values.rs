//! Points and directions of three numbers.

use crate::value::Value;
use dwell_geometry::space::{Vec3, vec3};
use std::fmt::Display;

/// How a point is written.
pub(super) const POINT: &str = "three numbers [x, y, z]";

/// The three values of an array.
fn triple<'a>(value: Value<'a>, expected: &str, what: impl Display) -> Option<[Value<'a>; 3]> {
    let values = value.array(expected, &what)?;
    let count = values.len();
    if let Ok(three) = <[Value<'a>; 3]>::try_from(values) {
        return Some(three);
    }
    let message = format!("{what}: expected {expected}, found {count} of them");
    let help = match count {
        2 => {
            "most points of this scene have three numbers, which makes it one in space: all its points and directions have three"
        }
        _ => "",
    };
    value.reject(message, &format!("expected {expected}"), help)
}

fn components(
    value: Value<'_>,
    what: impl Display,
    one: impl Fn(Value<'_>, String) -> Option<f64>,
) -> Option<Vec3> {
    let values = triple(value, POINT, &what)?;
    let names = ["x", "y", "z"];
    let [x, y, z] = [0, 1, 2].map(|k| one(values[k], format!("{} of {what}", names[k])));
    Some(vec3(x?, y?, z?))
}

/// A point, m.
pub(super) fn point(value: Value<'_>, what: &str) -> Option<Vec3> {
    let unit = &value.units().length;
    components(value, what, |value, what| value.quantity(unit, what))
}

/// Three numbers without a unit.
pub(super) fn numbers(value: Value<'_>, what: impl Display) -> Option<Vec3> {
    components(value, what, |value, what| value.number(what))
}

/// Three angles, rad.
pub(super) fn angles(value: Value<'_>, what: &str) -> Option<Vec3> {
    components(value, what, |value, what| value.angle(what))
}

/// A direction, as a unit vector.
pub(super) fn direction(value: Value<'_>, what: impl Display) -> Option<Vec3> {
    let v = numbers(value, &what)?;
    // Scaled first: the largest and the smallest numbers would lose their direction in a square.
    let largest = v.x.abs().max(v.y.abs()).max(v.z.abs());
    let unit = v.scaled(1.0 / largest).unit();
    unit.filter(|u| u.is_finite()).or_else(|| {
        let message = format!("{what} has no length");
        value.reject(
            message,
            "no direction",
            "give a direction, such as [1, 0, 0]",
        )
    })
}

/// A direction in the frame of each of two bodies.
pub(super) fn two_directions(value: Value<'_>, what: &str) -> Option<[Vec3; 2]> {
    let expected = "one direction for each body [[x, y, z], [x, y, z]]";
    let names = ["the first", "the second"];
    value.pair_of(expected, what, names, |value, what| direction(value, what))
}
