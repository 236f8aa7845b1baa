//! The outcome of a factorisation.

/// Outcome of a factorisation, on which the caller judges singularity and branch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FactorOutcome {
    /// Sign of the determinant, +1, −1 or 0.
    pub determinant_sign: f64,
    /// Smallest pivot over the largest, of all lanes.
    pub pivot_ratio: f64,
}

impl FactorOutcome {
    /// The outcome for a singular matrix, or lanes that need different row exchanges.
    pub const SINGULAR: Self = Self {
        determinant_sign: 0.0,
        pivot_ratio: 0.0,
    };

    /// The outcome by the sizes of the smallest and the largest pivot.
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
