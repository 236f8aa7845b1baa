//! What is checked of a case: its states, its free motion, its period and its rounding errors.

pub(crate) mod analysis;
mod angle_table;
pub(crate) mod free_motion_setup;
pub(crate) mod history;
pub(crate) mod known_reactions;
pub(crate) mod multibody;
pub(crate) mod period_check;
pub(crate) mod rounding_check;
pub(crate) mod states;
