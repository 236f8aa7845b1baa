//! The independent coordinates: angles and travels of joints.

use super::bodies::Space;
use super::joints::{Joints, ParsedJoint};
use crate::bodies::Bodies;
use crate::coordinates::NamedActuator;
use crate::diagnostics::Span;
use crate::keys::table;
use crate::names::check;
use crate::spans::SceneLocation;
use crate::table_reader::{Entry, TableReader};
use crate::wording::shorten;
use dwell_geometry::space::{Actuator, ActuatorKind, JointKind};
use dwell_geometry::{ActuatorId, JointId};
use toml::de::DeValue;

/// An actuator as read; nothing in it if it was wrong.
#[derive(Debug)]
pub(super) struct ParsedActuator<'a> {
    pub(super) name: &'a str,
    key: Span,
    pub(super) actuator: Option<Actuator>,
}

impl ParsedActuator<'_> {
    /// Whether its coordinate is an angle; one that could not be read counts as one.
    pub(super) fn is_angle(&self) -> bool {
        let kind = self.actuator.as_ref().map(|a| a.kind);
        !matches!(kind, Some(ActuatorKind::Travel(_)))
    }
}

impl NamedActuator for ParsedActuator<'_> {
    fn name(&self) -> &str {
        self.name
    }

    fn key(&self) -> &Span {
        &self.key
    }

    fn is_angle(&self) -> bool {
        self.is_angle()
    }
}

pub(super) fn actuators<'a>(
    fields: &TableReader<'a>,
    bodies: &Bodies<'_, Space>,
    joints: &Joints<'_>,
) -> Vec<ParsedActuator<'a>> {
    let mut found: Vec<ParsedActuator<'a>> = Vec::new();
    for (k, entry) in fields.entries.iter().enumerate() {
        check("an actuator", entry);
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
        found.push(ParsedActuator {
            name: entry.name,
            key: entry.key.clone(),
            actuator: read_actuator(entry, joints),
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
    let name = coordinate.value.string(fields.name_of(coordinate))?;
    let at = coordinate.value.span();
    let joint = joints.find(name, &at)?;
    let is_angle = coordinate.name == "angle";
    require_freedom(is_angle, &joints.list[joint], &at)?;
    let id = JointId(joint);
    let kind = match is_angle {
        true => ActuatorKind::Angle(id),
        false => ActuatorKind::Travel(id),
    };
    Some(Actuator {
        name: entry.name.to_owned(),
        kind,
    })
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
