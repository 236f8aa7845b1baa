//! The numbers in which exported code computes.

use std::cell::Cell;
use std::ops::{Add, Div, Mul, Sub};

/// A number of exported code: the operations that it uses, and no others.
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

thread_local! {
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

/// A double that counts additions, subtractions, multiplications and divisions; its functions are not counted.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Counted(f64);

impl Counted {
    /// The operations of a computation.
    pub(crate) fn operations(computation: impl FnOnce()) -> u64 {
        OPERATIONS.set(0);
        computation();
        OPERATIONS.get()
    }

    fn count(value: f64) -> Self {
        OPERATIONS.set(OPERATIONS.get() + 1);
        Self(value)
    }
}

impl Real for Counted {
    fn of(value: f64) -> Self {
        Self(value)
    }

    fn to_f64(self) -> f64 {
        self.0
    }

    fn sqrt(self) -> Self {
        Self(self.0.sqrt())
    }

    fn sin(self) -> Self {
        Self(self.0.sin())
    }

    fn cos(self) -> Self {
        Self(self.0.cos())
    }

    fn atan2(self, other: Self) -> Self {
        Self(self.0.atan2(other.0))
    }
}

impl Add for Counted {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::count(self.0 + other.0)
    }
}

impl Sub for Counted {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self::count(self.0 - other.0)
    }
}

impl Mul for Counted {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        Self::count(self.0 * other.0)
    }
}

impl Div for Counted {
    type Output = Self;

    fn div(self, other: Self) -> Self {
        Self::count(self.0 / other.0)
    }
}
