//! Number types, small dense linear algebra, series and root finding, independent of mechanisms. Code that is generic over
//! [`Scalar`] is evaluated in `f64` or `f32`, with exact derivatives, with twice the digits, or for several values at once.
//!
//! ```
//! use dwell_numerics::{Dual, DoubleDouble, Scalar};
//!
//! /// The distance of the piston from the crank's centre, for a crank of length 1 and a rod of length 3.
//! fn piston<T: Scalar>(crank_angle: T) -> T {
//!     let (sin, cos) = crank_angle.sin_cos();
//!     cos + (T::from_f64(9.0) - sin * sin).sqrt()
//! }
//!
//! let exact = piston(Dual::variable(0.5)); // the value and d/dq
//! let difference = (piston(0.5 + 1e-6) - piston(0.5 - 1e-6)) / 2e-6;
//! assert!((exact.d - difference).abs() < 1e-9);
//!
//! let rounding = piston(DoubleDouble::from_f64(0.5)) - DoubleDouble::from_f64(piston(0.5));
//! assert!(rounding.value().abs() < 1e-15);
//! ```

pub mod dense;
pub mod double_double;
pub mod dual;
pub mod factor_outcome;
mod float;
pub mod fourier;
pub mod lanes;
pub mod lu;
#[cfg(not(target_family = "wasm"))]
mod lu_faer;
pub mod minimum;
pub mod optimise;
pub mod panels;
mod piecewise_quintic;
pub mod polynomial_fit;
pub mod qr;
mod real;
mod recording;
mod reverse;
pub mod root;
mod sampled_curve;
pub mod scalar;
pub mod sin_cos;
mod straight_line;

pub use double_double::DoubleDouble;
pub use dual::Dual;
pub use factor_outcome::FactorOutcome;
pub use lanes::Lanes;
pub use piecewise_quintic::{Checked, PiecewiseQuintic};
pub use real::Real;
pub use recording::{RecordedNumber, RecordingError, record, record_at};
pub use reverse::ReverseSweep;
pub use sampled_curve::{SamplePositions, SampledCurve};
pub use scalar::{Constant, Lift, Scalar, map_array, uniform};
pub use straight_line::{Operand, Operation, OperationKind, StraightLine};
