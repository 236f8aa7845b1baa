//! Compiled models of a scene: for which reactions, with which loads.

use crate::explain::{StudyError, explain_machine, explain_model, not_one_actuator};
use dwell_dynamics::{CoordinateMode, Machine};
use dwell_geometry::{BodyId, Plan, Reaction};
use dwell_kinetostatics::{ExactModel, Model};
use dwell_scene::{FreeMotionSpec, Scene, SceneLocation};
use std::collections::HashSet;

/// A model of a scene for some reactions.
pub fn compile_model(scene: &Scene, reactions: &[Reaction]) -> Result<Model, StudyError> {
    let start = scene.assembly.to_configuration();
    Model::new(&scene.mechanism, &scene.masses, &start, reactions)
        .map_err(|e| explain_model(scene, &e))
}

/// A reduced model of a scene for some reactions.
pub fn reduced_model(scene: &Scene, reactions: &[Reaction]) -> Result<ExactModel, StudyError> {
    ExactModel::new(compile_model(scene, reactions)?).ok_or_else(|| not_one_actuator(scene))
}

/// The requested reactions that are statically indeterminate: no analysis returns them.
pub fn indeterminate_reactions(scene: &Scene, plan: &Plan) -> HashSet<Reaction> {
    let all = scene.mechanism.reactions().into_iter().enumerate();
    all.filter(|&(k, _)| !plan.is_determinate(k))
        .map(|(_, reaction)| reaction)
        .filter(|reaction| scene.requests.reactions.contains(reaction))
        .collect()
}

/// The model of a scene with the requested reactions that are statically determinate.
pub(crate) fn determinate_model(scene: &Scene) -> Result<Model, StudyError> {
    let requested = &scene.requests.reactions;
    let model = compile_model(scene, requested)?;
    let indeterminate = indeterminate_reactions(scene, model.plan());
    if indeterminate.is_empty() {
        return Ok(model);
    }
    let mut determinate = requested.clone();
    determinate.retain(|reaction| !indeterminate.contains(reaction));
    model
        .with_reactions(&determinate)
        .map_err(|e| explain_model(scene, &e))
}

/// The bodies of the joints whose reactions are requested.
pub(crate) fn requested_reaction_bodies(scene: &Scene) -> Vec<BodyId> {
    let joints = scene.requests.reactions.iter();
    let joints = joints.map(|r| &scene.mechanism.joints[r.joint.0]);
    joints.flat_map(|joint| joint.bodies).collect()
}

/// The model of a scene with its loads and every reaction.
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be assembled or a load does not fit it.
pub fn loaded_model(scene: &Scene) -> Result<Model, StudyError> {
    with_loads(scene, compile_model(scene, &scene.mechanism.reactions())?)
}

/// A model with the loads of its scene.
///
/// # Errors
/// [`StudyError::Scene`] where a load does not fit it.
pub(crate) fn with_loads(scene: &Scene, model: Model) -> Result<Model, StudyError> {
    let loads = scene.loads.clone();
    model.with_loads(loads).map_err(|e| {
        let labels = [(SceneLocation::Load(e.load), "this load".to_owned())];
        let name = scene
            .loads
            .get(e.load)
            .map_or("", |load| load.name.as_str());
        scene
            .error(format!("load `{name}`: {}", e.what), None, &labels)
            .into()
    })
}

/// The model of what a scene requests, with its loads: they may need groups that the inertia does not.
pub(crate) fn loaded_determinate_model(scene: &Scene) -> Result<Model, StudyError> {
    with_loads(scene, determinate_model(scene)?)
}

/// The machine of a scene, with some reactions and those that friction needs.
pub fn build_machine(
    scene: &Scene,
    spec: &FreeMotionSpec,
    reactions: &[Reaction],
) -> Result<Machine, StudyError> {
    let model = compile_model(scene, reactions)?;
    let mode = |law: &Option<dwell_laws::Law>| {
        law.clone()
            .map_or(CoordinateMode::Free, CoordinateMode::Prescribed)
    };
    let modes = spec.laws.iter().map(mode).collect();
    Machine::new(model, &scene.loads, modes, &scene.drives).map_err(|e| explain_machine(scene, e))
}
