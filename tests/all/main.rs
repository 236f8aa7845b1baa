//! Cross-crate tests, in one binary.
#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "tests, of which clippy knows only the functions with the attribute"
)]

mod accuracy;
mod advised_keys;
mod batches;
mod branch_hints;
mod branches;
mod cases_states;
mod chain;
mod change_points;
mod cycles;
mod derivatives;
mod dop853;
mod drawn_studies;
mod energies;
mod equilibria;
mod equilibria_found;
mod events;
mod extremes;
mod findings;
mod gradient;
mod gradient_tolerance;
mod invariance;
mod joints;
mod limits;
mod machine;
mod machines;
mod manual;
mod mobility;
mod motion;
mod motor;
mod multibody;
mod mutations;
mod optimise;
mod orbits;
mod pictures;
mod published;
mod random;
mod range_limits;
mod recorded;
mod refusals;
mod repeatability;
mod rounding;
mod scaling;
mod separating;
mod slides;
mod space;
mod sweep_results;
mod symbolic;
mod tables;
mod tabulated;
mod variants;
mod work_precision;
