//! The subject of the checks: anything that yields the results of a mechanism of one degree of freedom.

use crate::pose::Pose;
use dwell_kinetostatics::Coefficients;

/// Why a subject could not answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{message} (at q = {q})")]
pub struct SubjectError {
    /// The requested coordinate, rad.
    pub q: f64,
    /// Why, as it reads after "the subject failed:".
    pub message: String,
}

/// Actuator force and reactions in a given state, without loads.
#[derive(Debug, Clone, PartialEq)]
pub struct InverseDynamics {
    /// The actuator force on its second body, N·m.
    pub tau: f64,
    /// Every reaction, of the joint's first body on its second, N or N·m.
    pub reactions: Vec<f64>,
}

/// A result to be checked. Several threads query it at once, and the answer to a query must not depend on earlier
/// queries.
pub trait Subject: Sync {
    /// Where every body is, the ground included.
    fn poses(&self, q: f64) -> Result<Vec<Pose>, SubjectError>;

    /// The frames [x, y, θ] of a mechanism in the plane, m and rad.
    ///
    /// # Errors
    /// As of the poses.
    fn frames(&self, q: f64) -> Result<Vec<[f64; 3]>, SubjectError> {
        let poses = self.poses(q)?;
        Ok(poses.iter().map(Pose::in_plane).collect())
    }

    /// The reduced coefficients at `q`, of every reaction: in the plane in the order of [`dwell_geometry::Mechanism::reactions`]; in space by
    /// joint the components of force and moment of the first body on the second about the joint's point on it, in the axes of the ground.
    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError>;

    /// Forces at (`q`, `q_dot`, `q_ddot`) in rad, rad/s, rad/s².
    fn inverse_dynamics(
        &self,
        q: f64,
        q_dot: f64,
        q_ddot: f64,
    ) -> Result<InverseDynamics, SubjectError>;
}
