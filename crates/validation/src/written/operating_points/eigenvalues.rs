//! Eigenvalues of a summary.

use crate::written::poses::stated::result;
use serde_json::Value;

/// A complex number: its real and its imaginary part.
pub(super) type Complex = [f64; 2];

/// The absolute value.
pub(super) fn size([a, b]: Complex) -> f64 {
    a.hypot(b)
}

/// The largest absolute value of some numbers, not below the smallest that is not zero.
pub(super) fn largest_size(values: &[Complex]) -> f64 {
    let sizes = values.iter().map(|value| size(*value));
    sizes.fold(f64::MIN_POSITIVE, f64::max)
}

/// The eigenvalues under a name, `NAME.eigenvalue.K.re` and `.im`.
pub(super) fn eigenvalues(summary: &Value, name: &str) -> Vec<Complex> {
    let of = |k: usize, part: &str| result(summary, &format!("{name}.eigenvalue.{k}.{part}"));
    (1..)
        .map_while(|k| Some([of(k, "re")?, of(k, "im")?]))
        .collect()
}
