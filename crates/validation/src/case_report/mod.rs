//! The report of one case: document, numbers, tables, figures and snapshot.

mod document;
mod figures;
mod numbers;
mod snapshot;
pub(crate) mod validate;
