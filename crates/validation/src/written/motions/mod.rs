//! The files of `simulate`: rows of a motion compared with the second reading of the scene.
//!
//! ```text
//! scene text ── poses::reading + drives ─┐
//!      └── simulate ── rows ─────────────┴── row_forces (equations of a row), between_rows (energy), summary ── findings
//! ```
//!
//! The rows come from the default method and again from another one, whose rows and events must be the same.

mod between_rows;
mod drives;
mod events;
mod motion_files;
mod motors;
mod row_forces;
mod summary;

pub(crate) use between_rows::simpson;
pub(crate) use drives::{Drive, DriveKind};
pub(super) use motion_files::compare;
pub(crate) use row_forces::MotionReading;
pub(crate) use summary::{sentences, summary_of_rows};
