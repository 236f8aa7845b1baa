//! The equation of motion of a free mechanism of one degree of freedom,
//!
//! ```text
//! q̈ = f(q, q̇) = −½m′ q̇² / m                                     (1)
//! ∂f/∂q  = −(½m″ − ½m′ m′/m) q̇² / m,   m′ = 2 (½m′)              (2)
//! ∂f/∂q̇ = −m′ q̇ / m                                             (3)
//! ```
//!
//! Loads will join ½m′ q̇² in the numerator.

use crate::error::DynamicsError;
use dwell_kinetostatics::Reduced;

/// The equation of motion with the working memory to evaluate it, for one thread.
#[derive(Debug)]
pub struct Equation<'a, R: Reduced> {
    model: &'a R,
    work: R::Work,
    /// What speeds are measured by, rad/s.
    pub(crate) speed: f64,
}

impl<'a, R: Reduced> Equation<'a, R> {
    /// The equation of motion of a reduced model.
    pub fn new(model: &'a R) -> Self {
        Self {
            model,
            work: model.work(),
            speed: 1.0,
        }
    }

    /// The same with speeds measured by that of a start (rad/s): without loads a speed only scales time.
    #[must_use]
    pub fn at_speed(mut self, q_dot: f64) -> Self {
        if q_dot.abs().is_normal() {
            self.speed = q_dot.abs();
        }
        self
    }

    /// The acceleration q̈ (rad/s²) at `q` (rad) and `q_dot` (rad/s), by (1).
    ///
    /// # Errors
    /// [`DynamicsError::Place`] where there is no pose, [`DynamicsError::NoInertia`] where m is not positive.
    pub fn acceleration(&mut self, q: f64, q_dot: f64) -> Result<f64, DynamicsError> {
        let (m, half_dm) = self.model.inertia(q, &mut self.work)?;
        Ok(-half_dm * q_dot * q_dot / positive(m, q)?)
    }

    /// ∂q̈/∂q and ∂q̈/∂q̇, by (2) and (3).
    ///
    /// # Errors
    /// As [`Equation::acceleration`].
    pub fn jacobian(&mut self, q: f64, q_dot: f64) -> Result<[f64; 2], DynamicsError> {
        let at = self.model.curvature(q, &mut self.work)?;
        let m = positive(at.m, q)?;
        let by_q = -(at.half_ddm - 2.0 * at.half_dm * at.half_dm / m) * q_dot * q_dot / m;
        Ok([by_q, -2.0 * at.half_dm * q_dot / m])
    }

    /// Kinetic energy ½ m q̇², J.
    ///
    /// # Errors
    /// As [`Equation::acceleration`].
    pub fn energy(&mut self, q: f64, q_dot: f64) -> Result<f64, DynamicsError> {
        let (m, _) = self.model.inertia(q, &mut self.work)?;
        Ok(0.5 * m * q_dot * q_dot)
    }

    /// The model.
    pub fn model(&self) -> &'a R {
        self.model
    }
}

/// The inertia, if it is one.
pub(crate) fn positive(m: f64, q: f64) -> Result<f64, DynamicsError> {
    if m > 0.0 && m.is_finite() {
        Ok(m)
    } else {
        Err(DynamicsError::NoInertia { q, m })
    }
}
