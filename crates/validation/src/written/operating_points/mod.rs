//! The files and sentences of `linearise` and `equilibria` against runs from other starts.
//!
//! ```text
//! program as a process ── matrices, table, summary, sentences ───────────────────── findings
//!      └── starts (changed states and inputs) ── rows of simulate ── slopes (A, B, C, D by differences) ────┤
//!      └── starts in equilibria ── rows of simulate, modes of linearise ── rest ────────────────────────────┤
//!      └── starts near equilibria ── places of linearise ── nearest ───────────────────────────────────────┤
//! summaries, sentences, rows of statics ── equilibrium_files ──────────────────────────────────────────────┘
//! ```

mod eigenvalues;
mod equilibrium_files;
mod linear_file;
mod nearest;
mod point_files;
mod rest;
mod runs;
mod slopes;
mod starts;

pub(super) use point_files::compare;
