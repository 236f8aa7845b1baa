//! `dwell kinematics`, `dwell statics` and `dwell kinetostatics` of scenes in space: the differences from the plane.

mod columns;
#[cfg(feature = "output")]
mod drawn_positions;
mod evaluator;
#[cfg(feature = "output")]
mod figures;
mod load_forces;
mod page;
mod reactions;
mod row_scene;
mod totals;

#[cfg(feature = "output")]
pub(super) use self::drawn_positions::drawn_positions;
#[cfg(feature = "output")]
pub(super) use self::figures::figures;
pub(super) use self::page::space_page;
pub(super) use self::reactions::SpaceRows;
