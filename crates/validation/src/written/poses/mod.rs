//! The files of the commands about positions: `kinematics`, `statics`, `kinetostatics`, `reduce` and `runs`.
//!
//! ```text
//! scene_text (its TOML, changed) ── program as a process ── files, sentences ── rows, stated
//!      ├── other rows, other requests, other units ── extrema_again, same_columns, other_units ──┐
//!      ├── symbolic ── generated_code, printed_formulas ────────────────────────────────────────┤
//!      └── sentences ── contents, largest_values, movement, overshoot, printed_numbers ─────────┴── findings
//! ```

pub(crate) mod compared;
mod contents;
pub(crate) mod difference;
mod expression;
pub(crate) mod extrema_again;
mod generated_code;
pub(crate) mod largest_values;
mod movement;
mod other_units;
mod overshoot;
pub(super) mod positions;
mod printed_formulas;
pub(crate) mod printed_numbers;
pub(crate) mod program;
mod read_files;
mod reduced_files;
pub(crate) mod rows;
mod same_columns;
pub(crate) mod scene_text;
pub(crate) mod stated;
pub(crate) mod units;

pub(super) use positions::compare;
