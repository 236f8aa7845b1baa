//! The grid: rows of extreme parameters, each with its requirement stated beforehand.

use dwell_numerics::{DoubleDouble, Scalar};

/// Roundings that an evaluation of a dyad's reduced model is allowed, each magnified by the condition: it
/// takes some hundred operations, whose roundings add up as their root.
pub(super) const ALLOWED_ROUNDINGS: f64 = 16.0;
/// Condition of a well-shaped dyad's accelerations: the sines of its angles there are about a half, and they
/// enter three times.
pub(super) const DYAD_CONDITION: f64 = 8.0;
/// A typed error is an answer only where the condition number is above this.
pub const MIN_ILL_CONDITIONED: f64 = 1e8;
/// The rule of the estimates: so many times the true error at most, in so large a part of the cells.
pub const MAX_ESTIMATE_RATIO: f64 = 100.0;
/// The part of the cells that the rule of the estimates holds for.
pub const REQUIRED_CELL_FRACTION: f64 = 0.95;

/// A row of the grid: one parameter driven to its extremes.
pub struct ParameterSeries {
    /// Short stable key, such as `limit-four-bar`.
    pub key: String,
    /// Name and title of the page it stands on.
    pub figure: (&'static str, &'static str),
    /// What is driven to what extreme.
    pub description: String,
    /// Name and unit of the parameter.
    pub parameter: (&'static str, &'static str),
    /// Its values, all above zero.
    pub values: Vec<f64>,
    /// The quantities, in the order of the results.
    pub quantities: &'static [&'static str],
    /// The reference of the results.
    pub reference: &'static str,
    /// Why the floor is what it is.
    pub reason: &'static str,
    /// The requirement, stated beforehand, by value and quantity.
    pub requirement: Box<dyn Fn(f64, usize) -> Requirement + Send + Sync>,
    /// The results at a value, one for each quantity.
    pub run: Box<dyn Fn(f64) -> RunResult + Send + Sync>,
}

/// All results at a value of the parameter, or the typed error that stands for all of them.
pub type RunResult = Result<Vec<CellResult>, Box<dyn std::error::Error>>;

/// What is stated of a cell before it is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Requirement {
    /// Decimal digits that must be kept at least.
    pub min_digits: f64,
    /// By how much a relative change of the input is magnified in the result.
    pub condition_number: f64,
    /// A typed error is an answer only where the condition number is above this.
    pub refusable_from: f64,
}

impl Requirement {
    /// The digits that rounding leaves: `roundings` of ½ ulp in each of the numbers that a result of this
    /// condition depends on.
    pub fn from_rounding(roundings: f64, condition_number: f64) -> Self {
        let error = roundings * f64::EPSILON * condition_number;
        Self::from_error(error, condition_number)
    }

    /// The digits that an error leaves, relative to the scale of the result.
    pub fn from_error(error: f64, condition_number: f64) -> Self {
        Self {
            min_digits: (-error.log10()).max(0.0),
            condition_number,
            refusable_from: MIN_ILL_CONDITIONED,
        }
    }
}

/// A result, or the typed error that stands for it.
pub type CellResult = Result<EstimatedValue, String>;

/// A result with its reference and the estimate of its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EstimatedValue {
    /// The reported value.
    pub value: f64,
    /// The true value.
    pub reference: DoubleDouble,
    /// What digits are counted from.
    pub scale: f64,
    /// The estimate of the absolute error that is reported with the value.
    pub error_estimate: f64,
}

/// A result with its estimated error, whose digits are counted from its own size.
pub(crate) fn cell((value, error_estimate): (f64, f64), reference: DoubleDouble) -> CellResult {
    Ok(EstimatedValue {
        value,
        reference,
        scale: reference.hi.abs(),
        error_estimate,
    })
}

/// The same with digits counted from another size.
pub(crate) fn scaled_cell(
    value_and_error: (f64, f64),
    reference: DoubleDouble,
    scale: f64,
) -> CellResult {
    let value = cell(value_and_error, reference)?;
    Ok(EstimatedValue { scale, ..value })
}

impl EstimatedValue {
    /// The true absolute error; where there is none, half a unit in the last place.
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
    /// Decimal digits kept; none where a typed error stands.
    pub fn digits(&self) -> Option<f64> {
        let result = self.result.as_ref().ok()?;
        let lost = result.true_error() / result.scale;
        // What is no number keeps nothing.
        let kept = (-lost.log10()).clamp(0.0, 17.0);
        Some(if lost.is_nan() { 0.0 } else { kept })
    }

    /// The estimate over the true error.
    pub fn estimate_ratio(&self) -> Option<f64> {
        let result = self.result.as_ref().ok()?;
        let ratio = result.error_estimate / result.true_error();
        // Neither an estimate nor an error that is no number says anything.
        Some(if ratio.is_nan() { 0.0 } else { ratio })
    }

    /// Whether it keeps what was stated: its digits, or a typed error where the condition is bad.
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
