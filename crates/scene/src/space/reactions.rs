//! Reactions by their names.

use super::joints::Joints;
use crate::coordinates::Parts;
use crate::diagnostics::Span;
use crate::dimensions::Space;
use crate::requests::{ReactionNotation, component_named, joint_and_component};
use crate::scene_data::SpaceScene;
use crate::wording::shorten;
use dwell_geometry::JointId;
use dwell_geometry::space::{CouplingAction, Joint, JointKind, Vec3};
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

/// The only component of a coupling: along its dependent coordinate.
fn of_coupling(kind: JointKind) -> Option<(&'static str, Component)> {
    let JointKind::Coupling { action, .. } = kind else {
        return None;
    };
    Some(match action {
        CouplingAction::Couple => ("moment", Component::Moment(Axes::Joint, 2)),
        CouplingAction::Force => ("force", Component::Force(Axes::Joint, 2)),
        CouplingAction::Line => ("force", Component::Force(Axes::Line, 0)),
    })
}

/// The component of a distance along its line.
fn of_distance(kind: JointKind) -> Option<(&'static str, Component)> {
    let is_distance = matches!(kind, JointKind::Distance { .. });
    is_distance.then_some(("axial", Component::Force(Axes::Line, 0)))
}

/// Whether a joint of a kind can have a component that is not zero.
fn exists(kind: JointKind, component: Component) -> bool {
    let [force, moment] = kind.reaction();
    match component {
        Component::Force(Axes::Joint, k) => kind.has_axis() && force[k],
        Component::Moment(Axes::Joint, k) => moment[k],
        Component::Force(Axes::Line, _) | Component::Moment(Axes::Line, _) => {
            kind.acts_along_line()
        }
        Component::Force(Axes::Ground, _) => true,
        Component::Moment(Axes::Ground, _) => kind.has_moment(),
    }
}

/// The components of a joint in the axes of the ground, without those that are always zero.
pub(super) fn in_ground_axes(joint: &Joint, ground: usize) -> Vec<Component> {
    if let Some((_, component)) = of_coupling(joint.kind) {
        return vec![component];
    }
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

impl ReactionNotation for Space {
    const REACTIONS: &'static str = "an array such as [\"A.z\"]";

    fn reactions_named(text: &str, at: &Span, parts: &Parts<'_, '_, Self>) -> Vec<Reaction> {
        let Parts { bodies, joints } = *parts;
        let (name, component) = joint_and_component(text);
        let Some(j) = joints.find(name, at) else {
            return Vec::new();
        };
        // A joint that could not be read has been reported already.
        let Some(joint) = &joints.list[j].joint else {
            return Vec::new();
        };
        let components = match component {
            None => in_ground_axes(joint, bodies.ground.unwrap_or_default()),
            Some(component) => {
                let existing = COMPONENTS.iter().filter(|(_, c)| exists(joint.kind, *c));
                let existing = match of_coupling(joint.kind) {
                    Some(only) => vec![only],
                    None => existing.copied().chain(of_distance(joint.kind)).collect(),
                };
                let found = component_named(component, &shorten(name), &existing, at, joints.log);
                Vec::from_iter(found)
            }
        };
        let reaction = |component| Reaction {
            joint: JointId(j),
            component,
        };
        components.into_iter().map(reaction).collect()
    }

    fn name_of_reaction(reaction: Reaction, joints: &Joints<'_>) -> String {
        let joint = &joints.list[reaction.joint.0];
        let kind = joint.joint.as_ref().map(|joint| joint.kind);
        name(joint.name, kind, reaction.component)
    }
}

impl SpaceScene {
    /// The name of a reaction: `joint.component`.
    pub fn reaction_name(&self, reaction: Reaction) -> String {
        let joint = &self.mechanism.joints[reaction.joint.0];
        name(&joint.name, Some(joint.kind), reaction.component)
    }
}

/// The name of a component of the reaction of a joint.
fn name(joint: &str, kind: Option<JointKind>, component: Component) -> String {
    let of_kind = kind.and_then(|kind| of_coupling(kind).or_else(|| of_distance(kind)));
    let mut all = of_kind.into_iter().chain(COMPONENTS);
    let found = all.find(|(_, c)| *c == component);
    format!("{joint}.{}", found.map_or("", |(name, _)| name))
}
