//! The requested reactions.

use super::bodies::Space;
use super::joints::Joints;
use super::scene::SpacePathPoint;
use crate::bodies::Bodies;
use crate::diagnostics::Span;
use crate::keys::table;
use crate::requests::{joint_and_component, path_points, strings, variables_of};
use crate::spans::SceneLocation;
use crate::table_reader::TableReader;
use crate::wording::{list, shorten};
use dwell_geometry::JointId;
use dwell_geometry::space::{Joint, JointKind, Vec3};
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
    let [force, moment] = kind.reaction();
    match component {
        Component::Force(Axes::Joint, k) => kind.has_axis() && force[k],
        Component::Moment(Axes::Joint, k) => moment[k],
        Component::Force(Axes::Ground, _) => true,
        Component::Moment(Axes::Ground, _) => kind.has_moment(),
    }
}

/// The components of a joint in the axes of the ground, but those that are always zero.
pub(super) fn in_ground_axes(joint: &Joint, ground: usize) -> Vec<Component> {
    let own_axis = (0..2).find(|k| joint.side_body(*k).0 == ground);
    let own_axis = own_axis.map(|k| joint.sides[k].axis);
    // Where the joint's axis is one of the ground's, the component along it is the axial one.
    let is_along = |k: usize| own_axis.is_some_and(|u| Vec3::AXES[k].cross(u).norm() == 0.0);
    // A force along the axis alone, as of teeth.
    let is_axial = joint.kind.reaction() == [[false, false, true], [false; 3]];
    let is_never_zero = |component: &Component| match *component {
        Component::Force(_, k) if is_axial => own_axis.is_none_or(|u| Vec3::AXES[k].dot(u) != 0.0),
        Component::Force(_, k) if is_along(k) => {
            exists(joint.kind, Component::Force(Axes::Joint, 2)) || !joint.kind.has_axis()
        }
        Component::Moment(_, k) if is_along(k) => {
            exists(joint.kind, Component::Moment(Axes::Joint, 2))
        }
        component => exists(joint.kind, component),
    };
    let all = COMPONENTS[..6].iter().map(|(_, component)| *component);
    all.filter(is_never_zero).collect()
}

/// `[requests]`.
#[derive(Debug, Default)]
pub(super) struct SpaceRequests {
    /// None where they are not listed.
    pub(super) reactions: Option<Vec<Reaction>>,
    pub(super) paths: Vec<SpacePathPoint>,
    pub(super) variables: Option<Vec<String>>,
}

/// What is requested; what scenes in the plane alone have is named as such.
pub(super) fn requests(
    fields: &TableReader<'_>,
    bodies: &Bodies<'_, Space>,
    joints: &Joints<'_>,
    ground: usize,
) -> SpaceRequests {
    let known = table("requests-in-space");
    for entry in fields.unknown_entries(known) {
        if table("requests").contains_key(entry.name) {
            let message = format!("a scene in space has no `{}` in [requests]", entry.name);
            let help = "leave it out: a dwell is that of an angle, and internal forces are computed in the plane only";
            entry.reject::<()>(message, "for scenes in the plane", help);
        } else {
            fields.report_unknown_key(entry, "keys here", known.names());
        }
    }
    let paths = fields.get("paths").map(|entry| path_points(entry, bodies));
    SpaceRequests {
        reactions: reactions(fields, joints, ground),
        paths: paths.unwrap_or_default(),
        variables: fields.get("variables").map(variables_of),
    }
}

/// The reactions that are listed, each once.
fn reactions(
    fields: &TableReader<'_>,
    joints: &Joints<'_>,
    ground: usize,
) -> Option<Vec<Reaction>> {
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
        let log = entry.log();
        for component in components(joint, (component, name), ground, (log, &at)) {
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

/// The one component of one joint that a text names.
pub(super) fn one_reaction(
    text: &str,
    at: &Span,
    fields: &TableReader<'_>,
    joints: &Joints<'_>,
    ground: usize,
) -> Option<Reaction> {
    let (name, component) = joint_and_component(text);
    let j = joints.find(name, at)?;
    // A joint that could not be read has been reported already.
    let joint = joints.list[j].joint.as_ref()?;
    let components = components(joint, (component, name), ground, (fields.log(), at));
    match components[..] {
        [] => None,
        [component] => Some(Reaction {
            joint: JointId(j),
            component,
        }),
        _ => {
            let names = components.iter().map(|&c| component_name(c));
            let names = list(names).unwrap_or_default();
            let message = format!("{} names {} reactions", fields.what, components.len());
            let help = format!("name one component of `{}`: {names}", shorten(name));
            fields
                .log()
                .reject(message, &[(at, "which of them?")], help)
        }
    }
}

/// The component of that name, or those in the axes of the ground.
fn components(
    of: &Joint,
    (component, joint): (Option<&str>, &str),
    ground: usize,
    (log, at): (&crate::diagnostics::Diagnostics, &Span),
) -> Vec<Component> {
    let (Some(component), kind) = (component, of.kind) else {
        return in_ground_axes(of, ground);
    };
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
