//! `dwell reduce`: the reduced parameters over the range.

pub mod compute;
#[cfg(feature = "output")]
pub mod figures;
#[cfg(feature = "output")]
mod output;

pub use compute::{TableRequest, compute_reduction};
#[cfg(feature = "output")]
pub use output::reduce;
