//! Compiled models of a scene: for which reactions, with which loads.

use crate::explain::{StudyError, explain_machine, explain_model, not_one_actuator};
use dwell_dynamics::{CoordinateMode, EndStop, Machine, YieldingStop, loads_with_drives};
use dwell_geometry::{BodyId, Plan, Reaction};
use dwell_kinetostatics::{ExactModel, Model};
use dwell_laws::Law;
use dwell_scene::{FreeMotionSpec, NamedStop, PlaneScene};
use std::collections::HashSet;

/// A model of a scene for some reactions.
pub fn compile_model(scene: &PlaneScene, reactions: &[Reaction]) -> Result<Model, StudyError> {
    let start = scene.assembly.to_configuration();
    Model::new(&scene.mechanism, &scene.masses, &start, reactions)
        .and_then(|model| model.with_varying_inertias(&scene.varying_inertias))
        .map_err(|e| explain_model(scene, &e))
}

/// A reduced model of a scene for some reactions.
pub fn reduced_model(scene: &PlaneScene, reactions: &[Reaction]) -> Result<ExactModel, StudyError> {
    exact_model(scene, compile_model(scene, reactions)?)
}

/// The reduced model of a compiled one.
pub(crate) fn exact_model(scene: &PlaneScene, model: Model) -> Result<ExactModel, StudyError> {
    ExactModel::new(model).ok_or_else(|| not_one_actuator(scene))
}

/// The requested reactions that are statically indeterminate: no analysis returns them.
pub fn indeterminate_reactions(scene: &PlaneScene, plan: &Plan) -> HashSet<Reaction> {
    let all = scene.mechanism.reactions().into_iter().enumerate();
    let indeterminate = all.filter(|&(k, _)| !plan.is_determinate(k));
    indeterminate
        .map(|(_, reaction)| reaction)
        .filter(|reaction| scene.requests.reactions.contains(reaction))
        .collect()
}

/// The requested reactions: those that are statically determinate, and the others.
pub(crate) fn requested_reactions(scene: &PlaneScene, plan: &Plan) -> [Vec<Reaction>; 2] {
    let indeterminate = indeterminate_reactions(scene, plan);
    let requested = scene.requests.reactions.iter();
    let (determinate, others) = requested.partition(|r| !indeterminate.contains(r));
    [determinate, others]
}

/// The model of a scene with the requested reactions that are statically determinate.
pub(crate) fn determinate_model(scene: &PlaneScene) -> Result<Model, StudyError> {
    let model = compile_model(scene, &scene.requests.reactions)?;
    let [determinate, indeterminate] = requested_reactions(scene, model.plan());
    if indeterminate.is_empty() {
        return Ok(model);
    }
    model
        .with_reactions(&determinate)
        .map_err(|e| explain_model(scene, &e))
}

/// Whether a scene lists some of its reactions; otherwise it requests all of them.
pub(crate) fn lists_reactions(scene: &PlaneScene) -> bool {
    scene.requests.reactions.len() < scene.mechanism.reactions().len()
}

/// The bodies of the joints whose reactions are requested.
pub(crate) fn requested_reaction_bodies(scene: &PlaneScene) -> Vec<BodyId> {
    let joints = scene.requests.reactions.iter();
    let joints = joints.map(|r| &scene.mechanism.joints[r.joint.0]);
    joints.flat_map(|joint| joint.bodies).collect()
}

/// The model of a scene with its loads and every reaction.
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be assembled or a load does not fit it.
pub fn loaded_model(scene: &PlaneScene) -> Result<Model, StudyError> {
    with_loads(scene, compile_model(scene, &scene.mechanism.reactions())?)
}

/// A model with the loads of its scene.
///
/// # Errors
/// [`StudyError::Scene`] where a load does not fit it.
pub(crate) fn with_loads(scene: &PlaneScene, model: Model) -> Result<Model, StudyError> {
    model
        .with_loads(scene.loads.clone())
        .map_err(|e| explain_machine(scene, e.into()))
}

/// The model of the requests of a scene with its loads, which may need groups that the inertia does not.
pub(crate) fn loaded_determinate_model(scene: &PlaneScene) -> Result<Model, StudyError> {
    with_loads(scene, determinate_model(scene)?)
}

/// A scene whose loads include those through which its drives act.
pub fn with_drive_loads(scene: &PlaneScene) -> Result<PlaneScene, StudyError> {
    let loads = loads_with_drives(&scene.mechanism, &scene.loads, &scene.drives);
    let mut loaded = scene.clone();
    loaded.loads = loads.map_err(|e| explain_machine(scene, e.into()))?;
    Ok(loaded)
}

/// The end stops of a scene in the plane or in space, as its machine takes them.
pub(crate) fn end_stops(stops: &[NamedStop]) -> Vec<EndStop> {
    let one = |stop: &NamedStop| EndStop {
        actuator: stop.actuator.0,
        min: stop.min,
        max: stop.max,
        restitution: stop.restitution,
        yielding: stop
            .yielding
            .map(|[stiffness, damping]| YieldingStop { stiffness, damping }),
    };
    stops.iter().map(one).collect()
}

/// By actuator: prescribed if there is a law, otherwise free.
pub(crate) fn coordinate_modes(laws: &[Option<Law>]) -> Vec<CoordinateMode> {
    let mode = |law: &Option<Law>| match law {
        Some(law) => CoordinateMode::Prescribed(law.clone()),
        None => CoordinateMode::Free,
    };
    laws.iter().map(mode).collect()
}

/// The machine of a scene, with some reactions and those that friction needs.
pub fn build_machine(
    scene: &PlaneScene,
    spec: &FreeMotionSpec,
    reactions: &[Reaction],
) -> Result<Machine, StudyError> {
    machine_with_laws(scene, &spec.laws, reactions)
}

/// The machine of a scene with a law for each prescribed actuator.
pub fn machine_with_laws(
    scene: &PlaneScene,
    laws: &[Option<Law>],
    reactions: &[Reaction],
) -> Result<Machine, StudyError> {
    machine_of(scene, laws, compile_model(scene, reactions)?)
}

/// The machine without reactions and without the groups that no inertia, load or drive needs, with the number of these
/// groups.
///
/// # Errors
/// [`StudyError::Scene`] when the mechanism cannot be assembled, or a load or a drive does not fit it.
pub fn pruned_machine(
    scene: &PlaneScene,
    laws: &[Option<Law>],
) -> Result<(Machine, usize), StudyError> {
    let loads = with_drive_loads(scene)?.loads;
    let loaded = loads.iter().flat_map(|load| load.bodies(&scene.mechanism));
    let loaded: Vec<BodyId> = loaded.collect();
    let model = compile_model(scene, &[])?.pruned_for(&loaded);
    let idle = model.plan().pruned_groups().into_iter();
    let idle = idle.filter(|is_idle| *is_idle).count();
    Ok((machine_of(scene, laws, model)?, idle))
}

fn machine_of(
    scene: &PlaneScene,
    laws: &[Option<Law>],
    model: Model,
) -> Result<Machine, StudyError> {
    let modes = coordinate_modes(laws);
    let machine = Machine::new(model, &scene.loads, modes, &scene.drives);
    let machine = machine.and_then(|machine| machine.with_stops(&end_stops(&scene.stops)));
    machine.map_err(|e| explain_machine(scene, e))
}
