//! Why a mechanism has no closed form.

use dwell_geometry::{BodyId, JointId, PositionError, Reaction};
use thiserror::Error;

/// Why there are no closed forms of a mechanism, or of one of its reactions.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SymbolicError {
    /// Not one coordinate.
    #[error("closed forms need exactly one actuator; the mechanism has {0}")]
    ActuatorCount(usize),
    /// A group that is not a dyad, or another one without a closed form.
    #[error("a group has no closed form: {what}")]
    Group {
        /// Its place in the order of solution.
        group: usize,
        /// The bodies that it places.
        bodies: Vec<BodyId>,
        /// The joints that close it.
        joints: Vec<JointId>,
        /// What has no closed form.
        what: &'static str,
    },
    /// A reaction that the loads do not determine, or that no joint has.
    #[error("the reaction is not determined")]
    Reaction(Reaction),
    /// The mechanism cannot be placed at its start.
    #[error(transparent)]
    Position(#[from] PositionError),
}
