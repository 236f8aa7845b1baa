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
mod period;
mod problem;
mod quadrature;
mod refinement;
mod segmented_motion;
mod shortfall;
mod simulation;
mod summary_lines;
mod tables;
mod tried_motion;
mod within_steps;

pub(crate) use accuracy::find_motion;
pub(crate) use charted_problem::{ChartedProblem, Picked};
pub(crate) use contacts::NamedContacts;
pub(crate) use difference::{Compared, Difference, pair_by_time, reactions_at};
pub(crate) use ending::end_where_impossible;
pub(crate) use error_estimate::{error_of, is_at_rest, large_energy_error, large_error};
pub(crate) use events::{event_table, named_events};
pub use motion_problem::MotionProblem;
pub(crate) use motion_problem::{compiled_event, motion_to_simulate};
pub(crate) use period::orbit_in_plane;
pub use problem::FreeMotionProblem;
pub use segmented_motion::SegmentedMotion;
pub(crate) use segmented_motion::{ComputedMotion, PlaceInMotion};
pub(crate) use shortfall::{LARGE_ERROR, not_accurate, not_resolved, too_many_steps};
pub(crate) use simulation::MotionDescription;
pub(crate) use simulation::check_times;
pub use simulation::{DescribedMotion, FreeMotion, MotionSolver, SimulatedScene};
pub(crate) use summary_lines::{
    Energies, balance_line, class_line, cost_line, event_line, first_changes, times_of,
};
pub(crate) use tables::{free_trajectory, sample_of, sides_of_step, since_start};
pub(crate) use tried_motion::TriedMotion;
pub(crate) use within_steps::{MAX_STEPS, StatesWithinSteps, exact_state};
