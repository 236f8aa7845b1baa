//! `dwell reduce`: the reduced parameters over the range.

pub mod compute;
#[cfg(feature = "output")]
pub mod figures;
#[cfg(feature = "output")]
pub(crate) mod output;
mod page;
#[cfg(feature = "output")]
pub(crate) use output::reduction_outcome;
#[cfg(feature = "output")]
pub(crate) use page::column_group;
pub use page::reduction_page;
