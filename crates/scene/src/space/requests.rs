//! The requested reactions.

use super::joints::Joints;
use crate::diagnostics::Span;
use crate::keys::table;
use crate::requests::{joint_and_component, strings};
use crate::spans::SceneLocation;
use crate::table_reader::TableReader;
use crate::wording::shorten;
use dwell_geometry::JointId;
use dwell_geometry::space::JointKind;
use dwell_kinetostatics::space::{Axes, Component, Reaction};

/// The components by their names.
const COMPONENTS: [(&str, Component); 12] = [
    ("x", Component::Force(Axes::Ground, 0)),
    ("y", Component::Force(Axes::Ground, 1)),
    ("z", Component::Force(Axes::Ground, 2)),
    ("moment-x", Component::Moment(Axes::Ground, 0)),
    ("moment-y", Component::Moment(Axes::Ground, 1)),
    ("moment-z", Component::Moment(Axes::Ground, 2)),
    ("normal", Component::Force(Axes::Joint, 0)),
    ("across", Component::Force(Axes::Joint, 1)),
    ("axial", Component::Force(Axes::Joint, 2)),
    ("moment-normal", Component::Moment(Axes::Joint, 0)),
    ("moment-across", Component::Moment(Axes::Joint, 1)),
    ("moment-axial", Component::Moment(Axes::Joint, 2)),
];

/// The name of a component.
pub(super) fn component_name(component: Component) -> &'static str {
    let found = COMPONENTS.iter().find(|(_, c)| *c == component);
    found.map_or("", |(name, _)| name)
}

/// Whether a joint of a kind can have a component that is not zero.
fn exists(kind: JointKind, component: Component) -> bool {
    let has_moment = !matches!(kind, JointKind::Spherical | JointKind::Distance { .. });
    match (kind, component) {
        (_, Component::Moment(..)) if !has_moment => false,
        // A ball and a link have no axes of their own.
        (JointKind::Spherical | JointKind::Distance { .. }, Component::Force(Axes::Joint, _)) => {
            false
        }
        (JointKind::Revolute, Component::Moment(Axes::Joint, 2)) => false,
        (JointKind::Prismatic, Component::Force(Axes::Joint, 2)) => false,
        (
            JointKind::Cylindrical,
            Component::Force(Axes::Joint, 2) | Component::Moment(Axes::Joint, 2),
        ) => false,
        (
            JointKind::Planar,
            Component::Force(Axes::Joint, 0 | 1) | Component::Moment(Axes::Joint, 2),
        ) => false,
        _ => true,
    }
}

/// The components of a joint in the axes of the ground.
pub(super) fn in_ground_axes(kind: JointKind) -> impl Iterator<Item = Component> {
    let all = COMPONENTS[..6].iter().map(|(_, component)| *component);
    all.filter(move |component| exists(kind, *component))
}

/// The reactions that are listed, each once.
pub(super) fn reactions(fields: &TableReader<'_>, joints: &Joints<'_>) -> Option<Vec<Reaction>> {
    fields.reject_unknown_keys(table("requests-in-space"));
    let entry = fields.get("reactions")?;
    let mut found: Vec<Reaction> = Vec::new();
    for (text, at) in strings(entry, "an array such as [\"A.z\"]") {
        let (name, component) = joint_and_component(text);
        let Some(j) = joints.find(name, &at) else {
            continue;
        };
        // A joint that could not be read has been reported already.
        let Some(joint) = &joints.list[j].joint else {
            continue;
        };
        let components = match component {
            None => in_ground_axes(joint.kind).collect(),
            Some(component) => one(joint.kind, component, name, (entry.log(), &at)),
        };
        for component in components {
            let reaction = Reaction {
                joint: JointId(j),
                component,
            };
            if !found.contains(&reaction) {
                entry.log().place(SceneLocation::Reaction(found.len()), &at);
                found.push(reaction);
            }
        }
    }
    Some(found)
}

/// The component of that name.
fn one(
    kind: JointKind,
    component: &str,
    joint: &str,
    (log, at): (&crate::diagnostics::Diagnostics, &Span),
) -> Vec<Component> {
    let existing = COMPONENTS.iter().filter(|(_, c)| exists(kind, *c));
    let found = existing.clone().find(|(name, _)| *name == component);
    if found.is_none() {
        let message = format!(
            "the reaction of joint `{}` has no component `{}`",
            shorten(joint),
            shorten(component)
        );
        let help = log.choices(
            component,
            "components of its reaction",
            existing.map(|(name, _)| *name),
        );
        log.report(message, &[(at, "no such component")], help);
    }
    found.map(|(_, component)| *component).into_iter().collect()
}
