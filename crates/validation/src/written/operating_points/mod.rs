//! The files of `linearise` and `equilibria`: eigenvalues against the matrix that is written, frequencies against eigenvalues,
//! and the same numbers in table, summary and sentences.
//!
//! ```text
//! program as a process ── matrices, table, summary, sentences ── characteristic (determinant), modes ── findings
//! ```

mod characteristic;
mod modes;
mod point_files;

pub(crate) use point_files::findings;
