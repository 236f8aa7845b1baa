//! The full multibody equations: against closed forms, and as the check of machines in free motion.

#![allow(clippy::unwrap_used, clippy::panic, reason = "a test")]
#![allow(
    dead_code,
    reason = "of the states' setups only what starts a motion is used"
)]

mod closed_forms;
#[path = "../subjects/gauss.rs"]
mod gauss;
mod joints;
mod machines;
#[path = "../states/mechanisms.rs"]
mod mechanisms;
mod more;
#[path = "../states/plain.rs"]
mod plain;
mod plant;
#[path = "../states/setup.rs"]
mod setup;
