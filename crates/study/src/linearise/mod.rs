//! `dwell linearise`: small motions about an equilibrium or the initial state, as state-space matrices A, B, C and D.

pub mod compute;
#[cfg(feature = "output")]
pub(crate) mod output;
