//! The positions at which a mechanism is checked.

use dwell_geometry::Plan;
use dwell_scene::PlaneScene;
use dwell_verify::spread;
use std::f64::consts::TAU;

/// Positions or states at which a fault is checked.
pub(super) const POSITIONS: usize = 3;
/// The largest step of a coordinate, rad or m: whole revolutions are counted.
const MAX_COORDINATE_STEP: f64 = 0.05;
/// The margin at both ends of a range, as a part of it.
const RANGE_MARGIN: f64 = 0.1;

/// Some positions inside the range, or near the start where there are several actuators.
pub(super) fn positions(scene: &PlaneScene, plan: &Plan) -> Vec<Vec<f64>> {
    let start = plan.assembly_coordinates();
    if start.len() > 1 {
        let near = |k: usize| {
            let shifted = |(i, q): (usize, &f64)| {
                let step = if plan.is_angle(i) { 0.1 } else { 0.01 };
                q + step * (k + 1) as f64 * if i % 2 == 0 { 1.0 } else { -1.0 }
            };
            start.iter().enumerate().map(shifted).collect()
        };
        return (0..POSITIONS).map(near).collect();
    }
    let range = match (plan.range().limits(), &scene.sweep) {
        (_, Some(sweep)) if sweep.range.is_some() => {
            let [low, high] = sweep.range.unwrap_or_default();
            dwell_geometry::Range::Limited(low, high)
        }
        (Some((low, high)), _) => {
            let margin = RANGE_MARGIN * (high - low);
            dwell_geometry::Range::Limited(low + margin, high - margin)
        }
        (None, _) => dwell_geometry::Range::Full,
    };
    spread(range, POSITIONS)
        .into_iter()
        .map(|q| vec![q])
        .collect()
}

/// The frames at the start and at some positions, whole revolutions counted.
pub(super) fn poses_along(
    scene: &PlaneScene,
    plan: &Plan,
    positions: &[Vec<f64>],
) -> (Vec<[f64; 3]>, Vec<Vec<[f64; 3]>>) {
    let mut pose = plan.pose::<f64>();
    let mut at = plan.assembly_coordinates().to_vec();
    plan.positions(&at, &mut pose).expect("a start");
    let first = plan.body_frames(&scene.mechanism, &pose);
    let (mut poses, mut all) = (first.clone(), Vec::new());
    for to in positions {
        let distance = at
            .iter()
            .zip(to)
            .map(|(a, b)| (b - a).abs())
            .fold(0.0, f64::max);
        let steps = (distance / MAX_COORDINATE_STEP).ceil().max(1.0);
        for k in 1..=steps as usize {
            let fraction = k as f64 / steps;
            let q: Vec<f64> = at
                .iter()
                .zip(to)
                .map(|(a, b)| a + fraction * (b - a))
                .collect();
            plan.positions(&q, &mut pose).expect("a pose");
            for (body_pose, next) in poses
                .iter_mut()
                .zip(plan.body_frames(&scene.mechanism, &pose))
            {
                let revolutions = ((body_pose[2] - next[2]) / TAU).round();
                *body_pose = [next[0], next[1], next[2] + revolutions * TAU];
            }
        }
        at.clone_from(to);
        all.push(poses.clone());
    }
    (first, all)
}
