//! `dwell kinematics`, `dwell statics`, `dwell kinetostatics`: a mechanism along a prescribed motion or a
//! coordinate sweep.

pub mod compute;
#[cfg(feature = "output")]
mod document;
#[cfg(feature = "output")]
mod figures;
#[cfg(feature = "output")]
mod output;

pub use compute::{Analysis, compute_trajectory};
#[cfg(feature = "output")]
pub(crate) use output::report;
#[cfg(feature = "output")]
pub use output::{TrajectoryOutcome, analyse_trajectory};
