//! The steady cycle of `cycle` in other runs, and its sentences.

mod cycle_files;
mod multipliers;

pub(super) use cycle_files::compare;
