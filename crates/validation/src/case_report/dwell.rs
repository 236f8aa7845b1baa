//! The bodies over the range, and how long one of them stands still.

use dwell_geometry::{BodyId, Pose, Range, Vec2, vec2};
use dwell_kinetostatics::ReducedModel;
use dwell_study::bodies::{BodyPose, point_position};
use dwell_study::explain::explain_position;
use dwell_study::ranges::extent;
use dwell_study::{PreparedScene, StudyError};
use std::f64::consts::TAU;

/// Positions of the paths.
const PATH_POSITIONS: usize = 720;
/// The interval in which a body's angle stays within a band of its whole variation.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Dwell {
    /// The body.
    pub(crate) body: BodyId,
    /// From and to, rad of the coordinate; it may pass a whole revolution.
    pub(crate) from: f64,
    pub(crate) to: f64,
    /// How far its angle moves in it, and over the whole range, rad.
    pub(crate) variation: f64,
    pub(crate) swing: f64,
}

/// The bodies over the range.
pub(crate) struct RangePoses {
    pub(crate) q: Vec<f64>,
    /// By position and body: origin and orientation.
    pub(crate) body_poses: Vec<Vec<BodyPose>>,
}

impl RangePoses {
    pub(crate) fn new(prepared: &PreparedScene<'_>) -> Result<Self, StudyError> {
        let plan = prepared.model.model().plan();
        let mechanism = &prepared.scene.mechanism;
        let mut pose: Pose<f64> = plan.pose();
        let q = prepared.range_positions(PATH_POSITIONS);
        let mut body_poses = Vec::with_capacity(q.len());
        for &q in &q {
            plan.positions(&[q], &mut pose)
                .map_err(|e| explain_position(prepared.scene, plan, &e))?;
            let all = plan.body_frames(mechanism, &pose).into_iter().enumerate();
            let pose = |(b, [x, y, _]): (usize, [f64; 3])| {
                let rotation = match b == mechanism.ground {
                    true => Vec2::IDENTITY,
                    false => plan.body_rotation(BodyId(b), &pose),
                };
                (vec2(x, y), rotation)
            };
            body_poses.push(all.map(pose).collect());
        }
        Ok(Self { q, body_poses })
    }

    /// The position next to a coordinate, which of a range of whole revolutions is turned into it.
    pub(crate) fn nearest(&self, q: f64, full: bool) -> usize {
        let last = self.q.len() - 1;
        let (from, span) = (self.q[0], self.q[last] - self.q[0]);
        let fraction = match full {
            true => (q - from).rem_euclid(TAU) / span,
            false => ((q - from) / span).clamp(0.0, 1.0),
        };
        (fraction * last as f64).round() as usize
    }

    pub(crate) fn point(&self, position: usize, body: usize, at: Vec2) -> [f64; 2] {
        point_position(&self.body_poses[position], body, at)
    }
}

/// The dwell that a scene requests, if it does.
pub(crate) fn requested_dwell(prepared: &PreparedScene<'_>, poses: &RangePoses) -> Option<Dwell> {
    let full = prepared.model.range() == Range::Full;
    let request = prepared.scene.requests.dwell.as_ref();
    request.map(|d| find_dwell(poses, d.body, d.relative_band, full))
}

/// A body's angles over the range without jumps, rad.
pub(crate) fn unwrapped_angles(poses: &RangePoses, body: BodyId) -> Vec<f64> {
    let mut angles: Vec<f64> = Vec::with_capacity(poses.q.len());
    for bodies in &poses.body_poses {
        let angle = bodies[body.0].1.angle();
        let last = angles.last();
        let revolutions = last.map_or(0.0, |last| ((last - angle) / TAU).round());
        angles.push(angle + revolutions * TAU);
    }
    angles
}

/// The longest interval in which a body's angle stays within `band` of its whole variation.
fn find_dwell(poses: &RangePoses, body: BodyId, band: f64, full: bool) -> Dwell {
    let mut angles = unwrapped_angles(poses, body);
    let width = |some: &[f64]| {
        let [low, high] = extent(some.iter().copied());
        high - low
    };
    let swing = width(&angles);
    let mut q = poses.q.clone();
    let n = q.len();
    if full {
        // A dwell may pass the end of the revolution.
        let gain = angles[n - 1] - angles[0];
        angles.extend(angles.clone().iter().skip(1).map(|a| a + gain));
        q.extend(poses.q.iter().skip(1).map(|q| q + TAU));
    }
    let (mut best, mut from) = ((0, 0), 0);
    for to in 0..q.len() {
        while width(&angles[from..=to]) > band * swing {
            from += 1;
        }
        if to - from > best.1 - best.0 && from < n && to - from < n {
            best = (from, to);
        }
    }
    Dwell {
        body,
        from: q[best.0],
        to: q[best.1],
        variation: width(&angles[best.0..=best.1]),
        swing,
    }
}
