//! Work on several poses side by side, in the widest registers that the processor has.

use super::batch::{LANES, LaneScalar};
use crate::model::Model;
use dwell_numerics::Lanes;

/// Work that is written for any number type with lanes. Inlined functions are compiled for each of these types.
pub(crate) trait LaneWork {
    type Output;

    fn run<S: LaneScalar>(self) -> Self::Output;
}

/// Does the work on a model in the processor's widest registers, where it has any of more than two numbers and all groups of the model are
/// inlined, or else with [`Lanes`].
pub(crate) fn in_lanes<W: LaneWork>(model: &Model, work: W) -> W::Output {
    #[cfg(target_arch = "x86_64")]
    let work = match super::registers::run(model, work) {
        Ok(output) => return output,
        Err(work) => work,
    };
    #[cfg(not(target_arch = "x86_64"))]
    let _ = model;
    work.run::<Lanes<LANES>>()
}
