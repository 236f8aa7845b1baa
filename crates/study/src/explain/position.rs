//! Explains positions that cannot be computed.

use crate::explain::{StudyError, body_names, joint_labels, labels, scene_error};
use crate::number_format::{coordinate_unit, digits, number};
use dwell_geometry::{ActuatorId, Plan, PositionError};
use dwell_scene::{Scene, SceneLocation};

/// The name of the coordinate, quoted.
pub(crate) fn quoted_coordinate(scene: &Scene) -> String {
    let first = scene.mechanism.actuators.first();
    first.map_or_else(|| "the coordinate".to_owned(), |a| format!("`{}`", a.name))
}

/// Explains a position that cannot be computed. One arm for each error, so longer than a screen.
pub fn explain_position(scene: &Scene, plan: &Plan, error: &PositionError) -> StudyError {
    const RANGE_ENDS: &str = "this is outside the range; `dwell check` shows the range";
    let phi = quoted_coordinate(scene);
    let unit = coordinate_unit(plan.is_angle(0));
    let (PositionError::NoAssembly { q, .. }
    | PositionError::Singular { q, .. }
    | PositionError::OtherBranch { q, .. }
    | PositionError::NotConverged { q, .. }
    | PositionError::OutOfRange { q, .. }
    | PositionError::LanesDiverge { q }
    | PositionError::NotFinite { q }) = *error;
    let at = format!("{phi} = {} {unit}", number(q));
    let group = error.group();
    let bodies = group.map(|g| body_names(&scene.mechanism, &plan.group_bodies(g)));
    let bodies = bodies.unwrap_or_default();
    let (message, help) = match *error {
        PositionError::NoAssembly { gap, .. } => {
            let gap = digits(gap, 3);
            let message = format!("{bodies} cannot reach each other at {at}: gap of {gap} m");
            (message, RANGE_ENDS)
        }
        PositionError::Singular { .. } => (
            format!(
                "{bodies} are in a singular configuration at {at}: {phi} does not determine their motion there"
            ),
            match plan.range().limits() {
                None => "it is a change point: change a length, or drive another joint",
                Some(_) => RANGE_ENDS,
            },
        ),
        PositionError::OtherBranch { .. } => (
            format!("{bodies} can only be assembled in another assembly mode at {at}"),
            "two assembly modes are close to each other there",
        ),
        PositionError::NotConverged { residual, .. } => {
            let what = format!("the positions of {bodies} could not be computed at {at}");
            let message = format!("{what}: residual {} m", digits(residual, 3));
            (message, RANGE_ENDS)
        }
        PositionError::OutOfRange { from, to, .. } => {
            let [from, to] = [from, to].map(number);
            let message = format!("{at} is outside its range, {from} to {to} {unit}");
            (message, "start within the range; `dwell check` shows it")
        }
        PositionError::LanesDiverge { .. } => (
            format!("the poses near {at} cannot be evaluated together in SIMD lanes"),
            "evaluate them one by one",
        ),
        PositionError::NotFinite { .. } => (
            format!("{phi} = {q} {unit} is not a finite number"),
            "check the numbers of the motion",
        ),
    };
    let places = match group.map(|g| plan.group_joints(g)) {
        Some(joints) if !joints.is_empty() => joint_labels(&joints, "cannot stay joined there"),
        _ => {
            let at = SceneLocation::InitialCoordinate(ActuatorId(0));
            labels([at].into_iter(), "this coordinate")
        }
    };
    scene_error(scene, message, help, places)
}
