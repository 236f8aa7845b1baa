//! The ticks of an axis and their labels.

use crate::axis::Scale;
use crate::axis_range::AxisRange;
use crate::linear_ticks::{ROUNDING_TOLERANCE, Ticks, linear, multiples};
use crate::log_ticks;
use crate::number::fixed;

/// The largest number of ticks, at most `most`, whose labels keep apart. `crowded` judges a set of labels.
pub(crate) fn fit(range: &AxisRange, max_count: usize, crowded: impl Fn(&Ticks) -> bool) -> Ticks {
    let mut count = max_count.max(2);
    loop {
        let ticks = ticks_for(range, count);
        if count <= 2 || !crowded(&ticks) {
            return ticks;
        }
        count -= 1;
    }
}

/// Ticks of an axis, about `most` at the most.
pub(crate) fn ticks_for(range: &AxisRange, max_count: usize) -> Ticks {
    match range.scale {
        Scale::Linear => linear(range.min, range.max, max_count),
        Scale::Log => log_ticks::log(range.min, range.max, max_count),
        Scale::Degrees => degrees(range.min, range.max, max_count),
    }
}

fn degrees(low: f64, high: f64, max_count: usize) -> Ticks {
    let span = high - low;
    // Below and beyond, angles are read as plain numbers.
    if !(8.0..=1e7).contains(&span) {
        return linear(low, high, max_count);
    }
    let revolutions =
        (0..5).flat_map(|power| [1.0, 2.0, 5.0].map(|n| 360.0 * n * 10f64.powi(power)));
    let steps: Vec<f64> = [2.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0]
        .into_iter()
        .chain(revolutions)
        .collect();
    // The coarsest step that leaves four intervals, or a coarser one where its labels have no room.
    let start = steps
        .iter()
        .rposition(|step| span / step >= 4.0 - ROUNDING_TOLERANCE)
        .unwrap_or(0);
    let fits = |step: &&f64| multiples(low, high, **step).count() <= max_count;
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

    fn labels(scale: Scale, low: f64, high: f64, max_count: usize) -> Vec<String> {
        ticks_for(
            &AxisRange {
                scale,
                min: low,
                max: high,
            },
            max_count,
        )
        .labels
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
        let small = ticks_for(
            &AxisRange {
                scale: Scale::Linear,
                min: 0.0,
                max: 4e-7,
            },
            5,
        );
        assert_eq!(small.labels, ["0", "1", "2", "3", "4"]);
        assert_eq!(small.factor, Some(-7));
        let large = ticks_for(
            &AxisRange {
                scale: Scale::Linear,
                min: 0.0,
                max: 2e6,
            },
            5,
        );
        assert_eq!((large.labels[1].as_str(), large.factor), ("0.5", Some(6)));
    }

    #[test]
    fn nearly_equal_values_are_shown_as_differences() {
        let ticks = ticks_for(
            &AxisRange {
                scale: Scale::Linear,
                min: 12.300_000_1,
                max: 12.300_000_9,
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
                for max_count in [2, 3, 5, 9] {
                    let ticks = ticks_for(
                        &AxisRange {
                            scale,
                            min: low,
                            max: high,
                        },
                        max_count,
                    );
                    assert_eq!(ticks.major.len(), ticks.labels.len());
                    assert!(
                        !ticks.major.is_empty(),
                        "{scale:?} {low} {high} {max_count}"
                    );
                    assert!(
                        ticks.major.len() <= max_count.max(4),
                        "{scale:?} {low} {high} {max_count}: {:?}",
                        ticks.labels
                    );
                    let tolerance = 1e-6 * (high - low);
                    let inside = |v: &f64| *v >= low - tolerance && *v <= high + tolerance;
                    assert!(
                        ticks.major.iter().all(inside),
                        "{scale:?} {low} {high} {max_count}: {ticks:?}"
                    );
                }
            }
        }
    }

    #[test]
    fn fitting_thins_crowded_labels() {
        let range = AxisRange {
            scale: Scale::Linear,
            min: 0.0,
            max: 1.0,
        };
        assert_eq!(
            fit(&range, 11, |t| t.labels.len() > 3).labels,
            ["0.0", "0.5", "1.0"]
        );
    }
}
