//! What can be integrated in time.

use crate::error::DynamicsError;

/// A time and a state.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Point {
    /// Time, s.
    pub t: f64,
    /// The state.
    pub y: Vec<f64>,
}

/// A system of first order, ẏ = f(t, y).
pub trait System {
    /// Number of states.
    fn size(&self) -> usize;

    /// f(t, y) into `out`.
    ///
    /// # Errors
    /// [`DynamicsError`] where it cannot be evaluated.
    fn rates(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError>;

    /// ∂fᵢ/∂yⱼ into `out`, row by row.
    ///
    /// # Errors
    /// As [`System::rates`].
    fn jacobian(&mut self, t: f64, y: &[f64], out: &mut [f64]) -> Result<(), DynamicsError>;

    /// What the absolute tolerance is multiplied by for a state.
    fn weight(&self, _state: usize) -> f64 {
        1.0
    }
}
