//! Why the dense constraint equations of a mechanism cannot be written or solved.

use dwell_geometry::constraint_rows::ConstraintRowsError;

/// A result of the dense equations.
pub(crate) type Result<T, E = DenseError> = std::result::Result<T, E>;

/// Why the dense equations cannot be written or solved.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum DenseError {
    /// The mechanism refers to something that is not there.
    #[error(transparent)]
    Rows(#[from] ConstraintRowsError),
    /// As many rows as coordinates are needed.
    #[error(
        "{rows} constraint and actuator rows for {columns} coordinates: the mechanism is not determinate"
    )]
    NotSquare {
        /// Number of rows.
        rows: usize,
        /// Number of coordinates.
        columns: usize,
    },
    /// One mass per body is needed.
    #[error("{masses} masses for {bodies} bodies")]
    Masses {
        /// Number of masses.
        masses: usize,
        /// Number of bodies.
        bodies: usize,
    },
    /// An axis is not a unit vector.
    #[error("an axis of joint {joint} has length {length}, not 1")]
    AxisNotUnit {
        /// Index of the joint.
        joint: usize,
        /// Its length.
        length: f64,
    },
    /// The checks of the reduced model are those of one degree of freedom.
    #[error("{0} actuators: the reduced model is that of one")]
    Actuators(usize),
    /// A given number is not finite, or there are too few of them.
    #[error("the poses to start from are incomplete or not finite")]
    InvalidPoses,
    /// The rows could not be met.
    #[error(
        "the rows do not close: after {steps} Newton steps the last one moved by {last_step:.1e} of the size"
    )]
    NotClosed {
        /// Newton steps done.
        steps: usize,
        /// Size of the last one, relative to the mechanism's size.
        last_step: f64,
    },
    /// Rows that repeat others are not met where these are: the largest residual, relative to the mechanism's size.
    #[error("redundant rows have a residual of {0:.1e} of the size")]
    RedundantRowsOpen(f64),
    /// They were met on the other side of a dead point.
    #[error("the rows close on another assembly branch")]
    OtherBranch,
    /// The rows depend on each other in this configuration: the smallest pivot relative to the largest.
    #[error("the rows are dependent here: smallest pivot {0:.1e} of the largest")]
    Singular(f64),
}
