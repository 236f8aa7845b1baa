//! Prismatic joints, slots, welds and distances.

use crate::diagnostics::{Diagnostic, Diagnostics};
use crate::table_reader::{
    Entry, SignRule, TableReader, angle, pair, quantity_with_sign, unit_vector,
};
use crate::units::Units;
use dwell_geometry::{JointKind, Vec2};

pub(super) fn prismatic(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<JointKind> {
    let what = &fields.what;
    let axes = match (fields.get("axis"), fields.get("axes")) {
        (Some(axis), None) => {
            let axis = unit_vector(axis.value, &format!("the axis of {what}"), diagnostics)?;
            [axis, axis]
        }
        (None, Some(axes)) => {
            let what = format!("the axes of {what}");
            let expected = "one axis for each body [[x, y], [x, y]]";
            let [a, b] = pair(axes.value, expected, format_args!("{what}"), diagnostics)?;
            let a = unit_vector(a, &format!("the first of {what}"), diagnostics);
            let b = unit_vector(b, &format!("the second of {what}"), diagnostics);
            [a?, b?]
        }
        (Some(a), Some(b)) => {
            diagnostics.push(
                Diagnostic::new(format!("{what} has both `axis` and `axes`"))
                    .label(a.key.clone(), "the same axis in both bodies")
                    .label(b.key.clone(), "one axis for each body")
                    .help("keep one of them"),
            );
            return None;
        }
        (None, None) => {
            diagnostics.push(
                Diagnostic::new(format!("{what} has no axis"))
                    .label(entry.key.clone(), "`axis` is missing")
                    .help("add `axis = [1, 0]`, in the frames of both bodies, or `axes` with one for each"),
            );
            return None;
        }
    };
    Some(JointKind::Prismatic { axes })
}

pub(super) fn slot(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<JointKind> {
    let axis = axis(entry, fields, diagnostics)?;
    Some(JointKind::Slot { axis })
}

/// The axis of a joint that has one in its first body.
pub(super) fn axis(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    diagnostics: &mut Diagnostics,
) -> Option<Vec2> {
    let help = "add `axis = [1, 0]`, in the frame of the first body";
    let axis = fields.require("axis", &entry.key, help, diagnostics)?;
    let what = format!("the axis of {}", fields.what);
    unit_vector(axis.value, &what, diagnostics)
}

pub(super) fn weld(
    fields: &TableReader<'_>,
    units: &Units,
    diagnostics: &mut Diagnostics,
) -> Option<JointKind> {
    let angle = match fields.get("angle") {
        None => 0.0,
        Some(e) => {
            let what = format_args!("the angle of {}", fields.what);
            angle(e.value, &units.angle, what, diagnostics)?
        }
    };
    Some(JointKind::Weld { angle })
}

pub(super) fn distance(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    units: &Units,
    diagnostics: &mut Diagnostics,
) -> Option<JointKind> {
    let what = &fields.what;
    let help = "add `length = 200`: the distance the two points keep";
    let length = fields.require("length", &entry.key, help, diagnostics)?;
    let length = quantity_with_sign(
        length.value,
        &units.length,
        SignRule::Positive,
        format_args!("the length of {what}"),
        "two coinciding points are a revolute joint",
        diagnostics,
    )?;
    Some(JointKind::Distance { length })
}

/// Two radii.
pub(super) fn two_radii(
    entry: &Entry<'_>,
    units: &Units,
    sign: SignRule,
    what: &str,
    why: &str,
    diagnostics: &mut Diagnostics,
) -> Option<[f64; 2]> {
    let [a, b] = pair(
        entry.value,
        "two radii [r1, r2]",
        format_args!("{what}"),
        diagnostics,
    )?;
    let mut one = |value, which: &str| {
        let what = format_args!("the {which} of {what}");
        quantity_with_sign(value, &units.length, sign, what, why, diagnostics)
    };
    let (a, b) = (one(a, "first"), one(b, "second"));
    Some([a?, b?])
}
