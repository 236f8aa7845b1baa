//! Intervals that contain every value of an operation on their members, rounding included.
//!
//! (R. E. Moore, R. B. Kearfott, M. J. Cloud, *Introduction to Interval Analysis*, chapters 2 and 5.) Bounds are moved
//! outward by a few roundings after each operation: more than the elementary functions of any platform err.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// All numbers from `lo` to `hi`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Interval {
    pub(crate) lo: f64,
    pub(crate) hi: f64,
}

impl Interval {
    /// All numbers: no bound.
    pub(crate) const ENTIRE: Self = Self {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
    };

    pub(crate) fn point(x: f64) -> Self {
        Self::checked(x, x)
    }

    /// The interval between two bounds; all numbers if one is NaN.
    pub(crate) fn checked(lo: f64, hi: f64) -> Self {
        if lo <= hi {
            Self { lo, hi }
        } else {
            Self::ENTIRE
        }
    }

    /// The interval between two bounds, widened by rounding.
    fn outward(lo: f64, hi: f64) -> Self {
        let slack = |x: f64| 4.0 * f64::EPSILON * x.abs() + f64::MIN_POSITIVE;
        let lower = if lo.is_finite() { lo - slack(lo) } else { lo };
        let upper = if hi.is_finite() { hi + slack(hi) } else { hi };
        Self::checked(lower, upper)
    }

    pub(crate) fn contains(self, x: f64) -> bool {
        self.lo <= x && x <= self.hi
    }

    pub(crate) fn width(self) -> f64 {
        self.hi - self.lo
    }

    /// Largest absolute value.
    pub(crate) fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    pub(crate) fn hull(self, other: Self) -> Self {
        Self {
            lo: self.lo.min(other.lo),
            hi: self.hi.max(other.hi),
        }
    }

    pub(crate) fn neg(self) -> Self {
        Self {
            lo: -self.hi,
            hi: -self.lo,
        }
    }

    pub(crate) fn add(self, other: Self) -> Self {
        Self::outward(self.lo + other.lo, self.hi + other.hi)
    }

    pub(crate) fn sub(self, other: Self) -> Self {
        self.add(other.neg())
    }

    pub(crate) fn mul(self, other: Self) -> Self {
        let product = |a: f64, b: f64| if a == 0.0 || b == 0.0 { 0.0 } else { a * b };
        let all = [
            product(self.lo, other.lo),
            product(self.lo, other.hi),
            product(self.hi, other.lo),
            product(self.hi, other.hi),
        ];
        let lo = all.into_iter().fold(f64::INFINITY, f64::min);
        let hi = all.into_iter().fold(f64::NEG_INFINITY, f64::max);
        Self::outward(lo, hi)
    }

    pub(crate) fn scale(self, factor: f64) -> Self {
        self.mul(Self::point(factor))
    }

    pub(crate) fn recip(self) -> Self {
        if self.contains(0.0) {
            return Self::ENTIRE;
        }
        Self::outward(1.0 / self.hi, 1.0 / self.lo)
    }

    pub(crate) fn div(self, other: Self) -> Self {
        self.mul(other.recip())
    }

    /// The values of an increasing function.
    pub(crate) fn growing(self, f: impl Fn(f64) -> f64) -> Self {
        Self::outward(f(self.lo), f(self.hi))
    }

    /// The values of an increasing function that is defined between `from` and `to` only.
    pub(crate) fn growing_within(self, [from, to]: [f64; 2], f: impl Fn(f64) -> f64) -> Self {
        if self.lo < from || self.hi > to {
            return Self::ENTIRE;
        }
        self.growing(f)
    }

    pub(crate) fn square(self) -> Self {
        let least = if self.contains(0.0) {
            0.0
        } else {
            self.lo.abs().min(self.hi.abs())
        };
        let most = self.magnitude();
        let Self { hi, .. } = Self::outward(most * most, most * most);
        Self::checked((least * least * (1.0 - 4.0 * f64::EPSILON)).max(0.0), hi)
    }

    pub(crate) fn sqrt(self) -> Self {
        self.growing_within([0.0, f64::INFINITY], f64::sqrt)
            .max_zero()
    }

    /// The interval without negative numbers, for functions that are never negative.
    fn max_zero(self) -> Self {
        Self::checked(self.lo.max(0.0), self.hi)
    }

