//! Errors in the parameters of a law.

/// Why a law cannot be built. Indices of points start at 0; messages count points from 1.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum LawError {
    /// A parameter is infinite or NaN.
    #[error("`{name}` is {value}, and must be a finite number")]
    NotFinite {
        /// The parameter's name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// A parameter must be greater than zero.
    #[error("`{name}` is {value}, and must be greater than 0")]
    NotPositive {
        /// The parameter's name.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The two ramps of a trapezoidal velocity exceed its duration.
    #[error("two ramps of {ramp} s are longer than the duration of {duration} s")]
    RampTooLong {
        /// Length of one ramp, s.
        ramp: f64,
        /// Duration of the motion, s.
        duration: f64,
    },
    /// A table needs at least two points.
    #[error("a table needs at least 2 points, and this one has {found}")]
    TooFewPoints {
        /// Number of points.
        found: usize,
    },
    /// A coordinate of a point is infinite or NaN.
    #[error("point {} of the table is not finite", index + 1)]
    PointNotFinite {
        /// The point.
        index: usize,
    },
    /// The x of a point does not exceed that of the point before.
    #[error("point {} of the table does not come after point {index}: the first column must ascend", index + 1)]
    NotAscending {
        /// The later one of the two points.
        index: usize,
    },
    /// Two neighbours are so close, or so far apart, that the spline between them overflows.
    #[error("points {index} and {} of the table are too close or too large for a spline", index + 1)]
    TooSteep {
        /// The later one of the two points.
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
