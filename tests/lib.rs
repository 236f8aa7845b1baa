//! What tests across crates share: scenes and mechanisms, ways to describe one and the same mechanism, the chain of
//! four-bars with its closed form, and the mutation study.
#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    clippy::missing_panics_doc,
    reason = "tests: a panic is how they fail"
)]
#![allow(
    missing_docs,
    reason = "used by this package alone; the text of a fault says what its variant is"
)]

pub mod cases;
pub mod chain;
pub mod changes;
pub mod fixtures;
pub mod lifted;
pub mod mutations;
pub mod sketch;
