//! Where the bodies are, in the ground's axes: for those who draw or check them.

use crate::frames::Turning;
use crate::mechanism::{BodyId, Mechanism};
use crate::plan::{Plan, Pose};
use crate::plane::Vec2;
use crate::scalar::Scalar;

impl Plan {
    /// The orientation (cos, sin) of a body.
    pub fn body_turn(&self, body: BodyId, pose: &Pose<f64>) -> Vec2 {
        let attitude = self.frames.attitudes[body.0];
        pose.turn[attitude.frame].turn(attitude.offset)
    }

    /// The angle of a body's frame, rad: whole turns are counted where actuators turn it from the
    /// ground or a relation or load needs them, else it is in (−π, π].
    pub fn body_angle(&self, body: BodyId, pose: &Pose<f64>) -> f64 {
        let counted = self.counted_angle(body.0, pose);
        counted.unwrap_or_else(|| self.body_turn(body, pose).angle())
    }

    /// The angle of a body's frame with its whole turns, rad, where actuators turn it from the
    /// ground or a relation or load needs it.
    pub fn counted_angle<T: Scalar>(&self, body: usize, pose: &Pose<T>) -> Option<T> {
        let attitude = self.frames.attitudes[body];
        let offset = attitude.offset.angle();
        if self.counted[attitude.frame] {
            let whole = self.turns.get(body).copied().unwrap_or(0.0);
            return Some(pose.angle[attitude.frame] + T::lift(offset + whole));
        }
        let angle = self.driven_turn(attitude.frame, pose)?;
        Some(angle + T::lift(offset))
    }

    /// Whether [`counted_angle`](Self::counted_angle) knows this body.
    pub fn counts_turns(&self, body: BodyId) -> bool {
        let frame = self.frames.attitudes[body.0].frame;
        self.counted[frame] || self.frames.frames[frame].class == 0
    }

    /// The angle of a frame that actuators turn from the ground's.
    fn driven_turn<T: Scalar>(&self, mut frame: usize, pose: &Pose<T>) -> Option<T> {
        let mut angle = T::lift(0.0);
        loop {
            match self.frames.frames[frame].turning {
                Turning::Ground => return Some(angle),
                Turning::Unknown => return None,
                Turning::Driven {
                    parent,
                    actuator,
                    sign,
                } => {
                    angle += T::lift(sign) * pose.q[actuator];
                    frame = parent;
                }
            }
        }
    }

    /// The frame of every body, the ground's included: origin x, y (m) and
    /// [angle](Self::body_angle), rad.
    pub fn body_frames(&self, mechanism: &Mechanism, pose: &Pose<f64>) -> Vec<[f64; 3]> {
        let mut roots = Vec::new();
        self.roots(pose, &mut roots);
        let mut frames = vec![[0.0; 3]; mechanism.bodies.len()];
        for (carried, root) in self.carried.iter().zip(&roots) {
            if carried.body >= frames.len() {
                continue;
            }
            let turn = self.body_turn(BodyId(carried.body), pose);
            let origin = *root - self.tree.roots[carried.body].turn(turn);
            let angle = self.body_angle(BodyId(carried.body), pose);
            frames[carried.body] = [origin.x, origin.y, angle];
        }
        frames
    }
}
