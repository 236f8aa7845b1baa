//! Gears, racks and rolling wheels.

use super::pairs::{axis, two_radii};
use crate::diagnostics::{Diagnostic, Diagnostics, Span};
use crate::table_reader::{Entry, SignRule, TableReader, angle, boolean, quantity_with_sign};
use crate::units::Units;
use dwell_geometry::{JointKind, Vec2};
use dwell_kinetostatics::PressureAngle;

pub(super) fn gear(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    units: &Units,
    diagnostics: &mut Diagnostics,
) -> Option<JointKind> {
    let what = &fields.what;
    let internal = match fields.get("internal") {
        None => Some(false),
        Some(e) => boolean(e.value, format_args!("`internal` of {what}"), diagnostics),
    };
    let help = "add `radii = [30, 20]`: the pitch radius of each gear";
    let given = fields.require("radii", &entry.key, help, diagnostics)?;
    let radii = two_radii(
        given,
        units,
        SignRule::Positive,
        &format!("the radii of {what}"),
        "a pitch radius is above zero; a ring gear is one with `internal = true`",
        diagnostics,
    )?;
    let internal = internal?;
    if internal && radii[0] == radii[1] {
        diagnostics.push(
            Diagnostic::new(format!("the ring and the gear of {what} have equal radii"))
                .label(given.value.span(), "the gear does not fit into the ring")
                .help("the ring's radius is the larger one; two equal gears are external"),
        );
        return None;
    }
    Some(JointKind::Gear { radii, internal })
}

/// The pressure angle of teeth, rad, where the scene gives one.
pub(super) fn pressure_angle(
    fields: &TableReader<'_>,
    units: &Units,
    diagnostics: &mut Diagnostics,
) -> Option<(f64, Span)> {
    let entry = fields.get("pressure-angle")?;
    let what = format!("the pressure angle of {}", fields.what);
    let si = angle(
        entry.value,
        &units.angle,
        format_args!("{what}"),
        diagnostics,
    )?;
    if si > 0.0 && si <= PressureAngle::MAX {
        return Some((si, entry.value.span()));
    }
    diagnostics.push(
        Diagnostic::new(format!("{what} is not between 0° and 45°"))
            .label(entry.value.span(), format!("in {}", units.angle.name))
            .help("standard teeth have 20°; leave it out for teeth without a separating force"),
    );
    None
}

/// The axis and the radius of a pinion or wheel that rolls along a line.
pub(super) fn on_a_line(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    units: &Units,
    diagnostics: &mut Diagnostics,
) -> Option<(Vec2, f64)> {
    let axis = axis(entry, fields, diagnostics);
    let radius = radius(entry, fields, units, diagnostics);
    Some((axis?, radius?))
}

/// A radius other than zero; its sign tells on which side of the line it is.
fn radius(
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    units: &Units,
    diagnostics: &mut Diagnostics,
) -> Option<f64> {
    let help = "add `radius = 20`: above zero to the left of the axis, below to its right";
    let radius = fields.require("radius", &entry.key, help, diagnostics)?;
    quantity_with_sign(
        radius.value,
        &units.length,
        SignRule::NotZero,
        format_args!("the radius of {}", fields.what),
        "a wheel without a radius cannot roll",
        diagnostics,
    )
}
