//! What a run models: the groups that inertia, a load or a request needs, and no other.

use crate::prepare::reacting;
use crate::run::columns::Columns;
use dwell_geometry::BodyId;
use dwell_kinetostatics::Model;
use dwell_scene::Scene;

/// The bodies that the requests of a scene need; none where everything is wanted, because no
/// `variables` are named.
pub(crate) fn wanted(scene: &Scene, model: &Model) -> Option<Vec<BodyId>> {
    let requests = &scene.requests;
    let names = requests.variables.as_ref()?;
    let mut bodies: Vec<BodyId> = requests.paths.iter().map(|p| p.body).collect();
    bodies.extend(requests.dwell.iter().map(|d| d.body));
    bodies.extend(requests.sections.iter().map(|s| s.body));
    // All reactions are what a scene requests that says nothing of them.
    if requests.reactions.len() < scene.mechanism.reactions().len() {
        bodies.extend(reacting(scene));
    }
    for column in Columns::all(scene, model, true) {
        if names.iter().any(|name| column.answers_to(name)) {
            bodies.extend(column.quantity.bodies(scene, model.reactions()));
        }
    }
    Some(bodies)
}

/// The model without what nothing needs.
pub(crate) fn lean(scene: &Scene, model: &Model) -> Model {
    match wanted(scene, model) {
        None => model.clone(),
        Some(bodies) => model.clone().only_for(&scene.mechanism, &bodies),
    }
}
