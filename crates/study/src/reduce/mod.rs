//! `dwell reduce`: the reduced parameters over the range.

pub mod compute;
#[cfg(feature = "output")]
pub mod figures;
#[cfg(feature = "output")]
pub(crate) mod output;
#[cfg(feature = "output")]
pub(crate) use output::{add_table, reduction_outcome};
