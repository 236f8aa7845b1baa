//! Joints of things that roll on each other.

use super::pairs::{axis, two_radii};
use crate::fields::{Entry, Fields, Sign, boolean, signed};
use crate::problem::{Problem, Problems};
use crate::units::Units;
use dwell_geometry::{JointKind, Vec2};

pub(super) fn gear(
    entry: &Entry<'_>,
    fields: &Fields<'_>,
    units: &Units,
    problems: &mut Problems,
) -> Option<JointKind> {
    let what = &fields.what;
    let internal = match fields.get("internal") {
        None => Some(false),
        Some(e) => boolean(e.value, format_args!("`internal` of {what}"), problems),
    };
    let help = "add `radii = [30, 20]`: the pitch radius of each gear";
    let given = fields.need("radii", &entry.key, help, problems)?;
    let radii = two_radii(
        given,
        units,
        Sign::Positive,
        &format!("the radii of {what}"),
        "a pitch radius is above zero; a ring gear is one with `internal = true`",
        problems,
    )?;
    let internal = internal?;
    if internal && radii[0] == radii[1] {
        problems.push(
            Problem::new(format!("the ring and the gear of {what} have equal radii"))
                .at(given.value.span(), "no room for a gear inside the ring")
                .help("the ring's radius is the larger one; two equal gears are external"),
        );
        return None;
    }
    Some(JointKind::Gear { radii, internal })
}

/// The axis and the radius of what rolls on a line, as a pinion or a wheel.
pub(super) fn on_a_line(
    entry: &Entry<'_>,
    fields: &Fields<'_>,
    units: &Units,
    problems: &mut Problems,
) -> Option<(Vec2, f64)> {
    let axis = axis(entry, fields, problems);
    let radius = radius(entry, fields, units, problems);
    Some((axis?, radius?))
}

/// A radius other than zero; its sign tells on which side of the line it is.
fn radius(
    entry: &Entry<'_>,
    fields: &Fields<'_>,
    units: &Units,
    problems: &mut Problems,
) -> Option<f64> {
    let help = "add `radius = 20`: above zero to the left of the axis, below to its right";
    let radius = fields.need("radius", &entry.key, help, problems)?;
    signed(
        radius.value,
        &units.length,
        Sign::NotZero,
        format_args!("the radius of {}", fields.what),
        "what has no radius does not roll",
        problems,
    )
}
