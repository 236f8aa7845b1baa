//! A subject for the tests, and mechanisms to check it on.

#![allow(dead_code, reason = "each test binary uses its part")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "a test")]

pub(crate) mod dense;
mod gauss;
pub(crate) mod mechanisms;
pub(crate) mod mutated;
