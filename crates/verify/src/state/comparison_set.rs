//! Comparisons of all states of one kind, gathered until their scale is known.

use super::dense_state::DenseState;
use crate::comparison::{Comparison, FindingSpec, LargestDifference};
use dwell_findings::Finding;

/// One comparison.
struct PendingComparison {
    difference: f64,
    /// The reference's own error.
    reference_error: f64,
    /// The scale of this one.
    scale: f64,
    location: String,
    condition_number: f64,
}

/// Comparisons, most of whose scales are only known when all are there.
pub(super) struct ComparisonSet {
    unit: &'static str,
    scale: f64,
    comparisons: Vec<PendingComparison>,
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

    /// One comparison: the difference, the reference's own error, what the scale must hold.
    pub(super) fn add(
        &mut self,
        m: &DenseState<'_>,
        difference: f64,
        reference_error: f64,
        scale: f64,
        location: String,
    ) {
        // A maximum drops what is not a number, but then the difference is not one either.
        self.scale = self.scale.max(scale);
        self.comparisons.push(PendingComparison {
            difference,
            reference_error,
            scale,
            location,
            condition_number: m.condition_number,
        });
    }

    pub(super) fn finding(
        self,
        spec: &FindingSpec<'_>,
        failures: &[String],
        states: usize,
    ) -> Finding {
        let mut worst = LargestDifference::default();
        for pending in self.comparisons {
            let comparison = Comparison {
                difference: pending.difference,
                scale: if self.individual_scales {
                    pending.scale
                } else {
                    self.scale
                },
                reference_error: pending.reference_error,
                unit: self.unit,
                condition_number: pending.condition_number,
            };
            worst.record(&comparison, || pending.location);
        }
        for reason in failures {
            worst.record_failure(reason.clone());
        }
        spec.finding(format!("{states} states"), worst)
    }
}
