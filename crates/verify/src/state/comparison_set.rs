//! Comparisons of all states of one kind, gathered until their scale is known.

use super::dense_state::DenseState;
use crate::comparison::{Comparison, LargestDifference};

/// Comparisons, most of whose scales are only known when all are there.
pub(super) struct ComparisonSet {
    unit: &'static str,
    scale: f64,
    comparisons: Vec<(Comparison, String)>,
    /// Whether each is checked by its own scale.
    individual_scales: bool,
}

impl ComparisonSet {
    pub(super) fn new(unit: &'static str) -> Self {
        Self {
            unit,
            scale: 0.0,
            comparisons: Vec::new(),
            individual_scales: false,
        }
    }

    /// A balance must hold in every state, however small its terms are there.
    pub(super) fn with_individual_scales(unit: &'static str) -> Self {
        Self {
            individual_scales: true,
            ..Self::new(unit)
        }
    }

    /// One comparison in a state: the difference, what the scale is at least, and the error of the reference. `what`
    /// names the quantity after the state; empty where there is only one.
    pub(super) fn add(&mut self, state: &DenseState<'_>, numbers: [f64; 3], what: &str) {
        // A maximum drops what is not a number, but then the difference is not one either.
        self.scale = self.scale.max(numbers[1]);
        let comparison = Comparison {
            numbers,
            unit: self.unit,
            condition_number: state.condition_number,
        };
        let separator = if what.is_empty() { "" } else { ", " };
        let location = format!("t = {} s{separator}{what}", state.state.t);
        self.comparisons.push((comparison, location));
    }

    /// The largest difference relative to the scale.
    pub(super) fn largest(self) -> LargestDifference {
        let mut worst = LargestDifference::default();
        for (mut comparison, location) in self.comparisons {
            if !self.individual_scales {
                comparison.numbers[1] = self.scale;
            }
            worst.record(&comparison, || location);
        }
        worst
    }
}
