//! A number that counts what is done with it.

use dwell_kinetostatics::Model;
use dwell_numerics::Scalar;
use std::cell::Cell;
use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub, SubAssign};

thread_local! {
    static OPERATIONS: Cell<u64> = const { Cell::new(0) };
}

/// Operations of one pose with its motion, its torque and all its reactions: sums, products,
/// quotients, signs and functions, one each.
pub fn operations(model: &Model) -> u64 {
    let mut workspace = model.workspace::<CountingScalar>();
    let mut result = model.result_buffer();
    let [q, q_dot, q_ddot] = [1.1, 0.9, -0.6].map(|v| [CountingScalar(v)]);
    let before = OPERATIONS.get();
    let done = model.inverse_dynamics(&q, &q_dot, &q_ddot, &mut workspace, &mut result);
    done.expect("a pose");
    OPERATIONS.get() - before
}

fn count() {
    OPERATIONS.set(OPERATIONS.get() + 1);
}

/// A number of which each operation is counted.
#[derive(Debug, Clone, Copy, Default)]
struct CountingScalar(f64);

impl Scalar for CountingScalar {
    const HAS_DERIVATIVES: bool = false;
    const EPSILON: f64 = f64::EPSILON;
    fn from_f64(value: f64) -> Self {
        Self(value)
    }
    fn value(self) -> f64 {
        self.0
    }
    fn sqrt(self) -> Self {
        count();
        Self(self.0.sqrt())
    }
    fn sin_cos(self) -> (Self, Self) {
        count();
        let (sin, cos) = self.0.sin_cos();
        (Self(sin), Self(cos))
    }
    fn atan2(self, other: Self) -> Self {
        count();
        Self(self.0.atan2(other.0))
    }
    fn compose(self, derivatives: &[f64; 4]) -> Self {
        count();
        Self(derivatives[0])
    }
}

impl Add for CountingScalar {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        count();
        Self(self.0 + other.0)
    }
}

impl Sub for CountingScalar {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        count();
        Self(self.0 - other.0)
    }
}

impl Mul for CountingScalar {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        count();
        Self(self.0 * other.0)
    }
}

impl Div for CountingScalar {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        count();
        Self(self.0 / other.0)
    }
}

impl Neg for CountingScalar {
    type Output = Self;
    fn neg(self) -> Self {
        count();
        Self(-self.0)
    }
}

impl AddAssign for CountingScalar {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for CountingScalar {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}
