//! `dwell runs`: the two kinetostatic runs of the paper, in time, and their combination.

pub mod compute;
#[cfg(feature = "output")]
mod figures;
#[cfg(feature = "output")]
pub(crate) mod output;
#[cfg(test)]
#[cfg(feature = "output")]
mod tests;
