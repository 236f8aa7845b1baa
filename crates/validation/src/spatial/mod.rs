//! The cases in space: each judged by the dense equations in body coordinates, by Newton's and Euler's equations of each body with motions
//! differenced from positions, by energies and differences, in 32 digits, and by a reference of 25 digits.
//!
//! ```text
//! worst ── reference ── samples ── findings ── report
//! ```

mod bodies;
mod findings;
mod period;
mod reference;
mod report;
mod samples;
mod worst;

pub use report::{index_in_space, validate_in_space};
