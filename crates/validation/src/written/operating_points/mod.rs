//! The files of `linearise` and `equilibria`: eigenvalues against the matrix that is written, frequencies against eigenvalues,
//! and the same numbers in table, summary and sentences.
//!
//! ```text
//! program as a process ── matrices, table, summary, sentences ── characteristic (determinant), modes ── findings
//!      └── starts (changed states and inputs) ── rows of simulate ── slopes (A, B, C, D by differences) ────┤
//!      └── starts in equilibria ── rows of simulate, modes of linearise ── rest ────────────────────────────┤
//!      └── starts near equilibria ── places of linearise ── nearest ───────────────────────────────────────┤
//! summaries, sentences, rows of statics ── equilibrium_files ──────────────────────────────────────────────┘
//! ```

mod characteristic;
mod equilibrium_files;
mod linear_file;
mod modes;
mod nearest;
mod point_files;
mod rest;
mod runs;
mod slopes;
mod starts;

pub(super) use point_files::compare;
