//! Searches the best design of a job.
//!
//! The numbers that vary are scaled by their bounds, the goal and the conditions by their values at the first design. Searches from the best
//! of a pool of random designs use exact derivatives (sequential quadratic programming; least squares for the fit of a table). The largest
//! of several extrema has a kink where they tie, which is where least peaks are: a level above all of them has none.

mod certificate;
mod choice;
mod curves;
mod design_distances;
mod design_worker;
mod engine;
mod expressions;
mod front;
mod job;
mod measured;
mod optimised;
mod problem;
mod recorded_designs;
mod search;

pub use certificate::Certificate;
pub use choice::{Combination, optimise_choices};
pub use front::{Front, FrontPoint, optimise_front};
pub use job::job_number;
pub use optimised::{
    ActivePeak, ConditionReport, MetOptimum, Optimised, OptimisedNumber, optimise,
};
pub use search::HistoryPoint;
