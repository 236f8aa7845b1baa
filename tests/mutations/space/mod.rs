//! The mutation study in space: the same numbers that compute wrongly in one line, on the evaluation of mechanisms in space, and
//! wrong descriptions and results.
//!
//! ```text
//! tested    a mechanism with its states, evaluated with a fault and checked as states of `dwell validate` are
//! named     faults that have a name: wrong descriptions, wrong results, a term of the source
//! study     all of them
//! steps     the step of an evaluation that a function belongs to
//! ```

mod named;
pub mod steps;
pub mod study;
pub mod tested;
