//! Functions of time, each with two derivatives.
//!
//! A law gives a quantity together with its first and second derivative, because a prescribed
//! motion is needed as q, q̇ and q̈ at once. So far there is one law, the polynomial.

pub mod polynomial;

pub use polynomial::Polynomial;

/// A function of one variable that a mechanism or a load can hold.
#[derive(Debug, Clone, PartialEq)]
pub enum Law {
    /// A polynomial.
    Polynomial(Polynomial),
}

impl Law {
    /// The value and its first three derivatives at `x`.
    pub fn at(&self, x: f64) -> [f64; 4] {
        match self {
            Self::Polynomial(polynomial) => {
                let [v, d, dd] = polynomial.at(x);
                [v, d, dd, 0.0]
            }
        }
    }
}

/// An expression of named variables.
#[derive(Debug, Clone, PartialEq)]
pub struct Expression;
