//! `dwell reduce`: the reduced parameters over the range.

pub mod compute;
#[cfg(feature = "output")]
pub mod figures;
#[cfg(feature = "output")]
pub(crate) mod output;
mod page;
#[cfg(feature = "output")]
pub(crate) use page::column_group;
pub(crate) use page::page_of;
