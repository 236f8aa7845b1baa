//! The time that a motion takes for its phase.

use dwell_numerics::fourier::FourierSeries;
use dwell_numerics::panels::Panels;

/// A motion that repeats itself, resolved over its phase.
pub(crate) struct ResolvedMotion {
    pub(crate) time_density: TimeDensity,
    /// The largest kinetic energy at a point, J.
    pub(crate) max_kinetic: f64,
    pub(crate) points: usize,
    /// Whether more points would change roundings only.
    pub(crate) is_resolved: bool,
}

/// The time per phase of a motion, dt/ds, s/rad.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum TimeDensity {
    /// From equally spaced points.
    Fourier(FourierSeries),
    /// From panels, which have their points where the function is sharp.
    Piecewise(Panels),
}

impl TimeDensity {
    /// Its mean over a period.
    pub(crate) fn mean(&self) -> f64 {
        match self {
            Self::Fourier(series) => series.mean,
            Self::Piecewise(panels) => panels.mean,
        }
    }

    /// What its last coefficients leave, as a part of the mean.
    pub(crate) fn tail(&self) -> f64 {
        match self {
            Self::Fourier(series) => series.tail,
            Self::Piecewise(panels) => panels.tail,
        }
    }

    /// Its value and its integral from zero at a phase.
    pub(crate) fn eval(&self, phase: f64) -> [f64; 2] {
        match self {
            Self::Fourier(series) => series.eval(phase),
            Self::Piecewise(panels) => panels.eval(phase),
        }
    }
}
