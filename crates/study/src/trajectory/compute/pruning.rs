//! Pruning: a trajectory analysis models only the groups that inertia, a load or a request needs.

use crate::models::requested_reaction_bodies;
use crate::trajectory::compute::all_columns;
use dwell_geometry::BodyId;
use dwell_kinetostatics::Model;
use dwell_scene::Scene;

/// The bodies that the requests of a scene need; `None` if no `variables` are named, so that every
/// column is computed.
pub(crate) fn requested_bodies(scene: &Scene, model: &Model) -> Option<Vec<BodyId>> {
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
pub(crate) fn prune_model(scene: &Scene, model: &Model) -> Model {
    match requested_bodies(scene, model) {
        None => model.clone(),
        Some(bodies) => model.clone().pruned_for(&bodies),
    }
}
