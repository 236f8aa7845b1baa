//! Pulses: short loads at random times, from rest and in motion, smooth and switched, of widths from a millionth of the
//! motion to all of it. None may be missed, by any method or required accuracy, and what is printed of them must hold.
//!
//! ```text
//! pulse ── subject ── by_hand ── run ── check ── report
//! ```

mod by_hand;
mod check;
mod pulse;
mod report;
mod run;
mod subject;

pub use check::check;
pub use pulse::PulseShape;
pub use report::add_to;
pub use run::{PulseResult, PulseRun, RunKind, evaluate};
pub use subject::PulseSubject;

/// Pulses of a run, and with `--slow`.
pub fn count(slow: bool) -> usize {
    if slow { 1000 } else { 60 }
}
