//! Intervals of numbers.

/// The smallest and the largest of some values; [∞, −∞] if there are none.
pub fn extent(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    let values = values.into_iter();
    values.fold(none, |[low, high], v| [low.min(v), high.max(v)])
}

/// `count` + 1 equally spaced values from the first to the second.
pub(crate) fn equally_spaced([from, to]: [f64; 2], count: usize) -> Vec<f64> {
    let at = |i: usize| from + (to - from) * i as f64 / count as f64;
    (0..=count).map(at).collect()
}
