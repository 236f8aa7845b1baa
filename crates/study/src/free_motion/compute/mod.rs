//! Computes the free motion of a scene.

mod accuracy;
mod difference;
mod error_estimate;
mod motion_table;
mod problem;
mod segmented_motion;
mod tables;

pub(crate) use difference::Difference;
#[cfg(feature = "output")]
pub(crate) use motion_table::motion_and_drives;
pub use motion_table::{MotionSolver, MotionTable, compute_free_motion};
pub use problem::FreeMotionProblem;
pub(crate) use segmented_motion::ComputedMotion;
pub use segmented_motion::SegmentedMotion;
