//! The kinds of joints between two links: what they let move.

use crate::fields::{Entry, Fields, Sign, angle, pair, signed, unit_vector};
use crate::problem::{Problem, Problems};
use crate::units::Units;
use dwell_geometry::{JointKind, Vec2};

pub(super) fn prismatic(
    entry: &Entry<'_>,
    fields: &Fields<'_>,
    problems: &mut Problems,
) -> Option<JointKind> {
    let what = &fields.what;
    let axes = match (fields.get("axis"), fields.get("axes")) {
        (Some(axis), None) => {
            let axis = unit_vector(axis.value, &format!("the axis of {what}"), problems)?;
            [axis, axis]
        }
        (None, Some(axes)) => {
            let what = format!("the axes of {what}");
            let expected = "one axis for each body [[x, y], [x, y]]";
            let [a, b] = pair(axes.value, expected, format_args!("{what}"), problems)?;
            let a = unit_vector(a, &format!("the first of {what}"), problems);
            let b = unit_vector(b, &format!("the second of {what}"), problems);
            [a?, b?]
        }
        (Some(a), Some(b)) => {
            problems.push(
                Problem::new(format!("{what} has both `axis` and `axes`"))
                    .at(a.key.clone(), "the same axis in both bodies")
                    .at(b.key.clone(), "one axis for each body")
                    .help("keep one of them"),
            );
            return None;
        }
        (None, None) => {
            problems.push(
                Problem::new(format!("{what} has no axis"))
                    .at(entry.key.clone(), "slides along which direction?")
                    .help("add `axis = [1, 0]`, in the frames of both bodies, or `axes` with one for each"),
            );
            return None;
        }
    };
    Some(JointKind::Prismatic { axes })
}

pub(super) fn slot(
    entry: &Entry<'_>,
    fields: &Fields<'_>,
    problems: &mut Problems,
) -> Option<JointKind> {
    let axis = axis(entry, fields, problems)?;
    Some(JointKind::Slot { axis })
}

/// The axis of a joint that has one in its first body.
pub(super) fn axis(
    entry: &Entry<'_>,
    fields: &Fields<'_>,
    problems: &mut Problems,
) -> Option<Vec2> {
    let help = "add `axis = [1, 0]`, in the frame of the first body";
    let axis = fields.need("axis", &entry.key, help, problems)?;
    let what = format!("the axis of {}", fields.what);
    unit_vector(axis.value, &what, problems)
}

pub(super) fn weld(
    fields: &Fields<'_>,
    units: &Units,
    problems: &mut Problems,
) -> Option<JointKind> {
    let angle = match fields.get("angle") {
        None => 0.0,
        Some(e) => {
            let what = format_args!("the angle of {}", fields.what);
            angle(e.value, &units.angle, what, problems)?
        }
    };
    Some(JointKind::Weld { angle })
}

pub(super) fn distance(
    entry: &Entry<'_>,
    fields: &Fields<'_>,
    units: &Units,
    problems: &mut Problems,
) -> Option<JointKind> {
    let what = &fields.what;
    let help = "add `length = 200`: the distance the two points keep";
    let length = fields.need("length", &entry.key, help, problems)?;
    let length = signed(
        length.value,
        &units.length,
        Sign::Positive,
        format_args!("the length of {what}"),
        "two points at no distance are a revolute joint",
        problems,
    )?;
    Some(JointKind::Distance { length })
}

/// Two radii.
pub(super) fn two_radii(
    entry: &Entry<'_>,
    units: &Units,
    sign: Sign,
    what: &str,
    why: &str,
    problems: &mut Problems,
) -> Option<[f64; 2]> {
    let [a, b] = pair(
        entry.value,
        "two radii [r1, r2]",
        format_args!("{what}"),
        problems,
    )?;
    let mut one = |value, which: &str| {
        let what = format_args!("the {which} of {what}");
        signed(value, &units.length, sign, what, why, problems)
    };
    let (a, b) = (one(a, "first"), one(b, "second"));
    Some([a?, b?])
}
