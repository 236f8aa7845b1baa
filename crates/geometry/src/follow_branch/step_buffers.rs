//! The stored steps along a branch. If closed forms give the poses from the coordinate alone, only the coordinates are
//! stored.

use crate::motion::Motion;
use crate::plan::{Plan, Pose};
use crate::positions::InitialIterate;
use dwell_numerics::Dual;

/// The results of a step, and working memory.
pub(super) struct StepBuffers {
    pub(super) reached: Pose<f64>,
    /// At unit velocity.
    pub(super) motion: Motion<f64>,
    pub(super) with_slopes: Pose<Dual>,
}

impl StepBuffers {
    pub(super) fn new(plan: &Plan) -> Self {
        Self {
            reached: plan.pose(),
            motion: plan.motion(),
            with_slopes: plan.pose(),
        }
    }
}

impl Plan {
    /// Whether a pose follows from its coordinate alone, without one to start from: by closed forms.
    pub(super) fn is_explicit(&self) -> bool {
        self.is_dyadic() && !self.groups.iter().any(|g| g.counts_revolutions)
    }

    /// Notes a pose; of an explicit plan its coordinate alone, as a mechanism of ten thousand loops has megabytes of them,
    /// until it is [completed](Self::complete_pose).
    pub(super) fn note_pose(&self, to: &mut Pose<f64>, pose: &Pose<f64>) {
        if self.is_explicit() {
            to.q.clone_from(&pose.q);
        } else {
            to.clone_from(pose);
        }
    }

    /// Computes a noted pose from its coordinate.
    pub(super) fn complete_pose(&self, pose: Option<&mut Pose<f64>>) {
        if let Some(pose) = pose.filter(|_| self.is_explicit()) {
            let q = [pose.q[0]];
            // It has been reached: it has a solution.
            let _ = self.positions_from(&q, pose, InitialIterate::CurrentPose);
        }
    }
}
