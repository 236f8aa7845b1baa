//! The joints and the actuators: which points of which bodies they hold together, and which
//! angles they drive.

use crate::bodies::{Bodies, POINT};
use crate::fields::{Entry, Fields, Value, number, pair, two_strings};
use crate::names::{check, shorten};
use crate::problem::{Problem, Problems, Span};
use dwell_geometry::{Actuator, BodyId, Joint, JointKind, Vec2, vec2};
use std::collections::HashMap;

/// A joint as read; nothing in it if it was wrong, while its name still counts as known.
#[derive(Debug)]
pub(crate) struct JointText<'a> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    /// Where its two points are named.
    pub(crate) ends: [Span; 2],
    pub(crate) axis: Option<Span>,
    pub(crate) joint: Option<Joint>,
}

/// All the joints as read.
#[derive(Debug, Default)]
pub(crate) struct Joints<'a> {
    pub(crate) list: Vec<JointText<'a>>,
    pub(crate) by_name: HashMap<&'a str, usize>,
}

impl<'a> Joints<'a> {
    pub(crate) fn read(fields: &Fields<'a>, bodies: &Bodies<'_>, problems: &mut Problems) -> Self {
        let mut joints = Self::default();
        for entry in &fields.entries {
            check("a joint", entry.name, &entry.key, problems);
            joints.by_name.insert(entry.name, joints.list.len());
            joints.list.push(joint(entry, bodies, problems));
        }
        joints
    }
}

fn joint<'a>(entry: &Entry<'a>, bodies: &Bodies<'_>, problems: &mut Problems) -> JointText<'a> {
    let key = entry.key.clone();
    let mut text = JointText {
        name: entry.name,
        ends: [key.clone(), key.clone()],
        key,
        axis: None,
        joint: None,
    };
    let what = format!("joint `{}`", shorten(entry.name));
    let Some(fields) = Fields::open(entry, what, problems) else {
        return text;
    };
    fields.allow(&["revolute", "prismatic", "axis", "axes"], problems);
    let what = &fields.what;
    let (kind, held) = match (fields.get("revolute"), fields.get("prismatic")) {
        (Some(held), None) => ("revolute", held),
        (None, Some(held)) => ("prismatic", held),
        (Some(a), Some(b)) => {
            problems.push(
                Problem::new(format!("{what} is both revolute and prismatic"))
                    .at(a.key.clone(), "either this")
                    .at(b.key.clone(), "or this")
                    .help("make it two joints with a body between them"),
            );
            return text;
        }
        (None, None) => {
            problems.push(
                Problem::new(format!("{what} is neither revolute nor prismatic"))
                    .at(entry.key.clone(), "of which kind?")
                    .help("write it as `{ revolute = [\"body.point\", \"body.point\"] }`, or prismatic with an axis"),
            );
            return text;
        }
    };
    let ends = two_strings(
        held.value,
        "two points [\"body.point\", \"body.point\"]",
        format_args!("{kind} of {what}"),
        problems,
    );
    if let Some([(_, a), (_, b)]) = &ends {
        text.ends = [a.clone(), b.clone()];
    }
    let ends = ends.and_then(|[(a, at_a), (b, at_b)]| {
        let first = bodies.find_point(a, &at_a, problems);
        let second = bodies.find_point(b, &at_b, problems);
        let (first, second) = (first?, second?);
        if first.0 == second.0 {
            problems.push(
                Problem::new(format!(
                    "{what} joins body `{}` to itself",
                    bodies.list[first.0.0].name
                ))
                .at(at_a, "this body")
                .at(at_b, "and the same again")
                .help("a joint holds two different bodies together"),
            );
            return None;
        }
        Some([first, second])
    });
    let kind = match kind {
        "revolute" => revolute(&fields, problems),
        _ => prismatic(entry, &fields, problems),
    };
    text.axis = fields
        .get("axis")
        .or(fields.get("axes"))
        .map(|e| e.value.span());
    if let (Some(ends), Some(kind)) = (ends, kind) {
        text.joint = Some(Joint {
            name: entry.name.to_owned(),
            bodies: ends.map(|(body, _)| body),
            points: ends.map(|(body, point)| bodies.list[body.0].points[point].at),
            kind,
        });
    }
    text
}

