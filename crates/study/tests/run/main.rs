//! The tables of `kinematics`, `statics` and `kinetostatics`, held against mechanics that shares
//! nothing with them but the table itself.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod arrows;
mod branch_hints;
mod coupling_tables;
mod early_stops;
mod errors;
mod forces;
mod gears;
mod honest_estimates;
mod machines;
mod many_loads;
mod mechanical_advantage;
mod motion;
mod narrow_peaks;
mod pruning;
mod quadrature;
mod requests;
mod rounding;
mod structures;
mod table;
mod time_loads;
mod unit_loads;
mod variables;
