//! The motions of `simulate`, by several methods and with other rows, and their printed text.

mod change_points;
mod motion_files;

pub(super) use motion_files::compare;
