//! The exported code in Rust, operation by operation: with it the export measures its own errors, its step and its worst
//! case before it is written, and its tests compare what is compiled.

mod motion;
mod pieces;

pub use motion::{Evaluator, MotionTerms, ReactionTerms, State};
pub(crate) use motion::{has_rotor, scene_value};

/// Why exported code has no value. Its outputs are zero then, and a state stays as it was.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Status {
    /// The coordinate is outside the domain.
    #[error("out of range")]
    OutOfRange,
    /// A number that is not finite came in or out.
    #[error("not finite")]
    NotFinite,
    /// m with everything added is not above zero.
    #[error("no inertia")]
    NoInertia,
}
