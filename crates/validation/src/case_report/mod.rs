//! The report of one case: document, numbers, tables, figures and snapshot.

mod dimensions;
mod document;
mod dwell;
mod family;
mod family_page;
mod figures;
mod numbers;
mod page;
pub(crate) mod report;
pub(crate) mod snapshot;
pub(crate) mod validate;
