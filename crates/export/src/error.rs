//! Why a machine cannot be exported.

use crate::machine::Function;
use thiserror::Error;

/// Why there is no export.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum FitError<E> {
    /// The mechanism has no position in the domain.
    #[error("{0}")]
    Sampler(E),
    /// A function differs after a period.
    #[error("{name} is not periodic")]
    NotPeriodic {
        /// Its name.
        name: String,
        /// Which.
        function: Function,
    },
    /// A number is beyond single precision.
    #[error("{name} is too large for single precision")]
    TooLarge {
        /// The name of its function.
        name: String,
    },
    /// The operations are not those of the functions over the whole domain.
    #[error("the operations differ from the functions by {error:.1e}")]
    OtherOperations {
        /// The largest relative error.
        error: f64,
    },
    /// The cells have missed a narrow peak.
    #[error("the cells are off by {error:.1e} of the largest value of a function")]
    NarrowPeak {
        /// The largest relative error.
        error: f64,
    },
    /// No number of cells reaches the accuracy.
    #[error("no cells of accuracy {accuracy:e}: {name} varies too sharply near {q}")]
    NotReached {
        /// The function that is furthest off.
        name: String,
        /// Where, rad or m.
        q: f64,
        /// The required accuracy.
        accuracy: f64,
    },
}
