//! The files of the commands about positions: `kinematics`, `statics`, `kinetostatics`, `reduce` and `runs`.
//!
//! ```text
//! scene text ── reading (own units, laws, expressions) ─┐
//!      └── program as a process ── files ── rows ───────┴── closure, rates, equilibrium, totals, reduced … ── findings
//! ```
//!
//! Everything is judged by residuals: the rows hold positions, velocities, accelerations and forces, and each must meet the
//! equations that the scene's text gives; nothing is solved.

mod closure;
mod difference;
mod equilibrium;
mod expression;
mod forces_read;
mod jet;
mod law;
mod motion;
mod positions;
mod program;
mod rates;
mod read_files;
mod reading;
mod reduced;
mod rows;
mod scene_text;
mod table_curve;
mod totals;
mod units;
mod wrenches;

pub(crate) use positions::findings;
