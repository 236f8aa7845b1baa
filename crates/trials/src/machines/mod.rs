//! Random machines: mechanisms of one and two freedoms under loads that switch with time, coordinates and speeds, with
//! motors and with speed controllers that saturate. A required accuracy is kept, or the motion is refused; the
//! estimated error is never below the true one.
//!
//! ```text
//! draw ── reference ── run ── check ── report
//! ```

mod check;
mod draw;
mod reference;
mod report;
mod run;

pub use check::check;
pub use report::add_to;
pub use run::{MachineResult, MachineRun, evaluate};

/// Machines of a run, and with `--slow`.
pub fn count(slow: bool) -> usize {
    if slow { 200 } else { 20 }
}
