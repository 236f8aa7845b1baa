//! Ticks of a logarithmic axis.

use crate::linear_ticks::{ROUNDING_TOLERANCE, Ticks, linear, multiples};
use crate::number::{fixed, power_of_ten};

/// Ticks at powers of ten, or within them if the axis is short.
pub(crate) fn log(low: f64, high: f64, max_count: usize) -> Ticks {
    let (bottom, top) = (low.log10(), high.log10());
    let decades: Vec<i32> = multiples(bottom, top, 1.0).map(|e| e as i32).collect();
    if decades.len() < 3 {
        return short_log(low, high, max_count);
    }
    let fits = |step: &i32| decades.iter().filter(|e| *e % step == 0).count() <= max_count;
    let step = [1, 2, 3, 4, 5, 10, 20, 50, 100, 200]
        .into_iter()
        .find(fits)
        .unwrap_or(500);
    let chosen = || decades.iter().copied().filter(|e| e % step == 0);
    // A few small powers read better written out.
    let written_out = chosen().all(|e| (-2..=3).contains(&e));
    let label = |e: i32| {
        if written_out {
            decimal(1.0, e)
        } else {
            power_of_ten(e)
        }
    };
    let minor = if step == 1 && decades.len() <= 5 {
        let from = bottom.floor() as i32;
        let between = (from..=top.ceil() as i32)
            .flat_map(|e| (2..10).map(move |n| f64::from(n) * 10f64.powi(e)));
        between.filter(|v| (low..=high).contains(v)).collect()
    } else {
        decades
            .iter()
            .filter(|e| *e % step != 0)
            .map(|&e| 10f64.powi(e))
            .collect()
    };
    Ticks {
        major: chosen().map(|e| 10f64.powi(e)).collect(),
        labels: chosen().map(label).collect(),
        minor,
        ..Ticks::default()
    }
}

/// Less than about two decades: multiples within a decade are labelled too.
fn short_log(low: f64, high: f64, max_count: usize) -> Ticks {
    let from = low.log10().floor() as i32;
    let to = high.log10().floor() as i32;
    let interval = low * (1.0 - ROUNDING_TOLERANCE)..=high * (1.0 + ROUNDING_TOLERANCE);
    let value = |(n, e): &(f64, i32)| n * 10f64.powi(*e);
    let all = |digits: &[i32]| -> Vec<(f64, i32)> {
        let pairs = (from..=to).flat_map(|e| digits.iter().map(move |&n| (f64::from(n), e)));
        pairs
            .filter(|pair| interval.contains(&value(pair)))
            .collect()
    };
    let nines = all(&[1, 2, 3, 4, 5, 6, 7, 8, 9]);
    for digits in [
        &[1, 2, 3, 4, 5, 6, 7, 8, 9][..],
        &[1, 2, 3, 5],
        &[1, 2, 5],
        &[1, 3],
        &[1],
    ] {
        let chosen = all(digits);
        if (3..=max_count.max(3)).contains(&chosen.len()) || digits.len() == 1 && chosen.len() == 2
        {
            let minor = nines.iter().filter(|p| !chosen.contains(p));
            return Ticks {
                major: chosen.iter().map(value).collect(),
                labels: chosen.iter().map(|&(n, e)| decimal(n, e)).collect(),
                minor: minor.map(value).collect(),
                ..Ticks::default()
            };
        }
    }
    linear(low, high, max_count)
}

/// A digit times a power of ten: written out if short, or else `2·10⁻⁷`.
fn decimal(digit: f64, e: i32) -> String {
    if (-3..=4).contains(&e) {
        return fixed(digit * 10f64.powi(e), usize::try_from(-e).unwrap_or(0));
    }
    if digit == 1.0 {
        power_of_ten(e)
    } else {
        format!("{digit}·{}", power_of_ten(e))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn labels(low: f64, high: f64, max_count: usize) -> Vec<String> {
        log(low, high, max_count).labels
    }

    #[test]
    fn decades_are_raised_and_thinned() {
        assert_eq!(labels(1e-4, 1e4, 9)[0], "10⁻⁴");
        assert_eq!(
            labels(1e-14, 1e-2, 7),
            ["10⁻¹⁴", "10⁻¹²", "10⁻¹⁰", "10⁻⁸", "10⁻⁶", "10⁻⁴", "10⁻²"]
        );
        assert_eq!(labels(0.05, 200.0, 7), ["0.1", "1", "10", "100"]);
    }

    #[test]
    fn short_logarithmic_axes_still_have_ticks() {
        assert_eq!(labels(1.0, 20.0, 5), ["1", "2", "5", "10", "20"]);
        assert!(labels(2.1, 2.9, 6).len() >= 3);
        assert!(labels(2.1e-9, 7.9e-9, 6).len() >= 3);
    }
}
