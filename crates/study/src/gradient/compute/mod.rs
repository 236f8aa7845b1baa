//! Computes gradients of results of a sweep by all numbers of a scene.
//!
//! A result along a trajectory is a sum over positions, or an extremum: its derivative is a weighted sum of the derivatives of its signal at
//! positions that stay. Each of these is one reverse sweep through the recorded state, whatever the number of numbers. What has no such
//! form, and numbers that change more than dimensions, masses and loads, are differenced, and are marked so.

mod changes;
mod differences;
mod machine_numbers;
mod outputs;
mod recorded_machine;
mod routes;
mod slopes;
mod tolerance;

pub use machine_numbers::GradientScene;
pub(crate) use outputs::RecordedOutputs;
pub(crate) use recorded_machine::{RecordedMachine, StateOfMotion};
pub(crate) use routes::recorded_signal;
pub use slopes::{Gradient, NumberSlope, ResultGradient, SlopeMethod, compute_gradient};
pub(crate) use tolerance::DesignSlopes;
pub use tolerance::{
    LimitYield, ResultTolerance, Spread, Tolerance, TolerancedNumber, compute_tolerance,
};
