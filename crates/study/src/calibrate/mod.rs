//! `dwell calibrate`: the scene value that gives a required period of the free motion.

mod compute;
#[cfg(feature = "output")]
mod output;

pub use compute::{CalibrationResult, find_value};
#[cfg(feature = "output")]
pub use output::calibrate;
