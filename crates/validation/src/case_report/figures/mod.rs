//! The figures of a case's report.

mod digits;
mod energies;
mod finite_differences;
mod history;
mod mechanism;
mod rounding;
mod states;
mod tolerances;

pub(super) use digits::digits;
pub(super) use energies::energies;
pub(super) use finite_differences::finite_differences;
pub(super) use history::history;
pub(super) use mechanism::{Dwell, mechanism};
pub(super) use rounding::rounding;
pub(super) use states::{actuator_forces, states_drawing};
pub(super) use tolerances::{drift, work_precision};
