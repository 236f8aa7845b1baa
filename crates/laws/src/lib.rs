//! Functions of one variable with three derivatives, and expressions of named variables.
//!
//! A [`Law`] gives a quantity with its first three derivatives, exactly: a prescribed motion is
//! needed as q, q̇ and q̈ at once, the motion through a cam relation one derivative further. An
//! [`Expression`] is a formula of several names, as a load has it. Everything is checked when it
//! is built; evaluation allocates nothing, cannot fail, and shows what is undefined as NaN or ±∞.

pub mod error;
pub mod expression;
pub mod law;
pub mod polynomial;
pub mod profile;
pub mod sinusoid;
pub mod spline;

pub use error::LawError;
pub use expression::{Expression, ExpressionError};
pub use law::Law;
pub use polynomial::Polynomial;
pub use profile::{Profile, Rise, Shape};
pub use sinusoid::Sinusoid;
pub use spline::Spline;
