//! Cross-crate tests, in one binary.
#![allow(
    clippy::expect_used,
    clippy::unwrap_used,
    clippy::panic,
    reason = "tests, of which clippy knows only the functions with the attribute"
)]

mod batches;
mod branches;
mod cases;
mod cases_states;
mod chain;
mod change_points;
mod changes;
mod cycles;
mod derivatives;
mod eighth;
mod ends;
mod energies;
mod equilibria;
mod events;
mod extremes;
mod faults;
mod findings;
mod invariance;
mod joints;
mod limits;
mod machine;
mod machines;
mod mobility;
mod motion;
mod multibody;
mod orbits;
mod published;
mod random;
mod refusals;
mod repeatability;
mod rounding;
mod scaling;
mod sketch;
mod slides;
mod symbolic;
mod tabled;
mod tables;
mod told;
mod tradeoff;
mod within;
mod world;
