//! Where an axis has ticks, and what stands beside them.

use crate::figure::Scale;
use crate::log_ticks;
use crate::number::{exponent, fixed, power_of_ten};
use crate::span::Span;

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

/// The largest number of ticks, at most `most`, whose labels keep apart. `crowded` judges a set of labels.
pub(crate) fn fit(span: &Span, most: usize, crowded: impl Fn(&Ticks) -> bool) -> Ticks {
    let mut count = most.max(2);
    loop {
        let ticks = at_most(span, count);
        if count <= 2 || !crowded(&ticks) {
            return ticks;
        }
        count -= 1;
    }
}

/// Ticks of an axis, about `most` at the most.
pub(crate) fn at_most(span: &Span, most: usize) -> Ticks {
    match span.scale {
        Scale::Linear => linear(span.low, span.high, most),
        Scale::Log => log_ticks::log(span.low, span.high, most),
        Scale::Degrees => degrees(span.low, span.high, most),
    }
}

/// Values that are rounding beyond an end count as the end.
pub(crate) const SLACK: f64 = 1e-9;

/// Multiples of a step in an interval, as whole numbers of it.
pub(crate) fn multiples(low: f64, high: f64, step: f64) -> impl Iterator<Item = f64> {
    let first = (low / step - SLACK).ceil();
    let count = ((high / step + SLACK).floor() - first).clamp(-1.0, 1000.0) as i64 + 1;
    (0..count).map(move |i| first + i as f64)
}

/// Smallest 1, 2 or 5 times a power of ten that makes no more than `most` ticks: its digit and its exponent.
fn nice_step(low: f64, high: f64, most: usize) -> (f64, i32) {
    let least = (high - low) / most as f64;
    let mut e = exponent(least);
    loop {
        for digit in [1.0, 2.0, 5.0] {
            let step = digit * 10f64.powi(e);
            if step > 0.0 && multiples(low, high, step).count() <= most {
                return (digit, e);
            }
        }
        e += 1;
    }
}

/// Ticks of an ordinary axis.
pub(crate) fn linear(low: f64, high: f64, most: usize) -> Ticks {
    let (digit, e) = nice_step(low, high, most);
    let unit = 10f64.powi(e);
    // Labels are made from whole multiples of the unit: 0.30000000000000004 has no place on an axis.
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
        let near = (mid / round).round() * round;
        if (near - mid).abs() <= 2.0 * spread {
            return near;
        }
        round /= 10.0;
    }
    mid.round()
}

fn offset_text(base: f64, e: i32) -> String {
    let size = exponent(base) + e;
    if (-5..7).contains(&size) {
        let text = fixed(base * 10f64.powi(e), usize::try_from(-e).unwrap_or(0));
        return if text.contains('.') {
            text.trim_end_matches('0').trim_end_matches('.').to_owned()
        } else {
            text
        };
    }
    let digits = usize::try_from(exponent(base)).unwrap_or(0);
    let mantissa = fixed(base / 10f64.powi(exponent(base)), digits);
    format!(
        "{}·{}",
        mantissa.trim_end_matches('0').trim_end_matches('.'),
        power_of_ten(size)
    )
}

