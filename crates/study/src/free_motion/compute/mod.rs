//! Computes the free motion of a scene.

mod accuracy;
mod between_samples;
mod contacts;
mod description;
mod difference;
mod error_estimate;
mod motors;
mod period;
mod problem;
mod quadrature;
mod refinement;
mod segmented_motion;
mod simulation;
mod tables;
mod tried_motion;
mod within_steps;

pub(crate) use accuracy::find_motion;
pub(crate) use contacts::NamedContacts;
#[cfg(feature = "output")]
pub(crate) use contacts::first_impulses;
pub(crate) use description::{Energies, height_between};
pub(crate) use difference::{Compared, Difference, pair_by_time, reactions_at};
pub(crate) use motors::motor_values;
pub use period::compute_period;
pub use problem::FreeMotionProblem;
pub use segmented_motion::SegmentedMotion;
pub(crate) use segmented_motion::{ComputedMotion, PlaceInMotion};
#[cfg(feature = "output")]
pub(crate) use simulation::compute_free_motion_at;
pub(crate) use simulation::{DEFAULT_SAMPLES, check_sample_interval, check_times};
pub use simulation::{FreeMotion, MotionSolver, compute_free_motion};
pub(crate) use tables::sliding_at;
pub(crate) use tried_motion::TriedMotion;
pub(crate) use within_steps::{MAX_STEPS, StatesWithinSteps, exact_state};
