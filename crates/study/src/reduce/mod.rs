//! `dwell reduce`: the reduced parameters over the range.

pub mod compute;
#[cfg(feature = "output")]
pub mod figures;
#[cfg(feature = "output")]
pub(crate) mod output;
mod page;
#[cfg(feature = "output")]
pub(crate) use output::{add_table, reduction_outcome};
#[cfg(feature = "output")]
pub(crate) use page::column_group;
pub(crate) use page::page_of;
pub use page::reduction_page;
