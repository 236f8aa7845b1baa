//! Masses and tensors of inertia.

use super::values::{direction, point};
use crate::dimensions::{Notation, Space};
use crate::table_reader::{Entry, TableReader};
use crate::value::Value;
use crate::wording::short;
use dwell_geometry::space::{Rotation, Vec3};
use dwell_kinetostatics::space::Mass;

/// Axes of inertia at right angles to within this, rad.
const SQUARE: f64 = 1e-6;

/// How much the largest principal moment may exceed the sum of the others, as a part of the sum of all: the rounding of decimals.
const EXCESS: f64 = 1e-9;

impl Notation for Space {
    const SUFFIX: &'static str = "-in-space";
    const POINT: &'static str = "[x, y, z]";
    const ORIGIN: &'static str = "[0, 0, 0]";

    fn point(value: Value<'_>, what: &str) -> Option<Vec3> {
        point(value, what)
    }

    fn mass(mass: f64, center: Vec3, fields: &TableReader<'_>) -> Mass {
        let inertia = fields.get("inertia").and_then(|e| tensor(e, fields));
        let mut found = Mass {
            mass,
            center,
            inertia: inertia.unwrap_or_default(),
        };
        let turned = fields.get("inertia-axes").and_then(|e| axes(e, fields));
        if let (Some(entry), None) = (fields.get("inertia-axes"), fields.get("inertia")) {
            let message = format!(
                "inertia-axes of {} have no inertia to refer to",
                fields.what
            );
            let help = "add `inertia = [10.0, 1666.0, 1666.0]`, or leave the axes out";
            (entry.value).reject::<()>(message, "of no inertia", help);
        }
        if let Some(axes) = turned {
            found.inertia = found.turned(&axes).inertia;
        }
        match fields.get("inertia") {
            Some(entry) if !found.is_valid() => {
                let message = format!("no body has the inertia of {}", fields.what);
                let help = "moments of inertia are not negative, and products of inertia not above what they allow";
                (entry.value).reject::<()>(message, "not a tensor of inertia", help);
            }
            Some(entry) => warn_of_excess(entry, &found, fields),
            None => {}
        }
        found
    }
}

/// Warns of a tensor that no distribution of mass has. The tensor is used unchanged: some published mechanisms have such tensors, and
/// the equations of motion are still valid.
fn warn_of_excess(entry: &Entry<'_>, mass: &Mass, fields: &TableReader<'_>) {
    let [one, two, three] = mass.principal_moments();
    if mass.excess_moment() <= EXCESS * (one + two + three) {
        return;
    }
    let [one, two, three] = [one, two, three].map(short);
    let message = format!(
        "no distribution of mass has the inertia of {}: its largest principal moment, {three} kg m², exceeds the sum of the others, {one} and \
         {two} kg m²; it is used as it is. Are the moments about the centre of mass, and the products of inertia −∫ x y dm?",
        fields.what
    );
    let label = "exceeds the triangle inequality";
    fields.log().warn(message, label, entry.value.span());
}

/// Three moments or all six elements, kg m².
fn tensor(entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<[f64; 6]> {
    let what = fields.name_of(entry);
    let expected = "three or six numbers [I_xx, I_yy, I_zz, I_xy, I_xz, I_yz]";
    let values = entry.value.array(expected, &what)?;
    if !matches!(values.len(), 3 | 6) {
        let message = format!(
            "{what}: expected {expected}, found {} of them",
            values.len()
        );
        return entry
            .value
            .reject(message, "expected three or six numbers", "");
    }
    let mut found = [0.0; 6];
    let names = ["I_xx", "I_yy", "I_zz", "I_xy", "I_xz", "I_yz"];
    for ((to, value), name) in found.iter_mut().zip(values).zip(names) {
        *to = value.quantity(&fields.units().inertia, format!("{name} of {what}"))?;
    }
    Some(found)
}

/// The frame to which the moments refer.
fn axes(entry: &Entry<'_>, fields: &TableReader<'_>) -> Option<Rotation> {
    let what = fields.name_of(entry);
    let expected = "two directions [[x, y, z], [x, y, z]]";
    let names = ["x", "y"];
    let one = |value: Value<'_>, what: String| direction(value, what);
    let [x, y] = entry.value.pair_of(expected, &what, names, one)?;
    if x.dot(y).abs() > SQUARE {
        let message = format!("{what} are not at right angles");
        return entry.value.reject(
            message,
            "not at right angles",
            "give the directions x and y of one frame",
        );
    }
    Some(Rotation::of_axes(x.cross(y), x))
}
