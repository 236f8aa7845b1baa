//! Closed forms of a scene, and their comparison with the exact model.

use crate::explain::{
    Labels, StudyError, body_names_or_mechanism, joint_labels, not_one_actuator, scene_error,
};
use crate::models::{reduced_model, requested_reactions};
use crate::symbolic::closed_form_check::ClosedFormCheck;
use crate::trajectory::compute::reject_unknown_variables;
use dwell_findings::Finding;
use dwell_geometry::Reaction;
use dwell_kinetostatics::ExactModel;
use dwell_scene::{PlaneScene, SceneLocation};
use dwell_symbolic::{ClosedForm, Symbolic, SymbolicError};

/// The closed forms of a scene and all its reactions, compared with the exact model at 24 positions; no findings
/// if it is not made of dyads or has several actuators.
///
/// # Errors
/// [`StudyError`] when the mechanism cannot be put together.
pub fn symbolic_findings(scene: &PlaneScene) -> Result<Vec<Finding>, StudyError> {
    if scene.mechanism.actuators.len() != 1 || !scene.varying_inertias.is_empty() {
        return Ok(Vec::new());
    }
    let exact = full_reduced_model(scene)?;
    let plan = exact.model().plan();
    let Ok(symbolic) = Symbolic::new(&scene.mechanism, &scene.masses, plan) else {
        return Ok(Vec::new());
    };
    let mut check = ClosedFormCheck::new(scene, &exact);
    let reactions = scene.mechanism.reactions();
    let determinate = (0..reactions.len()).filter(|&k| plan.is_determinate(k));
    for k in determinate {
        let form = symbolic.closed_form(Some(reactions[k]));
        let form = form.map_err(|e| explain_symbolic(scene, &e))?;
        check.compare(&form, Some(reactions[k]));
    }
    Ok(check.findings())
}

/// The exact model with every reaction.
fn full_reduced_model(scene: &PlaneScene) -> Result<ExactModel, StudyError> {
    if scene.mechanism.actuators.len() != 1 {
        return Err(not_one_actuator(scene));
    }
    reduced_model(scene, &scene.mechanism.reactions())
}

fn find_reaction(scene: &PlaneScene, name: &str) -> Result<Reaction, StudyError> {
    let all = scene.mechanism.reactions();
    let names = all.iter().map(|&r| scene.mechanism.reaction_name(r));
    let names: Vec<String> = names.collect();
    let found = names.iter().position(|other| other == name);
    found.map(|k| all[k]).ok_or_else(|| {
        let message = format!("there is no reaction `{name}`");
        let help = format!("the reactions are {}", names.join(", "));
        scene_error(scene, message, help, Labels::new())
    })
}

fn explain_symbolic(scene: &PlaneScene, error: &SymbolicError) -> StudyError {
    match error {
        SymbolicError::ActuatorCount(_) => not_one_actuator(scene),
        SymbolicError::Group {
            bodies,
            joints,
            what,
            ..
        } => scene_error(
            scene,
            format!(
                "there is no closed form for the position of {}: {what}",
                body_names_or_mechanism(&scene.mechanism, bodies)
            ),
            "closed forms exist for mechanisms made of dyads only; `dwell reduce` computes the same quantities \
             of any mechanism with one degree of freedom",
            joint_labels(joints, "closes the group"),
        ),
        SymbolicError::Reaction(reaction) => {
            let name = scene.mechanism.reaction_name(*reaction);
            let message = format!("`{name}` is statically indeterminate");
            let help = "redundant constraints share the load: name another reaction";
            scene_error(
                scene,
                message,
                help,
                joint_labels(&[reaction.joint], "redundant"),
            )
        }
        SymbolicError::Position(error) => scene_error(scene, error.to_string(), "", Labels::new()),
    }
}

/// Closed forms of a scene in the plane, and their comparison with the exact model.
pub(crate) fn closed_form_in_plane(
    scene: &PlaneScene,
    reaction: Option<&str>,
) -> Result<(ClosedForm, Vec<Finding>), StudyError> {
    reject_unknown_variables(scene)?;
    if let Some(varying) = scene.varying_inertias.first() {
        let name = scene.mechanism.body_name(varying.body);
        let message =
            format!("there is no closed form: the inertia of `{name}` is a table over its angle");
        let help = "`dwell reduce` gives m, ½m′, a and b at any position";
        let label = [(SceneLocation::VaryingInertia(varying.body), "a table")];
        return Err(scene_error(scene, message, help, label));
    }
    let exact = full_reduced_model(scene)?;
    let plan = exact.model().plan();
    let reaction = match reaction {
        Some(name) => Some(find_reaction(scene, name)?),
        None => requested_reactions(scene, plan)[0].first().copied(),
    };
    let explain = |e: SymbolicError| explain_symbolic(scene, &e);
    let symbolic = Symbolic::new(&scene.mechanism, &scene.masses, plan).map_err(explain)?;
    let form = symbolic.closed_form(reaction).map_err(explain)?;
    let mut check = ClosedFormCheck::new(scene, &exact);
    check.compare(&form, reaction);
    Ok((form, check.findings()))
}
