//! Exports of scenes, compiled and held against the exact model, its period and its motions. Without a C compiler the tests
//! that compile say so and pass.
#![allow(clippy::unwrap_used, clippy::panic, reason = "tests")]

mod cases;
mod exact;
mod machines;
mod refusals;
mod several_freedoms;
mod single_dwell;
mod toolchain;
