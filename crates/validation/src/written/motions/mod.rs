//! The motions of `simulate`, by several methods and in other rows, and what is printed of them.

mod change_points;
mod motion_files;

pub(super) use motion_files::compare;
