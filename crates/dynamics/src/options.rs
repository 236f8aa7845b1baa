//! How to integrate, and what it took.

use crate::error::DynamicsError;

/// How to integrate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Implicit, variable order 1 to 5 (backward differentiation).
    Bdf,
    /// Singly diagonally implicit Runge–Kutta of order 4, stiffly accurate.
    Esdirk34,
    /// Trapezoidal rule and backward differentiation in one step, order 2.
    TrBdf2,
    /// Explicit Runge–Kutta of order 5 (Tsitouras 2011).
    Tsit45,
    /// Explicit Runge–Kutta of order 8 (Dormand and Prince; Hairer's DOP853).
    Dop853,
}

impl Method {
    /// All of them, the default first.
    pub const ALL: [Self; 5] = [
        Self::Bdf,
        Self::Esdirk34,
        Self::TrBdf2,
        Self::Tsit45,
        Self::Dop853,
    ];

    /// The name used in commands and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bdf => "BDF",
            Self::Esdirk34 => "ESDIRK34",
            Self::TrBdf2 => "TR-BDF2",
            Self::Tsit45 => "Tsit45",
            Self::Dop853 => "DOP853",
        }
    }

    /// Whether it solves equations at each step.
    pub fn implicit(self) -> bool {
        !matches!(self, Self::Tsit45 | Self::Dop853)
    }
}

/// Accuracy and effort of an integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The method.
    pub method: Method,
    /// Relative tolerance on every state.
    pub relative: f64,
    /// Absolute tolerance, rad or m and rad/s or m/s; on other states in proportion to their weight.
    pub absolute: f64,
    /// Most steps to be taken.
    pub budget: usize,
    /// Longest step, s; none for as long as the tolerance lets it be.
    pub longest: Option<f64>,
    /// Distance of equally spaced samples by dense output, s; none for no samples.
    pub every: Option<f64>,
}

impl Options {
    /// A method with the same relative and absolute tolerance.
    pub fn new(method: Method, tolerance: f64) -> Self {
        Self {
            method,
            relative: tolerance,
            absolute: tolerance,
            budget: 2_000_000,
            longest: None,
            every: None,
        }
    }

    /// Options that the integrator would answer with an endless loop are refused here.
    pub(crate) fn check(&self) -> Result<(), DynamicsError> {
        let usable = |value: f64| value.is_finite() && value > 0.0;
        let refuse = |what, must, value| Err(DynamicsError::BadOption { what, must, value });
        if !(self.relative.is_finite() && self.relative >= 0.0) {
            return refuse("the relative tolerance", "number from 0", self.relative);
        }
        if !usable(self.absolute) {
            return refuse("the absolute tolerance", "positive number", self.absolute);
        }
        match (self.longest, self.every) {
            (Some(longest), _) if !usable(longest) => {
                refuse("the longest step", "positive time", longest)
            }
            (_, Some(every)) if !usable(every) => {
                refuse("the distance of samples", "positive time", every)
            }
            _ => Ok(()),
        }
    }
}

/// The work an integration took.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Statistics {
    /// Steps taken.
    pub steps: usize,
    /// Steps rejected for their error.
    pub rejected: usize,
    /// Evaluations of the equation of motion.
    pub evaluations: usize,
    /// Evaluations of its Jacobian.
    pub jacobians: usize,
    /// Factorisations.
    pub factorisations: usize,
}
