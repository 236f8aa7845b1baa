//! The full multibody equations: against closed forms, and as the judge of machines in free motion.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test")]

mod closed_forms;
mod machines;
mod plant;
