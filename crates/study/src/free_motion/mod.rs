//! `dwell simulate`: the free motion of a machine in time, under its loads and drives.

pub mod compute;
#[cfg(feature = "output")]
mod output;

pub use compute::{compute_motion, compute_motion_to_accuracy};
#[cfg(feature = "output")]
pub use output::{simulate, simulate_to_accuracy};
