//! Which columns of an analysis a scene in space requests: as in the plane.

use super::columns::all_columns;
use super::reactions::JointReactions;
use crate::explain::{StudyError, scene_error};
use crate::machines::MachineScene as _;
use crate::trajectory::compute::{
    Analysis, Column, Quantity, extra_columns, is_prefix_of, suggestion,
};
use dwell_geometry::space::Plan;
use dwell_scene::{SceneLocation, SpaceScene};

/// Of all columns of an analysis those that a scene requests, and whether these are a choice.
pub(crate) fn requested(
    scene: &SpaceScene,
    reactions: &JointReactions,
    (analysis, all): (Analysis, &[Column]),
) -> (Vec<Column>, bool) {
    let lists_reactions = scene.lists_reactions && analysis != Analysis::Kinematics;
    let is_limited = scene.variables.is_some() || lists_reactions;
    let is_wanted = |column: &&Column| {
        let quantity = column.quantity;
        let mut names = scene.variables.iter().flatten();
        !is_limited
            || matches!(
                quantity,
                Quantity::Time | Quantity::ActuatorCoordinate(_, 0)
            )
            || names.any(|name| column.matches(name))
            || (scene.lists_reactions && is_of_listed_reaction(quantity, reactions))
            || (scene.variables.is_none() && goes_with_reactions(scene, quantity))
    };
    (all.iter().filter(is_wanted).cloned().collect(), is_limited)
}

/// Whether it is a listed reaction, or the magnitude of a force or moment all of whose components are listed.
fn is_of_listed_reaction(quantity: Quantity, reactions: &JointReactions) -> bool {
    match quantity {
        Quantity::Reaction(_) => true,
        Quantity::ForceMagnitude(joint) => reactions.lists_whole(joint)[0],
        Quantity::MomentMagnitude(joint) => reactions.lists_whole(joint)[1],
        _ => false,
    }
}

/// Whether a scene that lists reactions, and no variables, gets it as well.
fn goes_with_reactions(scene: &SpaceScene, quantity: Quantity) -> bool {
    match quantity {
        Quantity::ActuatorCoordinate(..) | Quantity::ActuatorForce(_) | Quantity::Extra(_) => true,
        Quantity::PointInSpace(body, at, _) => {
            let mut paths = scene.paths.iter();
            paths.any(|path| path.body == body && path.at == at)
        }
        _ => false,
    }
}

/// Rejects requested columns that no analysis of a scene has.
///
/// # Errors
/// [`StudyError::Scene`] at the first of them.
pub(crate) fn reject_unknown_variables(
    scene: &SpaceScene,
    (reactions, plan): (&JointReactions, &Plan),
) -> Result<(), StudyError> {
    let Some(variables) = &scene.variables else {
        return Ok(());
    };
    // Another analysis than `simulate` does not fail where the motion's machine cannot be built.
    let machine = scene.motion.as_ref().and_then(|_| scene.machine(&[]).ok());
    let mut columns = all_columns(scene, (reactions, plan), (Analysis::FreeMotion, true));
    columns.extend(machine.map_or_else(Vec::new, |machine| extra_columns(scene, &machine)));
    let is_known = |name: &str| columns.iter().any(|column| column.matches(name));
    let mut names = variables.iter().enumerate();
    let Some((k, name)) = names.find(|(_, name)| !is_known(name)) else {
        return Ok(());
    };
    let open = reactions.indeterminate.iter();
    let mut open = open.map(|reaction| scene.reaction_name(*reaction));
    let (message, help) = match open.any(|open| is_prefix_of(name, &open)) {
        true => (
            format!("`{name}` is statically indeterminate: redundant constraints share the load"),
            "`dwell check` lists such reactions; replace a joint of the loop by one with more freedoms".to_owned(),
        ),
        false => (
            format!("there is no column `{name}`"),
            suggestion(name, &columns),
        ),
    };
    let place = (SceneLocation::Variable(k), "no such column");
    Err(scene_error(scene, message, help, [place]))
}
