//! Sweeps: dimensions and motions against the commands on each changed scene, the store against the table, and sentences.

mod motion_results;
mod sweep_files;

pub(super) use sweep_files::compare;
