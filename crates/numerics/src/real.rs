//! The numbers in which straight-line code computes.

use std::ops::{Add, Div, Mul, Sub};

/// A number of straight-line code: the operations that it uses, and no others.
pub trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self>
{
    /// The number nearest to a constant.
    fn of(value: f64) -> Self;

    /// The value as a double.
    fn to_f64(self) -> f64;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Sine of an angle, rad.
    fn sin(self) -> Self;

    /// Cosine of an angle, rad.
    fn cos(self) -> Self;

    /// The angle of the direction (`other`, `self`), rad, in (−π, π].
    fn atan2(self, other: Self) -> Self;
}

/// The functions of a number that has them.
macro_rules! own_functions {
    ($number:ty) => {
        fn sqrt(self) -> Self {
            <$number>::sqrt(self)
        }

        fn sin(self) -> Self {
            <$number>::sin(self)
        }

        fn cos(self) -> Self {
            <$number>::cos(self)
        }

        fn atan2(self, other: Self) -> Self {
            <$number>::atan2(self, other)
        }
    };
}

impl Real for f64 {
    own_functions!(f64);

    fn of(value: f64) -> Self {
        value
    }

    fn to_f64(self) -> f64 {
        self
    }
}

impl Real for f32 {
    own_functions!(f32);

    fn of(value: f64) -> Self {
        value as Self
    }

    fn to_f64(self) -> f64 {
        f64::from(self)
    }
}
