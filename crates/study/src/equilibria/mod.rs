//! `dwell equilibria`: the equilibria of a machine, their stability and eigenvalues.

pub mod compute;
#[cfg(feature = "output")]
mod figures;
#[cfg(feature = "output")]
pub(crate) mod output;
