//! The kinematic symbols of a mechanism that follow from its motion or from its size: the curve of a cam, the teeth of a
//! rack, the rails of a guide.

use crate::bodies::{BodyPose, point_position};
use crate::ranges::extent;
use dwell_geometry::{Coordinate, Coupling, JointKind, Vec2, vec2};
use dwell_scene::PlaneScene;
use std::f64::consts::{PI, TAU};

/// A relation that is linear to this fraction of its range is that of a gear or a screw, not of a cam.
const STRAIGHT: f64 = 1e-6;

/// Number of corners of a circle.
#[cfg(feature = "output")]
const CIRCLE_POINTS: usize = 72;
/// Number of coils of a spring.
#[cfg(feature = "output")]
const SPRING_COILS: usize = 7;

/// The pitch curve of a cam: the path of the follower's point in the cam's frame.
#[derive(Debug, Clone)]
pub(crate) struct PitchCurve {
    /// The cam.
    pub(crate) body: usize,
    /// Points in its frame, m.
    pub(crate) points: Vec<Vec2>,
    /// Whether it goes all the way round.
    pub(crate) closed: bool,
}

/// The pitch curve of a coupling that is a cam with its follower, from the positions in the order of the motion.
pub(crate) fn pitch_curve(
    scene: &PlaneScene,
    coupling: &Coupling,
    positions: &[Vec<BodyPose>],
) -> Option<PitchCurve> {
    let Coordinate::Angle([from, cam]) = coupling.independent else {
        return None;
    };
    let (follower, tip) = follower_point(scene, coupling)?;
    let first = positions.first()?;
    let mut turned = 0.0;
    let mut last = relative_angle(first, [from.0, cam.0]);
    let (mut points, mut samples) = (Vec::new(), Vec::new());
    for poses in positions {
        let angle = relative_angle(poses, [from.0, cam.0]);
        turned += (angle - last + PI).rem_euclid(TAU) - PI;
        last = angle;
        let (origin, rotation) = poses[cam.0];
        let [x, y] = point_position(poses, follower, tip);
        let inverse = vec2(rotation.x, -rotation.y);
        let in_cam = inverse.rotate(vec2(x, y) - origin);
        points.push(in_cam);
        samples.push([turned, in_cam.norm()]);
        if turned.abs() >= TAU {
            break;
        }
    }
    let [nearest, farthest] = extent(samples.iter().map(|[_, r]| *r));
    let is_curved = farthest - nearest > STRAIGHT * farthest;
    (is_curved && points.len() > 2).then_some(PitchCurve {
        body: cam.0,
        closed: turned.abs() > TAU - 0.1,
        points,
    })
}

/// The body that a cam moves, and its contact point: the point of its guide, or the point farthest from its pivot.
fn follower_point(scene: &PlaneScene, coupling: &Coupling) -> Option<(usize, Vec2)> {
    let mechanism = &scene.mechanism;
    match coupling.dependent {
        Coordinate::Travel(joint) => {
            let joint = &mechanism.joints[joint.0];
            Some((joint.bodies[1].0, joint.points[1]))
        }
        Coordinate::Angle(bodies) => {
            let is_pivot = |joint: &&dwell_geometry::Joint| {
                matches!(joint.kind, JointKind::Revolute)
                    && bodies.iter().all(|b| joint.bodies.contains(b))
            };
            let pivot = mechanism.joints.iter().find(is_pivot)?;
            let end = pivot.bodies.iter().position(|b| *b == bodies[1])?;
            let distance = |p: &Vec2| (*p - pivot.points[end]).norm();
            let points = scene.points[bodies[1].0].iter().map(|(_, p)| *p);
            let tip = points.max_by(|a, b| distance(a).total_cmp(&distance(b)))?;
            (distance(&tip) > 0.0).then_some((bodies[1].0, tip))
        }
        Coordinate::Length { .. } => None,
    }
}

fn relative_angle(poses: &[BodyPose], [from, to]: [usize; 2]) -> f64 {
    let inverse = vec2(poses[from].1.x, -poses[from].1.y);
    inverse.rotate(poses[to].1).angle()
}

/// The outline of a rack from one place to another: teeth along the pitch line, on the side that `normal` points to.
pub(crate) fn rack_outline([from, to]: [Vec2; 2], normal: Vec2, tooth: f64) -> Vec<Vec2> {
    let along = to - from;
    let length = along.norm();
    if length == 0.0 || tooth <= 0.0 {
        return Vec::new();
    }
    let teeth = (length / (4.0 * tooth)).round().clamp(1.0, 200.0) as usize;
    // A foot, two flanks and a tip for each tooth.
    let profile = [
        (0.0, -1.0),
        (0.25, -1.0),
        (0.4, 1.0),
        (0.6, 1.0),
        (0.75, -1.0),
    ];
    let place = |s: f64, height: f64| from + along * (s / teeth as f64) + normal * (height * tooth);
    let mut outline: Vec<Vec2> = (0..teeth)
        .flat_map(|k| profile.map(|(s, height)| place(k as f64 + s, height)))
        .collect();
    let end = teeth as f64;
    outline.extend([place(end, -1.0), place(end, -3.0), place(0.0, -3.0)]);
    outline
}

