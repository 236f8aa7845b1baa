//! `dwell reduce --from RUN_I RUN_II`: the reduced parameters from two kinetostatic runs of any program.
//!
//! ```text
//! text_table ── columns ── combine ── sampled_model ── output
//!  (a file)     (which)    (m, a, …)  (between rows)
//! ```

mod columns;
mod combine;
#[cfg(feature = "output")]
mod figures;
#[cfg(feature = "output")]
mod output;
mod sample_errors;
mod sampled_model;
#[cfg(test)]
mod tests;
mod text_table;
mod timed_run;
#[cfg(feature = "output")]
mod written_scene;

pub use columns::ColumnNames;
pub(crate) use columns::unit_factor;
pub use combine::{ExportedRuns, combine_runs};
#[cfg(feature = "output")]
pub use output::reduce_runs;
pub use sample_errors::SampleErrors;
pub use sampled_model::{SampleInterpolation, SampledModel};
pub use text_table::ExportedTable;
