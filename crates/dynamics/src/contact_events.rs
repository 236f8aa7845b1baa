//! Events of contacts in a motion: `monitor` locates them, `passage` changes the modes of surfaces there, and `impacts` the
//! speeds at end stops.

mod impacts;
mod monitor;
mod passage;

pub(crate) use monitor::ContactMonitor;
use passage::Passage;
pub(crate) use passage::pass;
