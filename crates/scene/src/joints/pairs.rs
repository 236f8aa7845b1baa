//! Prismatic joints, welds and distances, and the axis of a joint.

use crate::table_reader::TableReader;
use crate::value::{NumberRule, SignRule, Value};
use dwell_geometry::{JointKind, Vec2};

pub(super) fn prismatic(fields: &TableReader<'_>) -> Option<JointKind> {
    let what = &fields.what;
    let axes = match (fields.get("axis"), fields.get("axes")) {
        (Some(axis), None) => {
            let axis = axis.value.unit_vector(format_args!("the axis of {what}"))?;
            [axis, axis]
        }
        (None, Some(axes)) => {
            let expected = "one axis for each body [[x, y], [x, y]]";
            let names = ["the first", "the second"];
            let (what, axis) = (format!("the axes of {what}"), Value::unit_vector);
            axes.value.pair_of(expected, what, names, axis)?
        }
        (Some(a), Some(b)) => {
            let labels = ["the same axis in both bodies", "one axis for each body"];
            fields.reject_both(a, b, labels);
            return None;
        }
        (None, None) => {
            let help =
                "add `axis = [1, 0]`, in the frames of both bodies, or `axes` with one for each";
            let labels = [(&fields.key, "`axis` is missing")];
            let message = format!("{what} has no axis");
            return fields.log().reject(message, &labels, help);
        }
    };
    Some(JointKind::Prismatic { axes })
}

/// The axis of a joint that has one in its first body.
pub(super) fn axis(fields: &TableReader<'_>) -> Option<Vec2> {
    let help = "add `axis = [1, 0]`, in the frame of the first body";
    let axis = fields.require("axis", help)?;
    axis.value
        .unit_vector(format_args!("the axis of {}", fields.what))
}

pub(super) fn weld(fields: &TableReader<'_>) -> Option<JointKind> {
    let angle = match fields.get("angle") {
        None => 0.0,
        Some(e) => e.value.angle(fields.name_of(e))?,
    };
    Some(JointKind::Weld { angle })
}

pub(super) fn distance(fields: &TableReader<'_>) -> Option<JointKind> {
    let help = "add `length = 200`: the distance the two points keep";
    let rule = NumberRule::new(&fields.units().length, SignRule::Positive)
        .because("two coinciding points are a revolute joint");
    let length = fields.number("length", help, &rule)?;
    Some(JointKind::Distance { length })
}
