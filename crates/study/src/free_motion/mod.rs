//! `dwell simulate`: the free motion of a machine in time, under its loads and drives.

pub mod compute;
#[cfg(feature = "output")]
mod output;

pub use compute::{FreeMotion, MotionSolver, compute_free_motion};
#[cfg(feature = "output")]
pub use output::{simulate, simulate_to_accuracy};
