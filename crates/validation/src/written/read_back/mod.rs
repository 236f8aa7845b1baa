//! Readers of what was written. They share no code with the writers: each follows the description of its format.

mod csv;
mod json;
mod npz;
mod sentences;
mod table;

pub(crate) use csv::read_csv;
pub(crate) use json::Summary;
pub(crate) use npz::read_npz;
pub(crate) use sentences::{Line, number_after};
pub(crate) use table::{WrittenColumn, WrittenTable};
