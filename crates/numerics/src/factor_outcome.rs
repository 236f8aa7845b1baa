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
}
