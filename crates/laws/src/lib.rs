//! Functions of time, each with two derivatives.
//!
//! A law gives a quantity together with its first and second derivative, because a prescribed
//! motion is needed as q, q̇ and q̈ at once. So far there is one law, the polynomial.

pub mod polynomial;

pub use polynomial::Polynomial;
