//! Gradients of results by all numbers of a scene, and tolerances.

mod compute;

pub use compute::{
    Gradient, GradientScene, LimitYield, NumberSlope, ResultGradient, ResultTolerance, SlopeMethod,
    Spread, Tolerance, TolerancedNumber, compute_gradient, compute_tolerance,
};

#[cfg(feature = "output")]
pub(crate) mod output;
#[cfg(feature = "output")]
pub(crate) mod tolerance_output;
