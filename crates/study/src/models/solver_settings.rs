//! Integrator, tolerances and sampling of a motion.

use dwell_dynamics::{Method, Options};

/// Integrator, tolerances and sampling of a motion.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SolverSettings {
    /// The integrator.
    pub method: Method,
    /// Relative tolerance.
    pub rtol: f64,
    /// Absolute tolerance, rad and rad/s or m and m/s.
    pub atol: f64,
    /// Maximum step, s; `None` for no limit.
    pub max_step: Option<f64>,
    /// Sample interval, s; `None` for a thousandth of the duration.
    pub sample_interval: Option<f64>,
}

impl Default for SolverSettings {
    fn default() -> Self {
        Self {
            method: Method::Bdf,
            rtol: 1e-10,
            atol: 1e-10,
            max_step: None,
            sample_interval: None,
        }
    }
}

impl SolverSettings {
    /// The options of the integrator, without samples.
    pub(crate) fn options(&self) -> Options {
        Options {
            atol: self.atol,
            max_step: self.max_step,
            ..Options::new(self.method, self.rtol)
        }
    }

    /// Integrator and tolerance, as figure captions give them.
    pub fn describe(&self) -> String {
        let [rtol, atol] = [self.rtol, self.atol].map(|v| format!("{v:e}"));
        let atol = match atol {
            same if same == rtol => String::new(),
            other => format!(" relative, {other} absolute"),
        };
        format!("{}, tolerance {rtol}{atol}", self.method.name())
    }
}

/// Accuracies by name; the last is the finest power of ten that all measured machines reach. Their costs are in
/// docs/performance.md.
pub const PRESETS: [(&str, f64); 4] = [
    ("draft", 1e-3),
    ("standard", 1e-6),
    ("precise", 1e-9),
    ("reference", 1e-10),
];
