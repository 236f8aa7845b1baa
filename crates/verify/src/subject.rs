//! What is checked: anything that yields the results of a mechanism of one degree of freedom.

pub use dwell_kinetostatics::Coefficients;

/// Why a subject could not answer.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{message} (at q = {q})")]
pub struct SubjectError {
    /// The coordinate it was asked at, rad.
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

/// A result to be checked. It is asked from several threads at once, and a question must have the
/// same answer whatever was asked before.
pub trait Subject: Sync {
    /// The frame [x, y, θ] of every body, the ground included, in m and rad.
    fn poses(&self, q: f64) -> Result<Vec<[f64; 3]>, SubjectError>;

    /// The reduced coefficients at `q`; reactions are in the order of [`dwell_geometry::Mechanism::reactions`].
    fn coefficients(&self, q: f64) -> Result<Coefficients, SubjectError>;

    /// Forces at (`q`, `q_dot`, `q_ddot`) in rad, rad/s, rad/s².
    fn inverse_dynamics(
        &self,
        q: f64,
        q_dot: f64,
        q_ddot: f64,
    ) -> Result<InverseDynamics, SubjectError>;
}
