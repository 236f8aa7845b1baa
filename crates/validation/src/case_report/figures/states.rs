//! A mechanism in the states in which it was checked, and its actuators' forces there.

use super::mechanism::{drawing, paths};
use crate::case_report::dwell::RangePoses;
use crate::checked::states::CheckedStates;
use dwell_geometry::{Vec2, vec2};
use dwell_report::{Axis, Figure, Series};
use dwell_scene::PlaneScene;
use dwell_study::bodies::BodyPose;
use dwell_study::number_format::count;
use dwell_study::output::{MechanismDrawing, chart, figure, symbol};

/// Number of positions in which the mechanism is drawn.
const DRAWN_POSITIONS: usize = 5;

/// The mechanism in several states, with the paths of its points.
pub(crate) fn states_drawing(scene: &PlaneScene, checked: &CheckedStates) -> Figure {
    let body_poses = checked.body_poses.iter().map(|bodies| {
        let body_pose = |&[x, y, angle]: &[f64; 3]| (vec2(x, y), Vec2::from_angle(angle));
        bodies.iter().map(body_pose).collect()
    });
    let poses = RangePoses {
        q: Vec::new(),
        body_poses: body_poses.collect(),
    };
    let mechanism =
        MechanismDrawing::new(scene, &poses.body_poses).with_paths(paths(scene, &poses));
    let mut shapes = Vec::new();
    let positions = distinct_positions(&poses.body_poses);
    for (k, &position) in positions.iter().enumerate().rev() {
        let lightness = if k == 0 { 0.0 } else { 0.62 + 0.05 * k as f64 };
        mechanism.draw(&poses.body_poses[position], lightness, &mut shapes);
    }
    let motion = checked.motion_text;
    let text = format!("Drawn in full at the beginning of {motion}, lighter further on.");
    let panels = vec![drawing("", shapes)];
    figure(
        scene,
        "mechanism",
        &scene.title,
        &text,
        panels,
        provenance(checked),
    )
}

/// Positions that differ as much as they can, the first before all, in the order of the motion: at equal time intervals
/// those after whole revolutions would coincide.
fn distinct_positions(body_poses: &[Vec<BodyPose>]) -> Vec<usize> {
    let points = || body_poses.iter().flatten().map(|(at, _)| at.norm());
    let size = points().fold(f64::MIN_POSITIVE, f64::max);
    let pose_distance = |a: usize, b: usize| {
        let bodies = body_poses[a].iter().zip(&body_poses[b]);
        let of = |(a, b): (&BodyPose, &BodyPose)| (a.0 - b.0).norm() / size + (a.1 - b.1).norm();
        bodies.map(of).sum::<f64>()
    };
    let mut chosen = vec![0];
    while chosen.len() < DRAWN_POSITIONS.min(body_poses.len()) {
        let nearest = |k: &usize| {
            let distances = chosen.iter().map(|&c| pose_distance(c, *k));
            distances.fold(f64::INFINITY, f64::min)
        };
        let next_position = (0..body_poses.len()).max_by(|a, b| nearest(a).total_cmp(&nearest(b)));
        chosen.extend(next_position);
    }
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// The actuator forces along those states.
pub(crate) fn actuator_forces(scene: &PlaneScene, checked: &CheckedStates) -> Figure {
    let drawn = &checked.actuator_forces;
    let panel = |(k, actuator): (usize, &dwell_geometry::Actuator)| {
        let unit = actuator.coordinate().force_unit();
        let what = if unit == "N" { "force" } else { "moment" };
        let points = drawn.iter().map(|(t, forces)| [*t, forces[k]]);
        let title = format!("Actuator {what} of {}", symbol(&actuator.name));
        let line = vec![Series::line("", points.collect())];
        chart(title, Axis::new("time", "s"), Axis::new(what, unit), line).into()
    };
    let actuators = scene.mechanism.actuators.iter().enumerate();
    let text = format!("Along {}, under the loads.", checked.motion_text);
    let panels = actuators.map(panel).collect();
    figure(
        scene,
        "actuator-forces",
        "Actuator forces",
        &text,
        panels,
        provenance(checked),
    )
}

fn provenance(checked: &CheckedStates) -> String {
    format!(
        "the mechanism at {}",
        count(checked.body_poses.len(), "state")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_after_whole_revolutions_are_not_drawn_over_each_other() {
        // Five revolutions in 120 steps: at equal distances all would be the first.
        let rotation = |k: usize| Vec2::from_angle(std::f64::consts::TAU * 5.0 * k as f64 / 120.0);
        let frames: Vec<Vec<BodyPose>> = (0..=120)
            .map(|k| vec![(rotation(k), rotation(k))])
            .collect();
        let chosen = distinct_positions(&frames);
        assert_eq!((chosen.len(), chosen[0]), (DRAWN_POSITIONS, 0));
        for (i, &a) in chosen.iter().enumerate() {
            for &b in &chosen[..i] {
                assert!((rotation(a) - rotation(b)).norm() > 0.5);
            }
        }
        assert_eq!(distinct_positions(&frames[..1]), [0]);
    }
}
