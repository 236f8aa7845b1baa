//! The tables of `kinematics`, `statics` and `kinetostatics`, held against mechanics that shares
//! nothing with them but the table itself.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod ends;
mod forces;
mod leverage;
mod machines;
mod motion;
mod need;
mod table;
mod told;
