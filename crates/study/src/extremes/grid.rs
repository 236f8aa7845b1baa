//! The grid: rows of extreme parameters, with what each must keep stated beforehand.

use dwell_geometry::{Scalar, Wide};

/// A typed error is an answer only where the condition number is above this.
pub const ILL_CONDITIONED: f64 = 1e8;
/// The rule of the estimates: so many times the true error at most, in so large a part of the cells.
pub const MOST_TIMES: f64 = 100.0;
/// The part of the cells that the rule of the estimates holds for.
pub const MOST_CELLS: f64 = 0.95;

/// A row of the grid: one parameter driven to its extremes.
pub struct Row {
    /// Short stable key, such as `limit-four-bar`.
    pub key: String,
    /// Name and title of the page it stands on.
    pub family: (&'static str, &'static str),
    /// What is driven to what extreme.
    pub what: String,
    /// Name and unit of the parameter.
    pub parameter: (&'static str, &'static str),
    /// Its values, all above zero.
    pub values: Vec<f64>,
    /// What is reported, in the order of the readings.
    pub quantities: &'static [&'static str],
    /// What the results are held against.
    pub truth: &'static str,
    /// Why the floor is what it is.
    pub why: &'static str,
    /// What is stated beforehand, by value and quantity.
    pub stated: Box<dyn Fn(f64, usize) -> Stated + Send + Sync>,
    /// The results at a value, one for each quantity.
    pub run: Box<dyn Fn(f64) -> Vec<Told> + Send + Sync>,
}

/// What is stated of a cell before it is computed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stated {
    /// Decimal digits that must be kept at least.
    pub floor: f64,
    /// By how much a relative change of the input is magnified in the result.
    pub condition: f64,
}

impl Stated {
    /// The digits that rounding leaves: `roundings` of ½ ulp in each of the numbers that a result of this
    /// condition depends on.
    pub fn rounding(roundings: f64, condition: f64) -> Self {
        Self::error(roundings * f64::EPSILON * condition, condition)
    }

    /// The digits that an error leaves, relative to the scale of the result.
    pub fn error(error: f64, condition: f64) -> Self {
        Self {
            floor: (-error.log10()).max(0.0),
            condition,
        }
    }
}

/// A result, or the typed error that stands for it.
pub type Told = Result<Reading, String>;

/// A result with its truth and the estimate of its error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reading {
    /// What the workbench reports.
    pub value: f64,
    /// What is true.
    pub truth: Wide,
    /// What digits are counted from.
    pub scale: f64,
    /// The estimate of the absolute error that is reported with the value.
    pub estimate: f64,
}

impl Reading {
    /// A result whose digits are counted from its own size.
    pub fn new(value: f64, truth: Wide, estimate: f64) -> Self {
        Self {
            value,
            truth,
            scale: truth.hi.abs(),
            estimate,
        }
    }

    /// The same with digits counted from another size.
    #[must_use]
    pub fn of(self, scale: f64) -> Self {
        Self { scale, ..self }
    }

    /// The true absolute error; where there is none, half a unit in the last place.
    pub fn error(&self) -> f64 {
        let error = (Wide::lift(self.value) - self.truth).hi.abs();
        if error == 0.0 {
            0.5 * ulp(self.value)
        } else {
            error
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
pub struct Cell {
    /// The value of the row's parameter.
    pub at: f64,
    /// Index of the quantity.
    pub quantity: usize,
    /// What was stated beforehand.
    pub stated: Stated,
    /// What was told.
    pub told: Told,
}

impl Cell {
    /// Decimal digits kept; none where a typed error stands.
    pub fn digits(&self) -> Option<f64> {
        let reading = self.told.as_ref().ok()?;
        let lost = reading.error() / reading.scale;
        // What is no number keeps nothing.
        Some(if lost.is_nan() {
            0.0
        } else {
            (-lost.log10()).clamp(0.0, 17.0)
        })
    }

    /// The estimate over the true error.
    pub fn ratio(&self) -> Option<f64> {
        let reading = self.told.as_ref().ok()?;
        let ratio = reading.estimate / reading.error();
        // Neither an estimate nor an error that is no number says anything.
        Some(if ratio.is_nan() { 0.0 } else { ratio })
    }

    /// Whether it keeps what was stated: its digits, or a typed error where the condition is bad.
    pub fn holds(&self) -> bool {
        match self.digits() {
            Some(digits) => digits >= self.stated.floor,
            None => self.stated.condition > ILL_CONDITIONED,
        }
    }
}

/// A row with its cells.
pub struct Measured {
    /// The row.
    pub row: Row,
    /// Its cells, by value and quantity.
    pub cells: Vec<Cell>,
}

impl Row {
    /// The cells at one value.
    pub fn cells(&self, at: f64) -> Vec<Cell> {
        let told = (self.run)(at).into_iter().enumerate();
        told.map(|(quantity, told)| Cell {
            at,
            quantity,
            stated: (self.stated)(at, quantity),
            told,
        })
        .collect()
    }
}

/// The same words for every quantity of a value.
pub(crate) fn refused(error: &impl ToString, quantities: usize) -> Vec<Told> {
    vec![Err(error.to_string()); quantities]
}

/// Powers of ten from one exponent to another.
pub(crate) fn decades(from: i32, to: i32) -> Vec<f64> {
    let step = if from < to { 1 } else { -1 };
    let count = (to - from).abs();
    (0..=count)
        .map(|k| format!("1e{}", from + step * k).parse().unwrap_or(f64::NAN))
        .collect()
}
