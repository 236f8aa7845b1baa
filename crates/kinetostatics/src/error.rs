//! Why a model cannot be built or evaluated.

use dwell_geometry::{AssemblyError, BodyId, PositionError, Reaction};
use thiserror::Error;

/// A result that fails with a [`KinetostaticsError`] unless another error is named.
pub type Result<T, E = KinetostaticsError> = std::result::Result<T, E>;

/// A result that fails with a [`PositionError`]: there is no pose.
pub type PositionResult<T = ()> = std::result::Result<T, PositionError>;

/// Why a model cannot be built.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum ModelError {
    /// The mechanism cannot be assembled.
    #[error(transparent)]
    Assembly(#[from] AssemblyError),
    /// A reaction that no joint of the mechanism has, or that a model does not compute.
    #[error("the mechanism has no such reaction: {0:?}")]
    Reaction(Reaction),
    /// The number of masses differs from that of the bodies, or a mass is negative or not finite.
    #[error("the masses do not fit the bodies")]
    Masses,
    /// A moment of inertia over the angle of a body that does not fit the mechanism.
    #[error("body {}: {what}", body.0)]
    VaryingInertia {
        /// The body.
        body: BodyId,
        /// The fault.
        what: &'static str,
    },
}

/// Why a load cannot act on a mechanism.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Error)]
#[error("load {load}: {what}")]
pub struct LoadError {
    /// Index of the load.
    pub load: usize,
    /// The fault.
    pub what: &'static str,
}

/// Why a state of motion has no inverse dynamics. Small and `Copy`, because it is made in the inner loop; whoever
/// holds the loads adds their names.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum KinetostaticsError {
    /// There is no pose.
    #[error(transparent)]
    Position(#[from] PositionError),
    /// A spring with a free length, or a damper, whose two points coincide.
    #[error("load {load} has no direction: its two points coincide")]
    NoDirection {
        /// Index of the load in [`Model::loads`](crate::Model::loads).
        load: usize,
    },
    /// A magnitude that is infinite or not a number.
    #[error("the magnitude of load {load} is not a finite number")]
    MagnitudeNotFinite {
        /// Index of the load in [`Model::loads`](crate::Model::loads).
        load: usize,
    },
    /// Friction for which the state of motion has no unique solution.
    #[error(
        "the mechanism is self-locking under friction {load}: its effective inertia is not positive"
    )]
    SelfLocking {
        /// Index of the first friction in [`Model::loads`](crate::Model::loads).
        load: usize,
    },
}

impl KinetostaticsError {
    /// The load that causes the error, by its index in [`Model::loads`](crate::Model::loads).
    pub fn load(&self) -> Option<usize> {
        match *self {
            Self::Position(_) => None,
            Self::NoDirection { load }
            | Self::MagnitudeNotFinite { load }
            | Self::SelfLocking { load } => Some(load),
        }
    }
}
