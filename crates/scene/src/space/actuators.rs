//! The coordinates of joints: angles, travels and lengths.

use super::joints::{Joints, ParsedJoint};
use crate::coordinates::{CoordinateNotation, ParsedActuator, Parts};
use crate::diagnostics::Span;
use crate::dimensions::{Notation, Space};
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::space::{Actuator, ActuatorKind, Coordinate, JointKind, Vec3};
use dwell_geometry::{BodyId, JointId};
use toml::de::DeValue;

impl CoordinateNotation for Space {
    type Joints<'a> = Joints<'a>;
    type Actuator = Actuator;
    const COORDINATE: &'static str =
        "add `angle = \"A\"` or `travel = \"slide\"` of a joint, or `length` with two points";

    fn actuator(entry: &Entry<'_>, parts: &Parts<'_, '_, Self>) -> Option<(Actuator, Coordinate)> {
        let joints = parts.joints;
        let actuator = read_actuator(entry, joints)?;
        let joint = joints.list[actuator.kind.joint().0].joint.as_ref()?;
        let coordinate = actuator.kind.coordinate(joint);
        Some((actuator, coordinate))
    }

    fn angle_or_travel(
        entry: &Entry<'_>,
        fields: &TableReader<'_>,
        parts: &Parts<'_, '_, Self>,
    ) -> Option<Coordinate> {
        let is_angle = entry.name == "angle";
        let joint = joint_with_freedom(is_angle, entry, fields, parts.joints)?;
        Some(if is_angle {
            Coordinate::Angle(joint)
        } else {
            Coordinate::Travel(joint)
        })
    }

    fn distance(bodies: [BodyId; 2], points: [Vec3; 2]) -> Coordinate {
        Coordinate::Distance { bodies, points }
    }
}

fn read_actuator(entry: &Entry<'_>, joints: &Joints<'_>) -> Option<Actuator> {
    let fields = TableReader::open(entry, format!("actuator `{}`", shorten(entry.name)))?;
    let help = "write it as `{ angle = \"A\" }`, `{ travel = \"slide\" }` or `{ length = \"link\" }`, with the name of a joint";
    let (table, label) = (Space::table("actuator"), "no `angle`, `travel` or `length`");
    fields.reject_unknown_keys(table);
    let coordinate = fields.alternative(table, "drives nothing", label, help)?;
    if matches!(coordinate.value.get(), DeValue::Array(_)) {
        let message = format!(
            "{} names two things, and not a joint",
            fields.name_of(coordinate)
        );
        return coordinate
            .value
            .reject(message, "expected the name of a joint", help);
    }
    let kind: fn(JointId) -> ActuatorKind = match coordinate.name {
        "travel" => ActuatorKind::Travel,
        "length" => ActuatorKind::Length,
        _ => ActuatorKind::Angle,
    };
    let id = joint_with(kind, coordinate, &fields, joints)?;
    Some(Actuator {
        name: entry.name.to_owned(),
        kind: kind(id),
    })
}

/// The joint that an entry names, with an angle that has a zero, or with a travel.
pub(super) fn joint_with_freedom(
    is_angle: bool,
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    joints: &Joints<'_>,
) -> Option<JointId> {
    let kind = if is_angle {
        ActuatorKind::Angle
    } else {
        ActuatorKind::Travel
    };
    joint_with(kind, entry, fields, joints)
}

/// The joint that an entry names, with a coordinate of that kind.
fn joint_with(
    kind: fn(JointId) -> ActuatorKind,
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    joints: &Joints<'_>,
) -> Option<JointId> {
    let name = entry.value.string(fields.name_of(entry))?;
    let at = entry.value.span();
    let joint = joints.find(name, &at)?;
    require_freedom(kind(JointId(joint)), &joints.list[joint], &at)?;
    Some(JointId(joint))
}

/// Reports a joint that has no such coordinate, or whose angle has no zero.
fn require_freedom(kind: ActuatorKind, parsed: &ParsedJoint<'_>, at: &Span) -> Option<()> {
    let joint = parsed.joint.as_ref()?.kind;
    let (what, others) = match kind {
        ActuatorKind::Angle(_) => (
            "angle",
            "revolute, cylindrical and helical joints have an angle that can be driven",
        ),
        ActuatorKind::Travel(_) => (
            "travel",
            "prismatic, cylindrical, helical and point-on-line joints have a travel",
        ),
        ActuatorKind::Length(_) => ("length", "a `distance` has a length that can be driven"),
    };
    let name = shorten(parsed.name);
    if !kind.is_of(joint) {
        let message = format!("joint `{name}` has no {what} to be driven");
        return (parsed.log).reject(message, &[(at, "this joint")], others);
    }
    let is_angle = matches!(kind, ActuatorKind::Angle(_));
    if is_angle && !parsed.has_zero {
        let message = format!("the angle of joint `{name}` has no zero");
        let labels = [
            (at, "driven here"),
            (&parsed.key, "with `axes`, but without `normals`"),
        ];
        let help = "add `normals` to the joint: a direction across the axis in the frame of each body, parallel at zero";
        return (parsed.log).reject(message, &labels, help);
    }
    if let JointKind::Distance { length } = joint
        && length > 0.0
    {
        let message = format!("the length of joint `{name}` is driven and given");
        let labels = [(at, "driven here"), (&parsed.key, "with a `length`")];
        return (parsed.log).reject(message, &labels, "leave `length` out of the joint");
    }
    Some(())
}

/// Reports distances whose length neither a number nor an actuator gives.
pub(super) fn require_lengths(joints: &Joints<'_>, actuators: &[ParsedActuator<'_, Space>]) {
    for (j, parsed) in joints.list.iter().enumerate() {
        let kind = parsed.joint.as_ref().map(|joint| joint.kind);
        let driven = ActuatorKind::Length(JointId(j));
        let is_driven =
            |a: &ParsedActuator<'_, Space>| a.actuator.as_ref().is_none_or(|a| a.kind == driven);
        if kind == Some(JointKind::Distance { length: 0.0 }) && !actuators.iter().any(is_driven) {
            let message = format!("joint `{}` has no length", shorten(parsed.name));
            let help = "add `length = 200`: the distance the two points keep; or drive it: `[actuators]` with `{ length = \"…\" }`";
            parsed
                .log
                .reject::<()>(message, &[(&parsed.key, "`length` is missing")], help);
        }
    }
}
