//! Better designs: searches with a certificate.

mod compute;

pub use compute::{
    ActivePeak, Certificate, Combination, ConditionReport, Front, FrontPoint, HistoryPoint,
    MetOptimum, Optimised, OptimisedNumber, job_number, optimise, optimise_choices, optimise_front,
};

#[cfg(feature = "output")]
mod front_output;
#[cfg(feature = "output")]
pub(crate) mod output;
#[cfg(feature = "output")]
mod picture;
