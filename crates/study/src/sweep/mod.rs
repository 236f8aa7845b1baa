//! `dwell sweep`: results of many variants of a scene, stored in files during the computation.

pub mod compute;
#[cfg(feature = "output")]
mod export;
#[cfg(feature = "output")]
pub(crate) mod figure;
#[cfg(feature = "output")]
mod identity;
#[cfg(feature = "output")]
pub(crate) mod output;
#[cfg(feature = "output")]
mod parts;
#[cfg(feature = "output")]
mod share;
#[cfg(feature = "output")]
mod spread;
#[cfg(test)]
#[cfg(feature = "output")]
mod tests;

pub use compute::{Shard, SweepRequest, compute_request, compute_sweep};
