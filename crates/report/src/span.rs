//! The interval an axis shows, and the places of values in it.

use crate::figure::{Axis, Scale};

/// Beyond this no axis goes: the difference of two ends must stay finite.
const LARGEST: f64 = 1e300;
/// A spread below this share of the values is rounding, and is shown as a constant.
const CONSTANT: f64 = 1e-12;

/// A scaled interval; on a logarithmic scale both ends are positive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) scale: Scale,
    pub(crate) low: f64,
    pub(crate) high: f64,
}

/// Whether a value has a place on a scale at all.
pub(crate) fn drawable(scale: Scale, value: f64) -> bool {
    value.is_finite() && (scale != Scale::Log || value > 0.0)
}

impl Span {
    /// What the axis shows: its own range if that is usable, or else the extent of the drawable values with `margin` (a
    /// share of the extent) on either side.
    pub(crate) fn of(axis: &Axis, values: impl IntoIterator<Item = f64>, margin: f64) -> Self {
        let scale = axis.scale;
        if let Some([a, b]) = axis.range {
            let (low, high) = (a.min(b), a.max(b));
            if drawable(scale, low) && drawable(scale, high) && low < high {
                return Self {
                    scale,
                    low: low.max(-LARGEST),
                    high: high.min(LARGEST),
                };
            }
        }
        let mut extent: Option<(f64, f64)> = None;
        for v in values.into_iter().filter(|&v| drawable(scale, v)) {
            // Below the normal numbers a quotient has no digits left.
            let least = if scale == Scale::Log {
                f64::MIN_POSITIVE
            } else {
                -LARGEST
            };
            let v = v.clamp(least, LARGEST);
            extent = Some(extent.map_or((v, v), |(low, high)| (low.min(v), high.max(v))));
        }
        match (extent, scale) {
            (None, Scale::Log) => Self {
                scale,
                low: 1.0,
                high: 10.0,
            },
            (None, _) => Self {
                scale,
                low: 0.0,
                high: 1.0,
            },
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
        let by = margin * (high.log10() - low.log10());
        let widened = (10f64.powf(low.log10() - by), 10f64.powf(high.log10() + by));
        Self {
            scale: Scale::Log,
            low: widened.0.max(f64::MIN_POSITIVE),
            high: widened.1.min(LARGEST),
        }
    }

    fn widened(scale: Scale, low: f64, high: f64, margin: f64) -> Self {
        let size = low.abs().max(high.abs());
        if high - low > CONSTANT * size {
            let by = margin * (high - low);
            return Self {
                scale,
                low: low - by,
                high: high + by,
            };
        }
        // A constant stands in the middle of an axis that shows its size.
        let by = if size > 1e-290 { 0.1 * size } else { 1.0 };
        Self {
            scale,
            low: low - by,
            high: high + by,
        }
    }

    /// Place of a value: 0 at the low end, 1 at the high end; none if the scale has no place for it.
    pub(crate) fn place(&self, value: f64) -> Option<f64> {
        if !drawable(self.scale, value) {
            return None;
        }
        let part = match self.scale {
            Scale::Log => {
                (value.log10() - self.low.log10()) / (self.high.log10() - self.low.log10())
            }
            Scale::Linear | Scale::Degrees => (value - self.low) / (self.high - self.low),
        };
        // Far outside it does not matter where, but the arithmetic of clipping must stay finite.
        part.is_finite().then_some(part.clamp(-1e6, 1e6))
    }

    /// Value at a place.
    pub(crate) fn value(&self, place: f64) -> f64 {
        match self.scale {
            Scale::Log => {
                let (low, high) = (self.low.log10(), self.high.log10());
                10f64.powf(low + place * (high - low))
            }
            Scale::Linear | Scale::Degrees => self.low + place * (self.high - self.low),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_logarithmic_axis_has_no_place_for_zero_and_below() {
        let span = Span::of(
            &Axis::log("error", ""),
            [0.0, -1.0, f64::NAN, 1e-12, 1e-2, f64::INFINITY],
            0.0,
        );
        assert!((span.low / 1e-12 - 1.0).abs() < 1e-9 && (span.high / 1e-2 - 1.0).abs() < 1e-9);
        assert_eq!(span.place(0.0), None);
        assert_eq!(span.place(-1e-5), None);
        assert!((span.place(1e-7).unwrap() - 0.5).abs() < 1e-9);
    }

    #[test]
    fn errors_below_1e_minus_10_keep_their_place() {
        let span = Span::of(&Axis::log("error", ""), [5.9e-14, 1e-2], 0.0);
        assert!(span.place(5.9e-14).unwrap().abs() < 1e-9);
        assert!(span.place(1e-10).unwrap() > 0.2);
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
                let span = Span::of(&axis, values.iter().copied(), 0.05);
                assert!(
                    span.low < span.high,
                    "{values:?} on {:?}: {span:?}",
                    axis.scale
                );
                assert!(
                    span.place(span.high)
                        .is_some_and(|p| (p - 1.0).abs() < 1e-9)
                );
            }
        }
    }

    #[test]
    fn a_range_that_fits_the_scale_is_kept_and_another_is_not() {
        let span = Span::of(&Axis::log("x", "").within(-1.0, 10.0), [2.0, 8.0], 0.0);
        assert!(span.low > 1.9);
        let span = Span::of(&Axis::new("x", "").within(3.0, -1.0), [2.0, 8.0], 0.05);
        assert_eq!((span.low, span.high), (-1.0, 3.0));
    }
}
