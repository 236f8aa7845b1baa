//! `dwell cycle`: the steady cycle of a driven machine, and the flywheel that limits its speed fluctuation.

pub mod compute;
mod errors;
#[cfg(feature = "output")]
mod figures;
#[cfg(feature = "output")]
pub(crate) mod output;
