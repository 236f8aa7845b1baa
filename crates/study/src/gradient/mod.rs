//! Gradients of results by all numbers of a scene.

mod compute;

pub use compute::{
    Gradient, GradientScene, NumberSlope, ResultGradient, SlopeMethod, compute_gradient,
};

#[cfg(feature = "output")]
pub(crate) mod output;
