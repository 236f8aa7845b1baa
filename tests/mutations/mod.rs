//! The mutation study: deliberate faults, each a wrapper around what is checked, and the independent checks that
//! detect them.
//!
//! ```text
//! mutating_scalar  a number that knows the source line that computes with it, and computes wrongly there
//! operations       every operation of every step is mutated    ┐
//! reduced_model    named faults of the reduced model          │  each checked by
//! claimed_states   named faults of states under loads         │  the independent checks
//! motions          named faults of the equation of motion     │
//! space            the same for mechanisms in space          ┘
//! ```
//!
//! To add a named fault: a variant, its entry in `ALL`, its words and what it does, in one of the last
//! three. A new line of a step needs nothing: its operations are found by evaluating it.

pub mod claimed_states;
pub mod detection;
pub mod figure;
pub mod motions;
mod mutated_model;
pub mod mutating_scalar;
pub mod operations;
mod positions;
mod published;
pub mod reduced_model;
pub mod report;
pub mod source;
pub mod space;
pub mod study;
pub mod tallies;
pub mod tested_mechanism;
mod to_f64;
mod unit_wrenches;
