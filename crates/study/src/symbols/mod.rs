//! Symbols and outlines of a mechanism in the plane, for pictures and pages. They follow from its motion and its size.

mod kinematic;
mod loads;
mod outline;
mod parts;

#[cfg(feature = "output")]
pub(crate) use kinematic::{circle, spring_outline};
use kinematic::{pitch_curve, rack_outline};
pub(crate) use loads::link_of;
use outline::{blocks_on, common_joint_name, is_cylinder, outline_of, reach};
pub(crate) use parts::{DrawnIn, PlaneParts, anchor, anchors, point};

use crate::bodies::{BodyPose, point_position};
use crate::ranges::extent;
use dwell_geometry::{Joint, vec2};
use dwell_scene::PlaneScene;
use kinematic::drawn_size;

/// Reference length of the symbols, in sizes of the mechanism.
const SYMBOL_RATIO: f64 = 0.6;
/// Limits of the size of symbols relative to the whole drawing: smaller symbols could not be recognised, larger ones would hide it. The
/// size of a mechanism without lengths is 1 m.
const MIN_SYMBOL_RATIO: f64 = 0.4;
const MAX_SYMBOL_RATIO: f64 = 0.85;
/// Half the distance of the rails of a guide, and of a slot, and the height of the teeth of a rack, in reference lengths.
const RAIL_DISTANCE: f64 = 0.055;
const SLOT_DISTANCE: f64 = 0.035;
const TOOTH: f64 = 0.012;
/// Length of a track beyond the travel, in reference lengths.
const TRACK_MARGIN: f64 = 0.25;

/// The reference length of the symbols of a scene that is drawn at these positions, m.
fn symbol_size(scene: &PlaneScene, positions: &[Vec<BodyPose>]) -> f64 {
    let (size, drawn) = (scene.mechanism.size(), drawn_size(scene, positions));
    let bound = if drawn > 0.0 { drawn } else { f64::INFINITY };
    (SYMBOL_RATIO * size).clamp(MIN_SYMBOL_RATIO * drawn, MAX_SYMBOL_RATIO * bound)
}

/// By joint: the range of its second point along its axis over all positions, m.
fn travels(scene: &PlaneScene, positions: &[Vec<BodyPose>]) -> Vec<Option<[f64; 2]>> {
    let travel = |joint: &Joint| {
        let axis = joint.kind.line()?;
        let [one, two] = joint.bodies.map(|b| b.0);
        let travel_along = |body_poses: &Vec<BodyPose>| {
            let at = |body, k: usize| point_position(body_poses, body, joint.points[k]);
            let [a, b] = [at(one, 0), at(two, 1)].map(|[x, y]| vec2(x, y));
            axis.rotate(body_poses[one].1).dot(b - a)
        };
        let limits = extent(positions.iter().map(travel_along));
        (limits[0] <= limits[1]).then_some(limits)
    };
    scene.mechanism.joints.iter().map(travel).collect()
}
