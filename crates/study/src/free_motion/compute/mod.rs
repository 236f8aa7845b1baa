//! Computes the free motion of a scene.

mod accuracy;
mod between_samples;
mod charted_problem;
mod contacts;
mod description;
mod difference;
mod ending;
mod error_estimate;
mod events;
mod motion_problem;
mod motors;
mod problem;
mod quadrature;
mod refinement;
mod segmented_motion;
mod shortfall;
mod simulation;
mod summary_lines;
mod tables;
mod within_steps;

pub(crate) use charted_problem::{ChartedProblem, Instant, MotionOf, Picked};
pub(crate) use contacts::NamedContacts;
pub(crate) use difference::Difference;
pub(crate) use ending::end_where_impossible;
pub(crate) use events::NumberedEvent;
pub use motion_problem::MotionProblem;
pub(crate) use motion_problem::{ModelOf, compiled_event, motion_to_simulate};
pub use problem::FreeMotionProblem;
pub use segmented_motion::SegmentedMotion;
pub(crate) use segmented_motion::{ComputedMotion, PlaceInMotion};
pub(crate) use shortfall::LARGE_ERROR;
pub(crate) use simulation::simulated;
pub use simulation::{DescribedMotion, FreeMotion, MotionSolver, SimulatedScene};
pub(crate) use summary_lines::first_changes;
pub(crate) use tables::{sample_of, sides_of_step, since_start};
pub(crate) use within_steps::{MAX_STEPS, StatesWithinSteps, exact_state};