fn degrees(low: f64, high: f64, most: usize) -> Ticks {
    let span = high - low;
    // Below and beyond, angles are read as plain numbers.
    if !(8.0..=1e7).contains(&span) {
        return linear(low, high, most);
    }
    let turns = (0..5).flat_map(|power| [1.0, 2.0, 5.0].map(|n| 360.0 * n * 10f64.powi(power)));
    let steps: Vec<f64> = [2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0]
        .into_iter()
        .chain(turns)
        .collect();
    // The coarsest step that leaves four intervals, or a coarser one where its labels have no room.
    let start = steps
        .iter()
        .rposition(|step| span / step >= 4.0 - SLACK)
        .unwrap_or(0);
    let fits = |step: &&f64| multiples(low, high, **step).count() <= most;
    let step = steps[start..].iter().find(fits).copied().unwrap_or(span);
    let major: Vec<f64> = multiples(low, high, step).map(|i| i * step).collect();
    let labels = major.iter().map(|v| fixed(*v, 0)).collect();
    Ticks {
        major,
        labels,
        ..Ticks::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(scale: Scale, low: f64, high: f64, most: usize) -> Vec<String> {
        at_most(&Span { scale, low, high }, most).labels
    }

    #[test]
    fn linear_ticks_are_round_and_without_noise() {
        assert_eq!(
            labels(Scale::Linear, 0.0, 1.0, 6),
            ["0.0", "0.2", "0.4", "0.6", "0.8", "1.0"]
        );
        assert_eq!(
            labels(Scale::Linear, -0.31, 0.32, 7),
            ["−0.3", "−0.2", "−0.1", "0.0", "0.1", "0.2", "0.3"]
        );
        assert_eq!(
            labels(Scale::Linear, 0.0, 2000.0, 5),
            ["0", "500", "1000", "1500", "2000"]
        );
    }

    #[test]
    fn large_and_small_values_share_one_factor() {
        let small = at_most(
            &Span {
                scale: Scale::Linear,
                low: 0.0,
                high: 4e-7,
            },
            5,
        );
        assert_eq!(small.labels, ["0", "1", "2", "3", "4"]);
        assert_eq!(small.factor, Some(-7));
        let large = at_most(
            &Span {
                scale: Scale::Linear,
                low: 0.0,
                high: 2e6,
            },
            5,
        );
        assert_eq!((large.labels[1].as_str(), large.factor), ("0.5", Some(6)));
    }

    #[test]
    fn nearly_equal_values_are_shown_as_differences() {
        let ticks = at_most(
            &Span {
                scale: Scale::Linear,
                low: 12.300_000_1,
                high: 12.300_000_9,
            },
            5,
        );
        assert_eq!(ticks.offset.as_deref(), Some("12.3"));
        assert_eq!(ticks.factor, Some(-7));
        assert_eq!(ticks.labels, ["2", "4", "6", "8"]);
    }

    #[test]
    fn angles_have_the_steps_of_angles() {
        assert_eq!(
            labels(Scale::Degrees, 0.0, 360.0, 9),
            ["0", "90", "180", "270", "360"]
        );
        assert_eq!(
            labels(Scale::Degrees, -90.0, 90.0, 9),
            ["−90", "−45", "0", "45", "90"]
        );
        assert_eq!(
            labels(Scale::Degrees, 0.0, 120.0, 9),
            ["0", "30", "60", "90", "120"]
        );
        assert_eq!(
            labels(Scale::Degrees, 0.0, 720.0, 9),
            ["0", "180", "360", "540", "720"]
        );
        assert_eq!(
            labels(Scale::Degrees, 0.0, 36_000.0, 6)
                .last()
                .map(String::as_str),
            Some("36000")
        );
        assert!(labels(Scale::Degrees, 0.0, 3.0, 6).len() > 2);
    }

    #[test]
    fn every_axis_has_ticks_within_it_and_no_more_than_asked() {
        for scale in [Scale::Linear, Scale::Log, Scale::Degrees] {
            for (low, high) in [
                (1e-300, 1e300),
                (0.1, 0.1001),
                (1.0, 1e6),
                (1e-9, 3e-9),
                (5.0, 5e5),
                (3.0, 3.5),
            ] {
                for most in [2, 3, 5, 9] {
                    let ticks = at_most(&Span { scale, low, high }, most);
                    assert_eq!(ticks.major.len(), ticks.labels.len());
                    assert!(!ticks.major.is_empty(), "{scale:?} {low} {high} {most}");
                    assert!(
                        ticks.major.len() <= most.max(4),
                        "{scale:?} {low} {high} {most}: {:?}",
                        ticks.labels
                    );
                    let slack = 1e-6 * (high - low);
                    let within = |v: &f64| *v >= low - slack && *v <= high + slack;
                    assert!(
                        ticks.major.iter().all(within),
                        "{scale:?} {low} {high} {most}: {ticks:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn fitting_thins_crowded_labels() {
        let span = Span {
            scale: Scale::Linear,
            low: 0.0,
            high: 1.0,
        };
        assert_eq!(
            fit(&span, 11, |t| t.labels.len() > 3).labels,
            ["0.0", "0.5", "1.0"]
        );
    }
}
