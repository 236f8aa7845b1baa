//! The coordinates that an analysis of a scene in space follows.

use crate::space::prepared::range_limits;
use crate::trajectory::compute::FollowedScene;
use dwell_geometry::space::{ActuatorKind, Plan};
use dwell_scene::SpaceScene;

/// What gives the coordinates that an analysis of a scene follows.
pub(super) fn followed_scene<'a>(scene: &'a SpaceScene, plan: &Plan) -> FollowedScene<'a> {
    let actuators = &scene.mechanism.actuators;
    let coordinates = actuators.iter();
    let coordinates =
        coordinates.map(|a| (a.name.as_str(), matches!(a.kind, ActuatorKind::Angle(_))));
    FollowedScene {
        file: &scene.file,
        prescribed: scene.prescribed.as_ref(),
        sweep: scene.sweep.as_ref(),
        coordinates: coordinates.collect(),
        start: scene.assembly.q.clone(),
        period: plan.range().period(),
        default_limits: (actuators.len() == 1).then(|| range_limits(scene, plan)),
    }
}
