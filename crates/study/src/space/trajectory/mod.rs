//! `dwell kinematics`, `dwell statics` and `dwell kinetostatics` of scenes in space: the same tables, extrema and pages as in the plane.

mod columns;
mod evaluator;
#[cfg(feature = "output")]
mod figures;
mod load_forces;
#[cfg(feature = "output")]
mod output;
mod page;
mod path;
mod reactions;
mod requested;
mod rounding;
mod rows;
mod totals;

pub(super) use self::columns::all_columns;
pub(super) use self::evaluator::SpaceEvaluator;
#[cfg(feature = "output")]
pub(super) use self::figures::figures;
#[cfg(feature = "output")]
pub use self::output::analyse_in_space;
#[cfg(feature = "output")]
pub(super) use self::output::drawn_positions;
pub(super) use self::page::space_page;
pub(super) use self::reactions::JointReactions;
pub(super) use self::requested::reject_unknown_variables;
pub use self::rows::{compute_trajectory_in_space, trajectory_page_in_space};
pub(super) use self::rows::{computed_rows, rows_along, rows_of};
