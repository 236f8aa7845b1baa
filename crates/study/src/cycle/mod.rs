//! `dwell cycle`: the steady cycle of a driven machine, and the flywheel that limits its speed fluctuation.

pub mod compute;
#[cfg(feature = "output")]
mod figures;
#[cfg(feature = "output")]
mod output;

pub use compute::compute_cycle;
#[cfg(feature = "output")]
pub use output::cycle;
