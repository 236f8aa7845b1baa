//! Functions of one variable with three derivatives, and expressions of named variables.
//!
//! A [`Law`] gives a quantity with its exact first three derivatives: a prescribed motion
//! needs q, q̇ and q̈, a coupling (such as a cam) one derivative more. An
//! [`Expression`] is a formula of several variables, for the magnitude of a load. Parameters are checked when a function
//! is built; evaluation allocates nothing, cannot fail, and returns NaN or ±∞ where the function is undefined.
//!
//! ```
//! use dwell_laws::{Expression, Law, Profile, Rise, Shape};
//!
//! // A cam follower: 10 mm up while the cam turns by 2 rad, without a jump of velocity or acceleration.
//! let rise = Rise { start: 0.0, rise: 0.01, duration: 2.0, delay: 0.0 };
//! let lift = Law::Profile(Profile::new(Shape::Polynomial345, rise)?);
//! let [value, slope, ..] = lift.eval(1.0); // halfway: half the lift, and the largest slope
//! assert_eq!(value, 0.005);
//! assert!((slope - 1.875 * 0.01 / 2.0).abs() < 1e-15);
//!
//! // The same quantity as a formula, differentiated exactly.
//! let formula = Law::Expression(Expression::parse("0.005*(1 - cos(pi*x/2))", &["x"])?);
//! let [value, slope, ..] = formula.eval(1.0);
//! assert!((value - 0.005).abs() < 1e-17 && slope > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod error;
pub mod expression;
pub mod features;
pub mod law;
pub mod polynomial;
pub mod profile;
pub mod sinusoid;
pub mod spline;
pub mod switches;
mod windows;

pub use error::LawError;
pub use expression::{Expression, ExpressionError, HeldPieces};
pub use features::{Features, Piece, Scan, Unresolved};
pub use law::Law;
pub use polynomial::Polynomial;
pub use profile::{Profile, Rise, Shape};
pub use sinusoid::Sinusoid;
pub use spline::{Interpolation, Spline};
pub use switches::{SwitchKind, Switches};
pub use windows::{Course, Pulse};
