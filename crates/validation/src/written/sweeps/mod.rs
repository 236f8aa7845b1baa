//! The files of `sweep`: its drawn and listed numbers, rows, Parquet files, statistics and sentences.
//!
//! ```text
//! drawn variations ── sweep ── CSV ──┬── draws (a second generator, the distribution itself)
//!                                    ├── statistics (of the rows) ── summary, sentences
//!                                    └── Parquet, NPZ ────────────────────────────────────── findings
//! ```

mod draws;
mod motion_results;
mod statistics;
mod sweep_files;

pub(super) use sweep_files::compare;
