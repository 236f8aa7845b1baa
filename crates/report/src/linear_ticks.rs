//! Ticks of a linear axis, and the type of all ticks.

use crate::number::{exponent, fixed, power_of_ten, trimmed};

/// Ticks of one axis.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Ticks {
    /// Labelled values, rising.
    pub(crate) major: Vec<f64>,
    /// Their labels.
    pub(crate) labels: Vec<String>,
    /// Values between them that have a faint line and no label.
    pub(crate) minor: Vec<f64>,
    /// The labels are multiples of this power of ten.
    pub(crate) factor: Option<i32>,
    /// The labels are differences from this value, as text.
    pub(crate) offset: Option<String>,
}

/// Values that are rounding beyond an end count as the end.
pub(crate) const ROUNDING_TOLERANCE: f64 = 1e-9;

/// Multiples of a step in an interval, as whole numbers of it.
pub(crate) fn multiples(low: f64, high: f64, step: f64) -> impl Iterator<Item = f64> {
    let first = (low / step - ROUNDING_TOLERANCE).ceil();
    let count = ((high / step + ROUNDING_TOLERANCE).floor() - first).clamp(-1.0, 1000.0) as i64 + 1;
    (0..count).map(move |i| first + i as f64)
}

/// Smallest 1, 2 or 5 times a power of ten that makes no more than `most` ticks: its digit and its exponent.
fn nice_step(low: f64, high: f64, max_count: usize) -> (f64, i32) {
    let min_step = (high - low) / max_count as f64;
    let mut e = exponent(min_step);
    loop {
        for digit in [1.0, 2.0, 5.0] {
            let step = digit * 10f64.powi(e);
            if step > 0.0 && multiples(low, high, step).count() <= max_count {
                return (digit, e);
            }
        }
        e += 1;
    }
}

/// Ticks of an ordinary axis.
pub(crate) fn linear(low: f64, high: f64, max_count: usize) -> Ticks {
    let (digit, e) = nice_step(low, high, max_count);
    let unit = 10f64.powi(e);
    // Labels are made from whole multiples of the unit: 0.30000000000000004 must not stand on an axis.
    let whole: Vec<f64> = multiples(low, high, digit * unit)
        .map(|i| i * digit)
        .collect();
    let major = whole.iter().map(|i| i * unit).collect();
    let largest = whole.iter().fold(0.0_f64, |m, i| m.max(i.abs()));
    let base = if largest >= 1e5 {
        offset(&whole, digit)
    } else {
        0.0
    };
    let parts: Vec<f64> = whole.iter().map(|i| i - base).collect();
    let largest_part = parts.iter().fold(0.0_f64, |m, i| m.max(i.abs()));
    let lead = exponent(largest_part) + e;
    let factor = if (-3..5).contains(&lead) && e > -6 || largest_part == 0.0 {
        0
    } else {
        lead
    };
    let decimals = usize::try_from(factor - e).unwrap_or(0);
    let labels = parts
        .iter()
        .map(|i| fixed(i * 10f64.powi(e - factor), decimals))
        .collect();
    Ticks {
        major,
        labels,
        minor: Vec::new(),
        factor: (factor != 0).then_some(factor),
        offset: (base != 0.0).then(|| offset_text(base, e)),
    }
}

/// The roundest number near ticks that differ only in their last digits.
fn offset(whole: &[f64], digit: f64) -> f64 {
    let (Some(first), Some(last)) = (whole.first(), whole.last()) else {
        return 0.0;
    };
    let (mid, spread) = (0.5 * (first + last), (last - first).max(digit));
    if mid.abs() < 1e4 * spread {
        return 0.0;
    }
    let mut round = 10f64.powi(exponent(mid));
    while round > 1.0 {
        let rounded = (mid / round).round() * round;
        if (rounded - mid).abs() <= 2.0 * spread {
            return rounded;
        }
        round /= 10.0;
    }
    mid.round()
}

fn offset_text(base: f64, e: i32) -> String {
    let size = exponent(base) + e;
    if (-5..7).contains(&size) {
        let text = fixed(base * 10f64.powi(e), usize::try_from(-e).unwrap_or(0));
        return trimmed(&text).to_owned();
    }
    let digits = usize::try_from(exponent(base)).unwrap_or(0);
    let mantissa = fixed(base / 10f64.powi(exponent(base)), digits);
    format!("{}·{}", trimmed(&mantissa), power_of_ten(size))
}
