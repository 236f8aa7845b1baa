//! The reactions that a trajectory needs: those that the scene requests, and all components of all joints for their magnitudes.

use crate::explain::StudyError;
use crate::space::explain::with_loads;
use crate::space::prepared::{compile, sort_reactions};
use dwell_geometry::JointId;
use dwell_geometry::space::{Vec3, vec3};
use dwell_kinetostatics::space::{Axes, Component, Model, Reaction};
use dwell_scene::SpaceScene;

/// The components of a joint's force and moment in the axes of the ground.
const COMPONENTS: [Component; 6] = [
    Component::Force(Axes::Ground, 0),
    Component::Force(Axes::Ground, 1),
    Component::Force(Axes::Ground, 2),
    Component::Moment(Axes::Ground, 0),
    Component::Moment(Axes::Ground, 1),
    Component::Moment(Axes::Ground, 2),
];

/// All components of the reactions of all joints.
fn components_of_all(joints: usize) -> Vec<Reaction> {
    let whole = (0..joints).flat_map(|j| {
        let reaction = move |component| Reaction {
            joint: JointId(j),
            component,
        };
        COMPONENTS.map(reaction)
    });
    whole.collect()
}

/// The model of a trajectory under all loads, with its reactions, the requested ones first.
#[derive(Debug, Clone)]
pub struct SpaceRows {
    pub(crate) model: Model,
    /// The requested ones that the loads determine.
    pub(crate) requested: Vec<Reaction>,
    /// The requested ones that redundant constraints leave open.
    pub(crate) indeterminate: Vec<Reaction>,
    /// By joint: whether its force and its moment have a magnitude that the loads determine.
    has_magnitude: Vec<[bool; 2]>,
}

impl SpaceRows {
    /// The reactions of a scene.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be assembled.
    pub(crate) fn new(scene: &SpaceScene) -> Result<Self, StudyError> {
        let joints = &scene.mechanism.joints;
        let whole = components_of_all(joints.len());
        let model = compile(scene, &[&scene.requests.reactions[..], &whole].concat())?;
        let [_, open] = sort_reactions(scene, &model)?;
        let all = scene.requests.reactions.iter();
        let (indeterminate, requested): (Vec<_>, Vec<_>) = all.partition(|&r| open.contains(r));
        let has_magnitude = joints.iter().enumerate().map(|(j, joint)| {
            let of_joint = &whole[6 * j..6 * j + 6];
            let is_determined = |some: &[Reaction]| !some.iter().any(|r| open.contains(r));
            let (force, moment) = of_joint.split_at(3);
            // The only component of a coupling is its magnitude.
            [
                !joint.kind.is_coupling() && is_determined(force),
                joint.kind.has_moment() && !joint.kind.is_coupling() && is_determined(moment),
            ]
        });
        Ok(Self {
            model: model_of(scene, &requested)?,
            requested,
            indeterminate,
            has_magnitude: has_magnitude.collect(),
        })
    }

    /// The reactions, for the scene driven at another joint.
    ///
    /// # Errors
    /// [`StudyError::Scene`] when the mechanism cannot be assembled.
    pub(crate) fn of_chart(&self, scene: &SpaceScene) -> Result<Self, StudyError> {
        Ok(Self {
            model: model_of(scene, &self.requested)?,
            ..self.clone()
        })
    }

    /// Whether the force and the moment of a joint have a magnitude that the loads determine.
    pub(super) fn has_magnitude(&self, joint: JointId) -> [bool; 2] {
        self.has_magnitude[joint.0]
    }

    /// Whether all components of a joint's force, and of its moment, in the axes of the ground are requested.
    pub(super) fn lists_whole(&self, joint: JointId) -> [bool; 2] {
        let is_listed = |component: &Component| {
            let mut requested = self.requested.iter();
            requested.any(|r| r.joint == joint && r.component == *component)
        };
        [0..3, 3..6].map(|part| COMPONENTS[part].iter().all(is_listed))
    }

    /// Force and moment of a joint, among the reactions of the model.
    pub(super) fn wrench(&self, joint: JointId, reactions: &[f64]) -> [Vec3; 2] {
        let first = self.requested.len() + 6 * joint.0;
        [first, first + 3].map(|k| vec3(reactions[k], reactions[k + 1], reactions[k + 2]))
    }
}

/// The model of the requested reactions and of all components, with all loads.
fn model_of(scene: &SpaceScene, requested: &[Reaction]) -> Result<Model, StudyError> {
    let whole = components_of_all(scene.mechanism.joints.len());
    with_loads(scene, compile(scene, &[requested, &whole].concat())?)
}
