//! Options of an integration, and the work that it took.

use crate::error::{Result, bad_option};

/// An integration method.
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

    /// Its name in commands and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Bdf => "BDF",
            Self::Esdirk34 => "ESDIRK34",
            Self::TrBdf2 => "TR-BDF2",
            Self::Tsit45 => "Tsit45",
            Self::Dop853 => "DOP853",
        }
    }

    /// Whether it solves equations for each step.
    pub fn is_implicit(self) -> bool {
        !matches!(self, Self::Tsit45 | Self::Dop853)
    }
}

/// Accuracy and effort of an integration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// The method.
    pub method: Method,
    /// Relative tolerance on every state.
    pub rtol: f64,
    /// Absolute tolerance, rad or m and rad/s or m/s; on other states times their error weight.
    pub atol: f64,
    /// Highest number of steps.
    pub max_steps: usize,
    /// Longest step, s; none: as long as the tolerance allows.
    pub max_step: Option<f64>,
    /// Time between equally spaced samples by dense output, s; none: no samples.
    pub sample_interval: Option<f64>,
}

impl Options {
    /// A method with the same relative and absolute tolerance.
    pub fn new(method: Method, tolerance: f64) -> Self {
        Self {
            method,
            rtol: tolerance,
            atol: tolerance,
            max_steps: 2_000_000,
            max_step: None,
            sample_interval: None,
        }
    }

    /// Refuses options that would make the integrator loop endlessly.
    pub(crate) fn check(&self) -> Result<()> {
        let usable = |value: f64| value.is_finite() && value > 0.0;
        if !(self.rtol.is_finite() && self.rtol >= 0.0) {
            return bad_option("the relative tolerance", "number from 0", self.rtol);
        }
        if !usable(self.atol) {
            return bad_option("the absolute tolerance", "positive number", self.atol);
        }
        match (self.max_step, self.sample_interval) {
            (Some(max_step), _) if !usable(max_step) => {
                bad_option("the longest step", "positive time", max_step)
            }
            (_, Some(sample_interval)) if !usable(sample_interval) => {
                bad_option("the distance of samples", "positive time", sample_interval)
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
    pub rejected_steps: usize,
    /// Number of steps of DOP853 whose length only stability limits.
    pub stiff_steps: usize,
    /// Evaluations of the equation of motion.
    pub evaluations: usize,
    /// Further evaluations for the events of contacts and switches: to detect and locate them, and to continue after
    /// them.
    pub event_evaluations: usize,
    /// Evaluations of its Jacobian.
    pub jacobians: usize,
    /// Factorisations.
    pub factorisations: usize,
}

impl Statistics {
    /// The work of both together.
    #[must_use]
    pub fn plus(self, other: Self) -> Self {
        Self {
            steps: self.steps + other.steps,
            rejected_steps: self.rejected_steps + other.rejected_steps,
            stiff_steps: self.stiff_steps + other.stiff_steps,
            evaluations: self.evaluations + other.evaluations,
            event_evaluations: self.event_evaluations + other.event_evaluations,
            jacobians: self.jacobians + other.jacobians,
            factorisations: self.factorisations + other.factorisations,
        }
    }
}
