//! The independent coordinates: angles and travels of joints.

use super::bodies::Space;
use super::joints::{Joints, ParsedJoint};
use crate::bodies::Bodies;
use crate::coordinates::{NamedActuator, ParsedActuator as AnyActuator, check_coordinate_name};
use crate::diagnostics::Span;
use crate::keys::table;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::space::{Actuator, ActuatorKind, JointKind};
use dwell_geometry::{ActuatorId, JointId};
use toml::de::DeValue;

/// An actuator as read; nothing in it if it was wrong.
pub(super) type ParsedActuator<'a> = AnyActuator<'a, Actuator>;

pub(super) fn actuators<'a>(
    fields: &TableReader<'a>,
    bodies: &Bodies<'_, Space>,
    joints: &Joints<'_>,
) -> Vec<ParsedActuator<'a>> {
    let mut found: Vec<ParsedActuator<'a>> = Vec::new();
    for (k, entry) in fields.entries.iter().enumerate() {
        check_coordinate_name(entry, "an actuator");
        entry
            .log()
            .place(SceneLocation::Actuator(ActuatorId(k)), &entry.key);
        if bodies.position(entry.name).is_some() {
            let message = format!(
                "`{}` is the name of a body and of an actuator",
                shorten(entry.name)
            );
            entry.reject::<()>(
                message,
                "and of an actuator",
                "rename one: both are keys of [assembly]",
            );
        }
        let actuator = read_actuator(entry, joints);
        let kind = actuator.as_ref().map(|a| a.kind);
        let is_angle = !matches!(kind, Some(ActuatorKind::Travel(_)));
        found.push(ParsedActuator {
            named: NamedActuator::new(entry, is_angle, false),
            actuator,
        });
    }
    found
}

fn read_actuator(entry: &Entry<'_>, joints: &Joints<'_>) -> Option<Actuator> {
    let fields = TableReader::open(entry, format!("actuator `{}`", shorten(entry.name)))?;
    let help =
        "write it as `{ angle = \"A\" }` or `{ travel = \"slide\" }`, with the name of a joint";
    fields.reject_unknown_keys(table("actuator-in-space"));
    let lacks = ("drives nothing", "neither `angle` nor `travel`");
    let coordinate = fields.alternative(table("actuator-in-space"), lacks, help)?;
    if matches!(coordinate.value.get(), DeValue::Array(_)) {
        let message = format!(
            "{} names two things, and not a joint",
            fields.name_of(coordinate)
        );
        return coordinate
            .value
            .reject(message, "expected the name of a joint", help);
    }
    let is_angle = coordinate.name == "angle";
    let id = joint_with_freedom(is_angle, coordinate, &fields, joints)?;
    let kind = match is_angle {
        true => ActuatorKind::Angle(id),
        false => ActuatorKind::Travel(id),
    };
    Some(Actuator {
        name: entry.name.to_owned(),
        kind,
    })
}

/// The joint that an entry names, with an angle that has a zero, or with a travel.
pub(super) fn joint_with_freedom(
    is_angle: bool,
    entry: &Entry<'_>,
    fields: &TableReader<'_>,
    joints: &Joints<'_>,
) -> Option<JointId> {
    let name = entry.value.string(fields.name_of(entry))?;
    let at = entry.value.span();
    let joint = joints.find(name, &at)?;
    require_freedom(is_angle, &joints.list[joint], &at)?;
    Some(JointId(joint))
}

/// Reports a joint that has no such coordinate, or whose angle has no zero.
fn require_freedom(is_angle: bool, parsed: &ParsedJoint<'_>, at: &Span) -> Option<()> {
    let kind = parsed.joint.as_ref()?.kind;
    let (what, drives, others) = match is_angle {
        true => (
            "angle",
            matches!(
                kind,
                JointKind::Revolute | JointKind::Cylindrical | JointKind::Helical { .. }
            ),
            "revolute, cylindrical and helical joints have an angle that can be driven",
        ),
        false => (
            "travel",
            matches!(kind, JointKind::Prismatic | JointKind::Cylindrical),
            "prismatic and cylindrical joints have a travel",
        ),
    };
    let name = shorten(parsed.name);
    if !drives {
        let message = format!("joint `{name}` has no {what} to be driven");
        return (parsed.log).reject(message, &[(at, "this joint")], others);
    }
    if is_angle && !parsed.has_zero {
        let message = format!("the angle of joint `{name}` has no zero");
        let labels = [
            (at, "driven here"),
            (&parsed.key, "with `axes`, but without `normals`"),
        ];
        let help = "add `normals` to the joint: a direction across the axis in the frame of each body, parallel at zero";
        return (parsed.log).reject(message, &labels, help);
    }
    Some(())
}
