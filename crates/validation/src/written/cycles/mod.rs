//! The files of `cycle`: rows, summary and works of the steady cycle, and its period in a long motion by `simulate`.

mod cycle_files;
mod multipliers;

pub(super) use cycle_files::compare;
