//! Gradients of results by all numbers of a scene, and tolerances.

mod compute;

pub use compute::{
    Gradient, GradientScene, LimitYield, NumberSlope, ResultGradient, ResultTolerance, SlopeMethod,
    Spread, Tolerance, TolerancedNumber, compute_gradient, compute_tolerance,
};

pub(crate) use compute::{
    DesignSlopes, RecordedMachine, RecordedOutputs, StateOfMotion, recorded_signal,
};

#[cfg(feature = "output")]
pub(crate) mod output;
#[cfg(feature = "output")]
pub(crate) mod tolerance_output;
