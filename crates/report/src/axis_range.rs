//! The interval an axis shows, and the positions of values in it.

use crate::axis::{Axis, Scale};

/// Limit of axis values: the difference of two ends must stay finite.
const MAX_VALUE: f64 = 1e300;
/// A range below this fraction of the values is rounding, and is shown as a constant.
const MIN_RELATIVE_SPREAD: f64 = 1e-12;

/// A scaled interval; on a logarithmic scale both ends are positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct AxisRange {
    pub(crate) scale: Scale,
    pub(crate) min: f64,
    pub(crate) max: f64,
}

/// Whether a scale can show a value.
pub(crate) fn drawable(scale: Scale, value: f64) -> bool {
    value.is_finite() && (scale != Scale::Log || value > 0.0)
}

impl AxisRange {
    pub(crate) fn new(scale: Scale, min: f64, max: f64) -> Self {
        Self { scale, min, max }
    }

    /// The range of the axis: its own range if valid, otherwise the extent of the drawable values with `margin` (a
    /// fraction of the extent) on both sides.
    pub(crate) fn of(axis: &Axis, values: impl IntoIterator<Item = f64>, margin: f64) -> Self {
        let scale = axis.scale;
        if let Some([a, b]) = axis.range {
            let (low, high) = (a.min(b), a.max(b));
            if drawable(scale, low) && drawable(scale, high) && low < high {
                return Self::new(scale, low.max(-MAX_VALUE), high.min(MAX_VALUE));
            }
        }
        let mut extent: Option<(f64, f64)> = None;
        for v in values.into_iter().filter(|&v| drawable(scale, v)) {
            // Below the normal numbers a quotient has no correct digits.
            let min_value = match scale {
                Scale::Log => f64::MIN_POSITIVE,
                Scale::Linear | Scale::Degrees => -MAX_VALUE,
            };
            let v = v.clamp(min_value, MAX_VALUE);
            extent = Some(extent.map_or((v, v), |(low, high)| (low.min(v), high.max(v))));
        }
        match (extent, scale) {
            (None, Scale::Log) => Self::new(scale, 1.0, 10.0),
            (None, _) => Self::new(scale, 0.0, 1.0),
            (Some((low, high)), Scale::Log) => Self::widened_log(low, high, margin),
            (Some((low, high)), _) => Self::widened(scale, low, high, margin),
        }
    }

    fn widened_log(low: f64, high: f64, margin: f64) -> Self {
        let (low, high) = if high > low * 1.01 {
            (low, high)
        } else {
            (low / 3.0, high * 3.0)
        };
        // By exponents: the quotient of the ends may overflow.
        let pad = margin * (high.log10() - low.log10());
        let min = 10f64.powf(low.log10() - pad).max(f64::MIN_POSITIVE);
        let max = 10f64.powf(high.log10() + pad).min(MAX_VALUE);
        Self::new(Scale::Log, min, max)
    }

    fn widened(scale: Scale, low: f64, high: f64, margin: f64) -> Self {
        let size = low.abs().max(high.abs());
        let pad = if high - low > MIN_RELATIVE_SPREAD * size {
            margin * (high - low)
        } else if size > 1e-290 {
            // A constant stands in the middle of an axis that shows its size.
            0.1 * size
        } else {
            1.0
        };
        Self::new(scale, low - pad, high + pad)
    }

    /// Position of a value: 0 at the low end, 1 at the high end; none if the scale cannot show it.
    pub(crate) fn fraction(&self, value: f64) -> Option<f64> {
        if !drawable(self.scale, value) {
            return None;
        }
        let fraction = match self.scale {
            Scale::Log => {
                (value.log10() - self.min.log10()) / (self.max.log10() - self.min.log10())
            }
            Scale::Linear | Scale::Degrees => (value - self.min) / (self.max - self.min),
        };
        // Far outside, the exact position is irrelevant, but clipping must stay finite.
        fraction.is_finite().then_some(fraction.clamp(-1e6, 1e6))
    }

    /// Value at a position.
    pub(crate) fn value(&self, fraction: f64) -> f64 {
        match self.scale {
            Scale::Log => {
                let (low, high) = (self.min.log10(), self.max.log10());
                10f64.powf(low + fraction * (high - low))
            }
            Scale::Linear | Scale::Degrees => self.min + fraction * (self.max - self.min),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_logarithmic_axis_has_no_place_for_zero_and_below() {
        let range = AxisRange::of(
            &Axis::log("error", ""),
            [0.0, -1.0, f64::NAN, 1e-12, 1e-2, f64::INFINITY],
            0.0,
        );
        assert!((range.min / 1e-12 - 1.0).abs() < 1e-9 && (range.max / 1e-2 - 1.0).abs() < 1e-9);
        assert_eq!(range.fraction(0.0), None);
        assert_eq!(range.fraction(-1e-5), None);
        assert!((range.fraction(1e-7).unwrap() - 0.5).abs() < 1e-9);
    }

    #[test]
    fn errors_below_1e_minus_10_keep_their_place() {
        let range = AxisRange::of(&Axis::log("error", ""), [5.9e-14, 1e-2], 0.0);
        assert!(range.fraction(5.9e-14).unwrap().abs() < 1e-9);
        assert!(range.fraction(1e-10).unwrap() > 0.2);
    }

    #[test]
    fn constants_and_extremes_give_a_usable_axis() {
        for values in [
            vec![],
            vec![0.0],
            vec![5.0, 5.0],
            vec![-1e-310, 1e-310],
            vec![-f64::MAX, f64::MAX],
        ] {
            for axis in [Axis::new("x", ""), Axis::log("x", ""), Axis::degrees("x")] {
                let range = AxisRange::of(&axis, values.iter().copied(), 0.05);
                assert!(
                    range.min < range.max,
                    "{values:?} on {:?}: {range:?}",
                    axis.scale
                );
                assert!(
                    range
                        .fraction(range.max)
                        .is_some_and(|p| (p - 1.0).abs() < 1e-9)
                );
            }
        }
    }

    #[test]
    fn a_range_that_fits_the_scale_is_kept_and_another_is_not() {
        let range = AxisRange::of(&Axis::log("x", "").with_range(-1.0, 10.0), [2.0, 8.0], 0.0);
        assert!(range.min > 1.9);
        let range = AxisRange::of(&Axis::new("x", "").with_range(3.0, -1.0), [2.0, 8.0], 0.05);
        assert_eq!((range.min, range.max), (-1.0, 3.0));
    }
}
