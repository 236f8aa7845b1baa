//! A mechanism along the states in which it was judged, and what its actuators do there.

use super::foot;
use super::mechanism::{Sweep, paths};
use super::skeleton::Skeleton;
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
    let last = sweep.frames.len().saturating_sub(1);
    let skeleton = Skeleton::new(scene, &sweep.frames);
    let mut shapes = paths(scene, &sweep);
    for k in (0..DRAWN).rev() {
        let position = k * last / DRAWN;
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

/// What the actuators do along those states.
pub(crate) fn actions(scene: &Scene, judged: &Judged) -> Figure {
    let drawn = &judged.states[..judged.drawn];
    let panel = |(k, actuator): (usize, &dwell_geometry::Actuator)| {
        let (what, unit) = match actuator.coordinate().is_angle() {
            true => ("couple", "N m"),
            false => ("force", "N"),
        };
        Panel::from(Chart {
            title: format!("Action of {}", actuator.name),
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
