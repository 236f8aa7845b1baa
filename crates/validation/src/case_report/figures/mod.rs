//! The figures of a case's report.

mod accuracy;
mod dimensions;
mod family;
mod mechanism;
mod motion;
mod states;
mod tolerances;

pub(super) use accuracy::{finite_differences, margins, rounding};
pub(super) use family::family;
pub(super) use mechanism::mechanism;
pub(super) use motion::{energies, history};
pub(super) use states::{actuator_forces, states_drawing};
pub(super) use tolerances::{drift, work_precision};
