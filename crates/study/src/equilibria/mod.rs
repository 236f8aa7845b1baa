//! `dwell equilibria`: the equilibria of a machine, their stability and eigenvalues.

pub mod compute;
#[cfg(feature = "output")]
mod figures;
#[cfg(feature = "output")]
pub(crate) mod output;

pub use compute::compute_equilibria;
#[cfg(feature = "output")]
pub use output::equilibria;
