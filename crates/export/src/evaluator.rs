//! The exported code in Rust, operation by operation: with it the export measures its errors, its step and its worst
//! case before it is written, and tests compare the compiled code with it.

mod load;
mod motion;
mod pieces;

pub(crate) use load::Load;
pub use motion::{Evaluator, MotionTerms, ReactionTerms, State};

use dwell_numerics::Real;

/// The reason why exported code has no value. Its outputs are then zero, and a state is not changed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum Status {
    /// The coordinate is outside the domain.
    #[error("out of range")]
    OutOfRange,
    /// A number that is not finite came in or out.
    #[error("not finite")]
    NotFinite,
    /// m with everything added is not above zero.
    #[error("no inertia")]
    NoInertia,
}

/// The change of a state's `y` in a step of `h` seconds, by the classical Runge–Kutta method of fourth order.
pub(crate) fn runge_kutta<R: Real>(
    y: &[R],
    h: R,
    rates: impl Fn(&[R]) -> Result<Vec<R>, Status>,
) -> Result<Vec<R>, Status> {
    let half = R::of(0.5) * h;
    let moved = |by: R, rates: &[R]| -> Vec<R> {
        let both = y.iter().zip(rates);
        both.map(|(y, rate)| *y + by * *rate).collect()
    };
    let one = rates(y)?;
    let two = rates(&moved(half, &one))?;
    let three = rates(&moved(half, &two))?;
    let four = rates(&moved(h, &three))?;
    let sixth = h / R::of(6.0);
    let change = |i| sixth * (one[i] + R::of(2.0) * (two[i] + three[i]) + four[i]);
    Ok((0..y.len()).map(change).collect())
}
