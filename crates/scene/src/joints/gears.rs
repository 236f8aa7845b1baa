//! Gears, racks and rolling wheels.

use super::pairs::axis;
use crate::diagnostics::Span;
use crate::table_reader::TableReader;
use crate::value::{NumberRule, SignRule, Value};
use dwell_geometry::{JointKind, Vec2};
use dwell_kinetostatics::PressureAngle;

pub(super) fn gear(fields: &TableReader<'_>) -> Option<JointKind> {
    let what = &fields.what;
    let internal = fields.boolean("internal");
    let given = fields.require(
        "radii",
        "add `radii = [30, 20]`: the pitch radius of each gear",
    )?;
    let rule = NumberRule::new(&fields.units().length, SignRule::Positive)
        .because("the pitch radius of a ring gear is positive, too: add `internal = true`");
    let names = ["the first", "the second"];
    let radius = |value: Value<'_>, name: String| value.quantity_with_sign(&rule, name);
    let all = format!("the radii of {what}");
    let radii = (given.value).pair_of("two radii [r1, r2]", all, names, radius);
    let (radii, internal) = (radii?, internal?);
    if internal && radii[0] == radii[1] {
        let message = format!("the ring and the gear of {what} have equal radii");
        let help = "the ring's radius is the larger one; two equal gears are external";
        let label = "the gear does not fit into the ring";
        return given.value.reject(message, label, help);
    }
    Some(JointKind::Gear { radii, internal })
}

/// The pressure angle of teeth, rad, where the scene gives one.
pub(super) fn pressure_angle(fields: &TableReader<'_>) -> Option<(f64, Span)> {
    let entry = fields.get("pressure-angle")?;
    let what = fields.name_of(entry);
    let si = entry.value.angle(&what)?;
    if si > 0.0 && si <= PressureAngle::MAX {
        return Some((si, entry.value.span()));
    }
    let message = format!("{what} is not between 0° and 45°");
    let help = "standard teeth have 20°; leave it out for teeth without a separating force";
    let unit = &fields.units().angle.name;
    entry.value.reject(message, &format!("in {unit}"), help)
}

/// The axis and the radius of a pinion or wheel that rolls along a line.
pub(super) fn on_a_line(fields: &TableReader<'_>) -> Option<(Vec2, f64)> {
    let axis = axis(fields);
    // Its sign gives the side of the line on which the wheel is.
    let rule = NumberRule::new(&fields.units().length, SignRule::NotZero)
        .because("a wheel without a radius cannot roll");
    let help = "add `radius = 20`: positive to the left of the axis, negative to its right";
    let radius = fields.number("radius", help, &rule);
    Some((axis?, radius?))
}
