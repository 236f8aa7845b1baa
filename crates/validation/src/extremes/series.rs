//! The grid: rows of extreme parameters, each with its requirement stated beforehand.

use dwell_numerics::{DoubleDouble, Scalar};

/// Allowed rounding errors of an evaluation of a dyad's reduced model, each magnified by the condition number: it
/// takes some hundred operations, whose rounding errors add up as the square root of their number.
pub(super) const ALLOWED_ROUNDINGS: f64 = 16.0;
/// Condition number of a well-shaped dyad's accelerations: the sines of its angles are about a half, and
/// enter three times.
pub(super) const DYAD_CONDITION: f64 = 8.0;
/// A typed error is permitted only above this condition number.
pub const MIN_ILL_CONDITIONED: f64 = 1e8;
/// The rule of the estimates: at most this multiple of the true error, in the fraction of the cells below.
pub const MAX_ESTIMATE_RATIO: f64 = 100.0;
/// The fraction of the cells that must satisfy the rule of the estimates.
pub const REQUIRED_CELL_FRACTION: f64 = 0.95;

/// A row of the grid: one parameter driven to its extremes.
pub struct ParameterSeries {
    /// Short stable key, such as `limit-four-bar`.
    pub key: String,
    /// Name and title of its figure.
    pub figure: (&'static str, &'static str),
    /// The parameter and its extreme, in words.
    pub description: String,
    /// Name and unit of the parameter.
    pub parameter: (&'static str, &'static str),
    /// Its values, all greater than zero.
    pub values: Vec<f64>,
    /// The quantities, in the order of the results.
    pub quantities: &'static [&'static str],
    /// The reference of the results.
    pub reference: &'static str,
    /// The reason for the required digits.
    pub reason: &'static str,
    /// The requirement, stated beforehand, by value and quantity.
    pub requirement: Box<dyn Fn(f64, usize) -> Requirement + Send + Sync>,
    /// The results at a value, one for each quantity.
    pub run: Box<dyn Fn(f64) -> RunResult + Send + Sync>,
}

/// All results at a value of the parameter, or one typed error for all of them.
pub type RunResult = Result<Vec<CellResult>, Box<dyn std::error::Error>>;

/// The requirement on a cell, stated before it is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirement {
    /// Minimum number of correct decimal digits.
    pub min_digits: f64,
    /// Factor by which a relative change of the input is magnified in the result.
    pub condition_number: f64,
    /// A typed error is permitted only above this condition number.
    pub refusable_from: f64,
}

impl Requirement {
    /// The digits that remain after `roundings` errors of ½ ulp in each of the numbers on which a result of this
    /// condition number depends.
    pub fn from_rounding(roundings: f64, condition_number: f64) -> Self {
        let error = roundings * f64::EPSILON * condition_number;
        Self::from_error(error, condition_number)
    }

    /// The digits that remain after an error relative to the scale of the result.
    pub fn from_error(error: f64, condition_number: f64) -> Self {
        Self {
            min_digits: (-error.log10()).max(0.0),
            condition_number,
            refusable_from: MIN_ILL_CONDITIONED,
        }
    }
}

/// A result, or the typed error in its place.
pub type CellResult = Result<EstimatedValue, String>;

/// A result with its reference and the estimate of its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatedValue {
    /// The reported value.
    pub value: f64,
    /// The true value.
    pub reference: DoubleDouble,
    /// The scale from which digits are counted.
    pub scale: f64,
    /// The reported estimate of the absolute error.
    pub error_estimate: f64,
}

/// A result with its estimated error; digits are counted from its own size.
pub(crate) fn cell((value, error_estimate): (f64, f64), reference: DoubleDouble) -> CellResult {
    Ok(EstimatedValue {
        value,
        reference,
        scale: reference.hi.abs(),
        error_estimate,
    })
}

/// A result with digits counted from another size.
pub(crate) fn scaled_cell(
    value_and_error: (f64, f64),
    reference: DoubleDouble,
    scale: f64,
) -> CellResult {
    let value = cell(value_and_error, reference)?;
    Ok(EstimatedValue { scale, ..value })
}

impl EstimatedValue {
    /// The true absolute error, or half a unit in the last place if it is zero.
    pub fn true_error(&self) -> f64 {
        match (DoubleDouble::from_f64(self.value) - self.reference).hi {
            0.0 => 0.5 * ulp(self.value),
            error => error.abs(),
        }
    }
}

/// The distance from a number to the next larger one in size.
pub fn ulp(value: f64) -> f64 {
    let size = value.abs();
    f64::from_bits(size.to_bits() + 1) - size
}

/// A result of the grid.
#[derive(Debug, Clone, PartialEq)]
pub struct ResultCell {
    /// The value of the row's parameter.
    pub parameter: f64,
    /// Index of the quantity.
    pub quantity: usize,
    /// Its requirement.
    pub requirement: Requirement,
    /// The value with its errors, or the error that was returned.
    pub result: CellResult,
}

impl ResultCell {
    /// Number of correct decimal digits; `None` for a typed error.
    pub fn digits(&self) -> Option<f64> {
        let result = self.result.as_ref().ok()?;
        let lost = result.true_error() / result.scale;
        // NaN has no correct digits.
        let kept = (-lost.log10()).clamp(0.0, 17.0);
        Some(if lost.is_nan() { 0.0 } else { kept })
    }

    /// The estimate over the true error.
    pub fn estimate_ratio(&self) -> Option<f64> {
        let result = self.result.as_ref().ok()?;
        let ratio = result.error_estimate / result.true_error();
        // A NaN estimate or error gives no ratio.
        Some(if ratio.is_nan() { 0.0 } else { ratio })
    }

    /// Whether it meets the requirement: enough digits, or a permitted typed error.
    pub fn meets_requirement(&self) -> bool {
        match self.digits() {
            Some(digits) => digits >= self.requirement.min_digits,
            None => self.requirement.condition_number > self.requirement.refusable_from,
        }
    }
}

/// A row with its cells.
pub struct SeriesResult {
    /// The row.
    pub series: ParameterSeries,
    /// Its cells, by value and quantity.
    pub cells: Vec<ResultCell>,
}

impl ParameterSeries {
    /// The cells at one value.
    pub fn evaluate(&self, parameter: f64) -> Vec<ResultCell> {
        let same = |error: String| vec![Err(error); self.quantities.len()];
        let results = (self.run)(parameter).unwrap_or_else(|error| same(error.to_string()));
        let cell = |(quantity, result)| ResultCell {
            parameter,
            quantity,
            requirement: (self.requirement)(parameter, quantity),
            result,
        };
        results.into_iter().enumerate().map(cell).collect()
    }
}

/// Powers of ten from one exponent to another.
pub(crate) fn decades(from: i32, to: i32) -> Vec<f64> {
    let step = if from < to { 1 } else { -1 };
    let count = (to - from).abs();
    let power = |k| format!("1e{}", from + step * k).parse();
    (0..=count).map(|k| power(k).unwrap_or(f64::NAN)).collect()
}