fn revolute(fields: &Fields<'_>, problems: &mut Problems) -> Option<JointKind> {
    let axis = fields.get("axis").or(fields.get("axes"));
    if let Some(axis) = axis {
        problems.push(
            Problem::new(format!("{} is revolute and has no axis", fields.what))
                .at(axis.key.clone(), "not for a revolute joint")
                .help("leave the axis out; it turns about its point"),
        );
        return None;
    }
    Some(JointKind::Revolute)
}

fn prismatic(entry: &Entry<'_>, fields: &Fields<'_>, problems: &mut Problems) -> Option<JointKind> {
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

/// A direction: only the ratio of its components counts, so it has no unit.
fn unit_vector(value: &Value<'_>, what: &str, problems: &mut Problems) -> Option<Vec2> {
    let [x, y] = pair(value, POINT, format_args!("{what}"), problems)?;
    let x = number(x, format_args!("x of {what}"), problems);
    let y = number(y, format_args!("y of {what}"), problems);
    let (x, y) = (x?, y?);
    let largest = x.abs().max(y.abs());
    if largest == 0.0 {
        problems.push(
            Problem::new(format!("{what} has no length"))
                .at(value.span(), "no direction")
                .help("give a direction, such as [1, 0]"),
        );
        return None;
    }
    // Scaled first: the largest and the smallest numbers would lose their direction in a square.
    let (x, y) = (x / largest, y / largest);
    let length = x.hypot(y);
    Some(vec2(x / length, y / length))
}

/// An actuator as read; nothing in it if it was wrong.
#[derive(Debug)]
pub(crate) struct ActuatorText<'a> {
    pub(crate) name: &'a str,
    pub(crate) key: Span,
    pub(crate) actuator: Option<Actuator>,
}

/// All the actuators. A body of the same name is an error: both are keys of `[assembly]`.
pub(crate) fn actuators<'a>(
    fields: &Fields<'a>,
    bodies: &Bodies<'_>,
    problems: &mut Problems,
) -> Vec<ActuatorText<'a>> {
    let mut list = Vec::new();
    for entry in &fields.entries {
        check("an actuator", entry.name, &entry.key, problems);
        if let Some(k) = bodies.position(entry.name) {
            let body = &bodies.list[k];
            let name = shorten(entry.name);
            problems.push(
                Problem::new(format!("`{name}` names both a body and an actuator"))
                    .at(body.key.clone(), "the body")
                    .at(entry.key.clone(), "the actuator")
                    .help("rename one: in [assembly] it could not be told which is meant"),
            );
        }
        let bodies = driven(entry, bodies, problems);
        list.push(ActuatorText {
            name: entry.name,
            key: entry.key.clone(),
            actuator: bodies.map(|bodies| Actuator {
                name: entry.name.to_owned(),
                bodies,
                drive: dwell_geometry::Drive::Angle,
            }),
        });
    }
    list
}

/// The bodies whose angle the actuator drives.
fn driven(entry: &Entry<'_>, bodies: &Bodies<'_>, problems: &mut Problems) -> Option<[BodyId; 2]> {
    let what = format!("actuator `{}`", shorten(entry.name));
    let fields = Fields::open(entry, what, problems)?;
    let what = &fields.what;
    if let Some(length) = fields.get("length") {
        problems.push(
            Problem::new(format!("{what} drives a length, which is not possible yet"))
                .at(length.key.clone(), "only angles can be driven")
                .help("drive the angle between two bodies: `angle = [\"ground\", \"crank\"]`"),
        );
        return None;
    }
    fields.allow(&["angle"], problems);
    let Some(angle) = fields.get("angle") else {
        problems.push(
            Problem::new(format!("{what} drives nothing"))
                .at(entry.key.clone(), "which angle?")
                .help("add `angle = [\"ground\", \"crank\"]`: the angle of the second body from the first"),
        );
        return None;
    };
    let [(a, at_a), (b, at_b)] = two_strings(
        angle.value,
        "two bodies [\"body\", \"body\"]",
        format_args!("angle of {what}"),
        problems,
    )?;
    let first = bodies.find(a, &at_a, problems);
    let second = bodies.find(b, &at_b, problems);
    let (first, second) = (first?, second?);
    if first == second {
        problems.push(
            Problem::new(format!("{what} drives body `{a}` against itself"))
                .at(at_a, "this body")
                .at(at_b, "and the same again")
                .help("an angle is between two different bodies"),
        );
        return None;
    }
    Some([first, second])
}
