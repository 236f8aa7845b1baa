//! Origins and angles of the bodies' frames in the ground's axes.

use crate::mechanism::{BodyId, Mechanism};
use crate::plan::{Plan, Pose};
use crate::plane::Vec2;
use dwell_numerics::{Constant, Scalar};

impl Plan {
    /// The orientation (cos, sin) of a body.
    pub fn body_rotation(&self, body: BodyId, pose: &Pose<f64>) -> Vec2 {
        let orientation = self.frames.orientations[body.0];
        pose.rotation[orientation.frame].rotate(orientation.offset)
    }

    /// The angle of a body's frame, rad. It counts whole revolutions if actuators turn the frame from the ground, or if
    /// a coupling or load needs them. Otherwise it is in (−π, π].
    pub fn body_angle(&self, body: BodyId, pose: &Pose<f64>) -> f64 {
        let counted = self.counted_angle(body.0, pose);
        counted.unwrap_or_else(|| self.body_rotation(body, pose).angle())
    }

    /// Whether the angle of this body is known over all revolutions: it is counted, or actuators alone determine it.
    pub fn counts_revolutions(&self, body: BodyId) -> bool {
        let frame = self.frames.orientations[body.0].frame;
        self.revolution_counted[frame] || self.frames.frames[frame].orientation_class == 0
    }

    /// The frame of every body, the ground's included: origin x, y (m) and
    /// [angle](Self::body_angle), rad.
    pub fn body_frames(&self, mechanism: &Mechanism, pose: &Pose<f64>) -> Vec<[f64; 3]> {
        let mut joint_origins = Vec::new();
        self.joint_origins(pose, &mut joint_origins);
        let mut frames = vec![[0.0; 3]; mechanism.bodies.len()];
        for (moving_body, joint_origin) in self.moving_bodies.iter().zip(&joint_origins) {
            if moving_body.body >= frames.len() {
                continue;
            }
            let rotation = self.body_rotation(BodyId(moving_body.body), pose);
            let origin = *joint_origin - self.tree.joint_origins[moving_body.body].rotate(rotation);
            let angle = self.body_angle(BodyId(moving_body.body), pose);
            frames[moving_body.body] = [origin.x, origin.y, angle];
        }
        frames
    }
}

impl<C: Constant> Plan<C> {
    /// The angle of a body's frame with its whole revolutions, rad; `None` unless actuators turn the frame from the
    /// ground or a coupling or load needs it.
    pub(crate) fn counted_angle<T: Scalar>(&self, body: usize, pose: &Pose<T>) -> Option<T> {
        let orientation = self.frames.orientations[body];
        let offset = orientation.offset_angle;
        if self.revolution_counted[orientation.frame] {
            let revolution_offset = self.revolution_offsets.get(body).copied().unwrap_or(0.0);
            return Some(pose.angle[orientation.frame] + T::from_f64(offset + revolution_offset));
        }
        let angle = self.actuated_angle(orientation.frame, pose)?;
        Some(angle + T::from_f64(offset))
    }

    /// The angle of a frame that actuators alone rotate from the ground's, rad.
    fn actuated_angle<T: Scalar>(&self, frame: usize, pose: &Pose<T>) -> Option<T> {
        if self.frames.frames[frame].orientation_class != 0 {
            return None;
        }
        let mut angle = T::from_f64(0.0);
        for (actuator, sign) in self.frames.turned_by(frame) {
            angle += T::from_f64(sign) * pose.q[actuator];
        }
        Some(angle)
    }
}
