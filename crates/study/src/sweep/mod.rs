//! `dwell sweep`: results of many variants of a scene, stored in a file as they are computed.

pub mod compute;
#[cfg(feature = "output")]
mod export;
#[cfg(feature = "output")]
mod figure;
#[cfg(feature = "output")]
pub(crate) mod output;
#[cfg(feature = "output")]
mod parts;
#[cfg(feature = "output")]
mod spread;
#[cfg(feature = "output")]
mod store;
#[cfg(feature = "output")]
mod store_check;
#[cfg(feature = "output")]
mod stored;
#[cfg(test)]
#[cfg(feature = "output")]
mod tests;

pub use compute::{Shard, compute_sweep};