    pub(crate) fn exp(self) -> Self {
        self.growing(f64::exp).max_zero()
    }

    pub(crate) fn cosh(self) -> Self {
        let most = self.magnitude().cosh();
        let least = if self.contains(0.0) {
            1.0
        } else {
            self.lo.abs().min(self.hi.abs()).cosh()
        };
        Self::outward(least, most)
    }

    pub(crate) fn sin(self) -> Self {
        self.wave(FRAC_PI_2, f64::sin)
    }

    pub(crate) fn cos(self) -> Self {
        self.wave(0.0, f64::cos)
    }

    /// A sine whose crests are at `crest` and whole periods from there.
    fn wave(self, crest: f64, f: impl Fn(f64) -> f64) -> Self {
        let slack = 4.0 * f64::EPSILON * self.magnitude();
        // The width of all numbers is NaN.
        let width = self.width();
        if width.is_nan() || width >= TAU {
            return Self { lo: -1.0, hi: 1.0 };
        }
        let passes = |at: f64| {
            let periods = ((self.hi + slack - at) / TAU).floor();
            at + periods * TAU >= self.lo - slack
        };
        let ends = [f(self.lo), f(self.hi)];
        let Self { lo, hi } = Self::outward(ends[0].min(ends[1]), ends[0].max(ends[1]));
        Self {
            lo: if passes(crest + PI) {
                -1.0
            } else {
                lo.max(-1.0)
            },
            hi: if passes(crest) { 1.0 } else { hi.min(1.0) },
        }
    }

    /// xⁿ for a constant n.
    pub(crate) fn power(self, n: f64) -> Self {
        if n == 0.0 {
            return Self::point(1.0);
        }
        if n < 0.0 {
            return self.power(-n).recip();
        }
        if n.fract() != 0.0 {
            return self
                .growing_within([0.0, f64::INFINITY], |x| x.powf(n))
                .max_zero();
        }
        if n % 2.0 == 0.0 {
            let half = self.square();
            return half.growing(|x| x.max(0.0).powf(0.5 * n)).max_zero();
        }
        self.growing(|x| x.powf(n))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn interval() -> impl Strategy<Value = (Interval, f64)> {
        (-8.0..8.0_f64, 0.0..4.0_f64, 0.0..=1.0_f64).prop_map(|(lo, width, part)| {
            let hi = lo + width;
            (Interval::checked(lo, hi), (lo + part * width).clamp(lo, hi))
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        /// The result of every operation contains the results of its members.
        #[test]
        fn every_member_s_value_is_contained((a, x) in interval(), (b, y) in interval()) {
            let unary: [(Interval, f64); 11] = [
                (a.sin(), x.sin()),
                (a.cos(), x.cos()),
                (a.exp(), x.exp()),
                (a.cosh(), x.cosh()),
                (a.square(), x * x),
                (a.sqrt(), x.sqrt()),
                (a.recip(), 1.0 / x),
                (a.power(3.0), x.powf(3.0)),
                (a.power(4.0), x.powf(4.0)),
                (a.power(-2.0), x.powf(-2.0)),
                (a.power(1.5), x.powf(1.5)),
            ];
            for (i, (found, value)) in unary.into_iter().enumerate() {
                prop_assert!(value.is_nan() || found.contains(value), "{i}: {found:?} {value}");
            }
            for (found, value) in [
                (a.add(b), x + y),
                (a.sub(b), x - y),
                (a.mul(b), x * y),
                (a.div(b), x / y),
                (a.hull(b), x),
            ] {
                prop_assert!(found.contains(value), "{found:?} {value}");
            }
        }
    }

    /// Bounds are tight, not only valid.
    #[test]
    fn waves_and_squares_are_tight() {
        let over = |lo, hi| Interval::checked(lo, hi);
        assert!(over(0.1, 0.2).sin().width() < 0.1);
        assert_eq!(over(1.5, 1.6).sin().hi, 1.0);
        assert_eq!(over(3.1, 3.2).cos().lo, -1.0);
        assert!(over(1e6, 1e6 + 0.01).sin().width() < 0.011);
        assert_eq!(over(-1.0, 2.0).square().lo, 0.0);
        assert!(over(-1.0, 2.0).square().hi < 4.0 + 1e-14);
    }
}
