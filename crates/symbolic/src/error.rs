//! Why a mechanism has no closed form.

use dwell_geometry::{BodyId, JointId, PositionError, Reaction};
use thiserror::Error;

/// Why there are no closed forms of a mechanism, or of one of its reactions.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SymbolicError {
    /// The mechanism does not have exactly one actuator; with their number.
    #[error("closed forms need exactly one actuator; the mechanism has {0}")]
    ActuatorCount(usize),
    /// A group without a closed form, such as one larger than a dyad.
    #[error("a group has no closed form: {what}")]
    Group {
        /// Its index in the order of solution.
        group: usize,
        /// The bodies that it places.
        bodies: Vec<BodyId>,
        /// The joints that close it.
        joints: Vec<JointId>,
        /// The part without a closed form.
        what: &'static str,
    },
    /// A reaction that equilibrium does not determine, or that no joint has.
    #[error("the reaction is not determined")]
    Reaction(Reaction),
    /// The mechanism cannot be assembled at its start.
    #[error(transparent)]
    Position(#[from] PositionError),
}
