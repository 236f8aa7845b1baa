//! Results of a design with their derivatives.

use dwell_numerics::optimise::Residuals;

/// An extremum of a curve.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Peak {
    /// Its place along the trajectory, from 0 to 1.
    pub(crate) place: f64,
    /// The value of the result that it is.
    pub(crate) value: f64,
    pub(crate) slope: Vec<f64>,
}

/// A result of a design with its derivatives by the numbers that vary.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Measured {
    pub(crate) value: f64,
    pub(crate) slope: Vec<f64>,
    /// Of an extremum: those of which it is the largest, or the smallest.
    pub(crate) peaks: Vec<Peak>,
    /// Of a root mean square: the square with its derivatives, which has no kink at zero.
    pub(crate) square: Option<(f64, Vec<f64>)>,
    /// Of a distance from a table: what the distances consist of, over the root of the number of rows.
    pub(crate) residuals: Option<Residuals>,
}

impl Measured {
    /// The extreme of some peaks, with its derivatives.
    pub(super) fn of_peaks(peaks: Vec<Peak>, is_least: bool) -> Self {
        let extreme = peaks.iter().reduce(|best, other| {
            match (other.value < best.value) == is_least && other.value != best.value {
                true => other,
                false => best,
            }
        });
        let (value, slope) = extreme.map_or((f64::NAN, Vec::new()), |peak| {
            (peak.value, peak.slope.clone())
        });
        Self {
            value,
            slope,
            peaks,
            ..Self::default()
        }
    }

    /// The root of a mean square.
    pub(super) fn root(square: f64, slope: Vec<f64>) -> Self {
        let value = square.sqrt();
        let part = |slope: &f64| match value > 0.0 {
            true => 0.5 * slope / value,
            false => 0.0,
        };
        Self {
            value,
            slope: slope.iter().map(part).collect(),
            square: Some((square, slope)),
            ..Self::default()
        }
    }
}
