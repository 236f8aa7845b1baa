//! The columns that a scene requests, and the groups that they, inertia and loads need: a trajectory analysis models no
//! others.

use crate::explain::{StudyError, scene_error};
use crate::models::{build_machine, compile_model, requested_reaction_bodies, with_drive_loads};
use crate::trajectory::compute::{Column, all_columns, extra_columns, is_prefix_of};
use dwell_geometry::{BodyId, JointId};
use dwell_kinetostatics::Model;
use dwell_scene::{PlaneScene, SceneLocation, choices};

/// Rejects requested names that select no column: for analyses that write none of them, so that a scene is right for all
/// or for none.
///
/// # Errors
/// [`StudyError::Scene`] at the first of them.
pub(crate) fn reject_unknown_variables(scene: &PlaneScene) -> Result<(), StudyError> {
    if scene.requests.variables.is_some() {
        let model = compile_model(scene, &scene.mechanism.reactions())?;
        check_variables(scene, &model)?;
    }
    Ok(())
}

/// Every column that any analysis of a scene can write.
fn columns_of_all_analyses(scene: &PlaneScene, model: &Model) -> Result<Vec<Column>, StudyError> {
    let loaded_scene = with_drive_loads(scene)?;
    let mut columns = all_columns(&loaded_scene, model, true);
    // Another analysis than `simulate` does not fail where the motion's machine cannot be built.
    let machine = scene.motion.as_ref();
    let machine = machine.and_then(|spec| build_machine(scene, spec, &[]).ok());
    columns.extend(machine.map_or_else(Vec::new, |m| extra_columns(&loaded_scene, &m)));
    Ok(columns)
}

/// Rejects requested names that select no column of any analysis.
///
/// # Errors
/// [`StudyError::Scene`] at the first of them.
pub(crate) fn check_variables(scene: &PlaneScene, model: &Model) -> Result<(), StudyError> {
    let Some(variables) = &scene.requests.variables else {
        return Ok(());
    };
    let columns = columns_of_all_analyses(scene, model)?;
    for (k, name) in variables.iter().enumerate() {
        if columns.iter().any(|c| c.matches(name)) {
            continue;
        }
        if let Some(error) = indeterminate_error(scene, model, k, name) {
            return Err(error);
        }
        let message = format!("there is no column `{name}`");
        let place = (SceneLocation::Variable(k), "unknown column");
        let help = suggestion(name, &columns);
        return Err(scene_error(scene, message, help, [place]));
    }
    Ok(())
}

/// The error of a request for a statically indeterminate reaction.
fn indeterminate_error(
    scene: &PlaneScene,
    model: &Model,
    k: usize,
    name: &str,
) -> Option<StudyError> {
    let mechanism = &scene.mechanism;
    let joint = name.split('.').next();
    let is_of_joint = |j: JointId| Some(&*mechanism.joints[j.0].name) == joint;
    let mut reactions = model.reactions().iter().enumerate();
    let is_indeterminate = |r| !model.plan().is_determinate(r);
    let is_meant = reactions.any(|(r, of)| is_of_joint(of.joint) && is_indeterminate(r));
    let message =
        format!("`{name}` is statically indeterminate: redundant constraints share the load");
    let help = "`dwell check` lists such reactions; remove one of the redundant joints";
    let place = (SceneLocation::Variable(k), "indeterminate");
    is_meant.then(|| scene_error(scene, message, help, [place]))
}

/// Names that may have been meant: columns and their prefixes; otherwise those with the same first word,
/// or all first words.
pub(crate) fn suggestion(name: &str, columns: &[Column]) -> String {
    let mut names: Vec<&str> = Vec::new();
    for column in columns {
        let ends = column.name.match_indices('.').map(|(at, _)| at);
        for end in ends.chain([column.name.len()]) {
            let prefix = &column.name[..end];
            if !names.contains(&prefix) {
                names.push(prefix);
            }
        }
    }
    let first = name.split('.').next().unwrap_or(name);
    let mut below: Vec<&str> = names.clone();
    below.retain(|n| *n != first && is_prefix_of(first, n));
    if below.is_empty() {
        names.sort_by_key(|n| n.contains('.'));
        choices(name, "columns", names.into_iter())
    } else {
        choices(name, &format!("columns of `{first}`"), below.into_iter())
    }
}

/// The bodies that the requests of a scene need; `None` if no `variables` are named, so that every
/// column is computed.
pub(crate) fn requested_bodies(scene: &PlaneScene, model: &Model) -> Option<Vec<BodyId>> {
    let requests = &scene.requests;
    let names = requests.variables.as_ref()?;
    let mut bodies: Vec<BodyId> = requests.paths.iter().map(|p| p.body).collect();
    bodies.extend(requests.dwell.iter().map(|d| d.body));
    bodies.extend(requests.sections.iter().map(|s| s.body));
    // A scene that names no reactions requests all of them.
    if requests.reactions.len() < scene.mechanism.reactions().len() {
        bodies.extend(requested_reaction_bodies(scene));
    }
    for column in all_columns(scene, model, true) {
        if names.iter().any(|name| column.matches(name)) {
            bodies.extend(column.quantity.bodies(scene, model.reactions()));
        }
    }
    Some(bodies)
}

/// The model without the groups that nothing needs.
pub(crate) fn prune_model(scene: &PlaneScene, model: &Model) -> Model {
    match requested_bodies(scene, model) {
        None => model.clone(),
        Some(bodies) => model.clone().pruned_for(&bodies),
    }
}