/// The larger side of the region that all points of all bodies cover, m.
pub(crate) fn drawn_size(scene: &PlaneScene, positions: &[Vec<BodyPose>]) -> f64 {
    let all = positions.iter().flat_map(|poses| {
        let bodies = scene.points.iter().take(poses.len()).enumerate();
        bodies.flat_map(move |(b, points)| {
            let points = points.iter();
            points.map(move |(_, p)| point_position(poses, b, *p))
        })
    });
    let all: Vec<[f64; 2]> = all.collect();
    let sides = [0, 1].map(|i| extent(all.iter().map(|p| p[i])));
    let sides = sides.into_iter().map(|[low, high]| high - low);
    sides.filter(|side| side.is_finite()).fold(0.0, f64::max)
}

/// The corners of a circle.
#[cfg(feature = "output")]
pub(crate) fn circle(at: Vec2, radius: f64) -> Vec<Vec2> {
    let corner = |k: usize| {
        let (sin, cos) = (TAU * k as f64 / CIRCLE_POINTS as f64).sin_cos();
        vec2(at.x + radius * cos, at.y + radius * sin)
    };
    (0..=CIRCLE_POINTS).map(corner).collect()
}

/// A zigzag between two points.
#[cfg(feature = "output")]
pub(crate) fn spring_outline(a: Vec2, b: Vec2, half: f64) -> Vec<Vec2> {
    let gap = b - a;
    if gap.norm() == 0.0 {
        return Vec::new();
    }
    let across = gap.perp() * (half / gap.norm());
    let zigzag_point = |k: usize| {
        let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let fraction = 0.15 + 0.7 * (k as f64 + 0.5) / (2 * SPRING_COILS) as f64;
        a + gap * fraction + across * sign
    };
    let mut points = vec![a, a + gap * 0.15];
    points.extend((0..2 * SPRING_COILS).map(zigzag_point));
    points.extend([a + gap * 0.85, b]);
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rack_has_its_teeth_on_the_side_of_the_wheel_and_keeps_its_length() {
        let ends = [vec2(1.0, 2.0), vec2(3.0, 2.0)];
        let outline = rack_outline(ends, vec2(0.0, 1.0), 0.05);
        let [left, right] = extent(outline.iter().map(|p| p.x));
        let [low, high] = extent(outline.iter().map(|p| p.y));
        assert!((left - 1.0).abs() < 1e-12 && (right - 3.0).abs() < 1e-12);
        assert!((low - 1.85).abs() < 1e-12 && (high - 2.05).abs() < 1e-12);
        // Ten teeth, each with two corners on its tip.
        assert_eq!(outline.iter().filter(|p| p.y > 2.04).count(), 20);
    }

    #[test]
    fn the_pitch_curve_of_a_cam_is_at_the_follower_s_travel() {
        let path = concat!(
            env!("CARGO_MANIFEST_DIR"),
            "/../../validation/cam/scene.toml"
        );
        let scene = PlaneScene::read(path).expect("a scene");
        let coupling = scene.mechanism.couplings.first().expect("a cam");
        let rise = |q: f64| 0.04 + 0.012 * (1.0 - q.cos()) + 0.003 * (1.0 - (2.0 * q).cos());
        let bodies = |name: &str| {
            let all = scene.mechanism.bodies.iter();
            all.map(|b| b.name.as_str())
                .position(|n| n == name)
                .expect("a body")
        };
        let (cam, follower) = (bodies("cam"), bodies("follower"));
        let pose = |k: usize| {
            let q = TAU * k as f64 / 90.0;
            let mut poses = vec![(Vec2::ZERO, Vec2::IDENTITY); scene.mechanism.bodies.len()];
            poses[cam].1 = Vec2::from_angle(q);
            poses[follower].0 = vec2(0.0, rise(q));
            poses
        };
        let positions: Vec<_> = (0..=90).map(pose).collect();
        let curve = pitch_curve(&scene, coupling, &positions).expect("a curve");
        assert!(curve.closed && curve.body == cam);
        for (k, p) in curve.points.iter().enumerate() {
            let q = TAU * k as f64 / 90.0;
            assert!((p.norm() - rise(q)).abs() < 1e-12);
            let expected = Vec2::from_angle(PI / 2.0 - q) * rise(q);
            assert!((*p - expected).norm() < 1e-12);
        }
        // A follower that keeps its distance shows no cam.
        let still: Vec<_> = (0..=90).map(|_| pose(0)).collect();
        assert!(pitch_curve(&scene, coupling, &still).is_none());
    }
}
