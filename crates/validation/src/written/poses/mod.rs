//! The files of the commands about positions: `kinematics`, `statics`, `kinetostatics`, `reduce` and `runs`.
//!
//! ```text
//! scene text ── reading (own units, laws, expressions) ─┐
//!      └── program as a process ── files ── rows ───────┴── closure, rates, equilibrium, totals, reduced … ── findings
//! ```
//!
//! Everything is compared by residuals: the rows hold positions, velocities, accelerations and forces, and each must meet the
//! equations that the scene's text gives; nothing is solved.

pub(crate) mod angle_table;
pub(crate) mod closure;
pub(crate) mod compared;
mod contents_files;
mod contents_motions;
mod described_again;
pub(crate) mod difference;
mod drawn_laws;
mod dwell;
pub(super) mod equilibrium;
pub(super) mod expression;
pub(crate) mod extrema_again;
pub(super) mod forces_read;
pub(crate) mod formats;
mod generated_code;
pub(super) mod headings;
pub(super) mod jet;
pub(super) mod joint_forces;
mod largest_values;
pub(super) mod law;
pub(super) mod motion;
mod movement;
mod other_units;
mod overshoot;
pub(super) mod positions;
mod printed_formulas;
pub(crate) mod program;
mod quotients;
pub(crate) mod range;
pub(super) mod rates;
mod read_files;
pub(super) mod reading;
mod reduced;
mod reduced_files;
pub(crate) mod rows;
mod same_columns;
pub(crate) mod scene_text;
mod section_files;
mod sections;
pub(crate) mod stated;
pub(crate) mod table_curve;
mod table_file;
pub(super) mod totals;
mod unit_files;
pub(crate) mod units;
pub(super) mod variants;
pub(super) mod wrenches;

#[cfg(test)]
mod tests;

pub(super) use positions::compare;
