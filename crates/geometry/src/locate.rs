//! Where the bodies are, in the ground's axes: for those who draw or check them.

use crate::mechanism::{BodyId, Mechanism};
use crate::plan::{Plan, Pose};
use crate::plane::Vec2;

impl Plan {
    /// The orientation (cos, sin) of a body.
    pub fn body_turn(&self, body: BodyId, pose: &Pose<f64>) -> Vec2 {
        let attitude = self.frames.attitudes[body.0];
        pose.turn[attitude.frame].turn(attitude.offset)
    }

    /// The frame of every body, the ground's included: origin x, y (m) and angle in (−π, π] rad.
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
            frames[carried.body] = [origin.x, origin.y, turn.angle()];
        }
        frames
    }
}
