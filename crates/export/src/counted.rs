//! A number type that counts operations.

use dwell_numerics::Real;
use std::cell::Cell;
use std::ops::{Add, Div, Mul, Sub};

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
