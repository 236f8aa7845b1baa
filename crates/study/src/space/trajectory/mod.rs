//! `dwell kinematics`, `dwell statics` and `dwell kinetostatics` of scenes in space: the same tables, extrema and pages as in the plane.

mod columns;
#[cfg(feature = "output")]
mod drawn_positions;
mod evaluator;
#[cfg(feature = "output")]
mod figures;
mod load_forces;
mod page;
mod reactions;
mod requested;
mod rounding;
mod rows;
mod totals;

pub(super) use self::columns::all_columns;
#[cfg(feature = "output")]
pub(super) use self::drawn_positions::drawn_positions;
pub(super) use self::evaluator::SpaceEvaluator;
#[cfg(feature = "output")]
pub(super) use self::figures::figures;
pub(super) use self::page::space_page;
pub(super) use self::reactions::JointReactions;
pub(super) use self::requested::reject_unknown_variables;
pub(super) use self::rows::{computed_columns, computed_rows, rows_along};
