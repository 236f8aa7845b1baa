//! The outcome of a factorisation.

/// Outcome of a factorisation, by which the caller judges singularity and branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FactorOutcome {
    /// Sign of the determinant, +1, −1 or 0.
    pub determinant_sign: f64,
    /// Ratio of the smallest to the largest pivot, over all lanes.
    pub pivot_ratio: f64,
}

impl FactorOutcome {
    /// The outcome for a singular matrix, or for lanes that require different row exchanges.
    pub const SINGULAR: Self = Self {
        determinant_sign: 0.0,
        pivot_ratio: 0.0,
    };

    /// The outcome for a smallest and a largest absolute pivot.
    pub(crate) fn new(determinant_sign: f64, min_pivot: f64, max_pivot: f64) -> Self {
        Self {
            determinant_sign,
            pivot_ratio: if max_pivot > 0.0 {
                min_pivot / max_pivot
            } else {
                0.0
            },
        }
    }
}
