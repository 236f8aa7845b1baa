//! Trials of Dwell by its developers, which the `dwell` command does not link: a fault is planted in every key of a scene, and the checks
//! must detect it ([`keys`]); short loads ([`pulses`]) and machines ([`machines`]) are drawn at random, and a required accuracy must hold.
//!
//! `just trials` runs them, and commits what became of the faults, with commit and date, as `reports/key-faults.txt`: the verification
//! manual of `dwell validate` shows it.

mod altered;
mod drawn;
mod draws;
pub mod keys;
pub mod machines;
pub mod pulses;
