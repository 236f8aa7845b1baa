//! A mechanism along the states in which it was judged, and what its actuators do there.

use super::mechanism::{Sweep, paths};
use super::skeleton::{Frame, Skeleton};
use super::{foot, symbol};
use crate::states::Judged;
use crate::words::count;
use dwell_geometry::{Vec2, vec2};
use dwell_report::{Axis, Chart, Drawing, Figure, Panel, Series};
use dwell_scene::Scene;

/// Positions in which the mechanism is drawn, the first in full.
const DRAWN: usize = 5;
/// The mechanism in several states, with the paths of its points.
pub(crate) fn drawing(scene: &Scene, judged: &Judged) -> Figure {
    let frames = judged.frames.iter().map(|bodies| {
        let frame = |&[x, y, angle]: &[f64; 3]| (vec2(x, y), Vec2::from_angle(angle));
        bodies.iter().map(frame).collect()
    });
    let sweep = Sweep {
        q: Vec::new(),
        frames: frames.collect(),
    };
    let skeleton = Skeleton::new(scene, &sweep.frames);
    let mut shapes = paths(scene, &sweep);
    for (k, &position) in apart(&sweep.frames).iter().enumerate().rev() {
        let lightness = if k == 0 { 0.0 } else { 0.62 + 0.05 * k as f64 };
        skeleton.draw(&sweep.frames[position], lightness, &mut shapes);
    }
    Figure {
        name: "a-mechanism".to_owned(),
        title: scene.title.clone(),
        caption: foot(
            scene,
            &format!(
                "Drawn in full at the beginning of {}, lighter further on.",
                judged.motion
            ),
        ),
        columns: 1,
        panels: vec![Panel::from(Drawing {
            title: String::new(),
            x: Axis::new("x", "m"),
            y: Axis::new("y", "m"),
            shapes,
        })],
        provenance: format!("the mechanism at {}", count(judged.drawn, "state")),
    }
}

/// Positions that differ as much as they can, the first before all, in the order of the motion: at equal distances of
/// time those of whole turns would all be one.
fn apart(frames: &[Vec<Frame>]) -> Vec<usize> {
    let points = || frames.iter().flatten().map(|(at, _)| at.norm());
    let size = points().fold(f64::MIN_POSITIVE, f64::max);
    let distance = |a: usize, b: usize| {
        let bodies = frames[a].iter().zip(&frames[b]);
        let of = |(a, b): (&Frame, &Frame)| (a.0 - b.0).norm() / size + (a.1 - b.1).norm();
        bodies.map(of).sum::<f64>()
    };
    let mut chosen = vec![0];
    while chosen.len() < DRAWN.min(frames.len()) {
        let nearest = |k: &usize| {
            let distances = chosen.iter().map(|&c| distance(c, *k));
            distances.fold(f64::INFINITY, f64::min)
        };
        let farthest = (0..frames.len()).max_by(|a, b| nearest(a).total_cmp(&nearest(b)));
        chosen.extend(farthest);
    }
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// What the actuators do along those states.
pub(crate) fn actions(scene: &Scene, judged: &Judged) -> Figure {
    let drawn = &judged.states[..judged.drawn];
    let panel = |(k, actuator): (usize, &dwell_geometry::Actuator)| {
        let (what, unit) = match actuator.coordinate().is_angle() {
            true => ("couple", "N m"),
            false => ("force", "N"),
        };
        Panel::from(Chart {
            title: format!("Action of {}", symbol(&actuator.name)),
            x: Axis::new("time", "s"),
            y: Axis::new(what, unit),
            series: vec![Series::line(
                "",
                drawn.iter().map(|state| [state.t, state.tau[k]]).collect(),
            )],
            ..Chart::default()
        })
    };
    let actuators = scene.mechanism.actuators.iter().enumerate();
    Figure {
        name: "b-actions".to_owned(),
        title: "What the actuators do".to_owned(),
        caption: foot(scene, &format!("Along {}, under the loads.", judged.motion)),
        columns: 1,
        panels: actuators.map(panel).collect(),
        provenance: format!("the mechanism at {}", count(judged.drawn, "state")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_of_whole_turns_are_not_drawn_over_each_other() {
        // Five turns in 120 steps: at equal distances all would be the first.
        let turn = |k: usize| Vec2::from_angle(std::f64::consts::TAU * 5.0 * k as f64 / 120.0);
        let frames: Vec<Vec<Frame>> = (0..=120).map(|k| vec![(turn(k), turn(k))]).collect();
        let chosen = apart(&frames);
        assert_eq!((chosen.len(), chosen[0]), (DRAWN, 0));
        for (i, &a) in chosen.iter().enumerate() {
            for &b in &chosen[..i] {
                assert!((turn(a) - turn(b)).norm() > 0.5);
            }
        }
        assert_eq!(apart(&frames[..1]), [0]);
    }
}
