//! What can be wrong with the numbers that a law is built from.

/// Why a law could not be built. Points are counted from 0; the messages count them from 1.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum LawError {
    /// A quantity of that name is infinite or not a number.
    #[error("`{name}` is {value}, and must be a finite number")]
    NotFinite {
        /// The parameter's name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A quantity of that name must be greater than zero.
    #[error("`{name}` is {value}, and must be greater than 0")]
    NotPositive {
        /// The parameter's name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The two ramps of a trapezoidal speed do not fit into its duration.
    #[error("two ramps of {ramp} s are longer than the duration of {duration} s")]
    RampTooLong {
        /// Length of one ramp, s.
        ramp: f64,
        /// Duration of the motion, s.
        duration: f64,
    },
    /// A table needs two points at least.
    #[error("a table needs at least 2 points, and this one has {found}")]
    TooFewPoints {
        /// How many there are.
        found: usize,
    },
    /// A point has a coordinate that is infinite or not a number.
    #[error("point {} of the table is not finite", index + 1)]
    PointNotFinite {
        /// Which point.
        index: usize,
    },
    /// A point does not lie beyond the one before it.
    #[error("point {} of the table does not come after point {index}: the first column must ascend", index + 1)]
    NotAscending {
        /// Which point: the later one of the two.
        index: usize,
    },
    /// Two neighbours are so close, or so far apart, that the spline between them overflows.
    #[error("points {index} and {} of the table are too close or too large for a spline", index + 1)]
    TooSteep {
        /// Which point: the later one of the two.
        index: usize,
    },
}

/// `value`, if it is finite.
pub(crate) fn require_finite(name: &'static str, value: f64) -> Result<f64, LawError> {
    let found = Some(value).filter(|value| value.is_finite());
    found.ok_or(LawError::NotFinite { name, value })
}

/// `value`, if it is finite and greater than zero.
pub(crate) fn require_positive(name: &'static str, value: f64) -> Result<f64, LawError> {
    let found = Some(require_finite(name, value)?).filter(|&value| value > 0.0);
    found.ok_or(LawError::NotPositive { name, value })
}
