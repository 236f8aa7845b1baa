//! Loads in inverse dynamics, against hand formulas, virtual work and balances.
#![allow(clippy::expect_used, clippy::panic, reason = "tests")]

mod balances;
mod machines;
mod planets;
mod revolutions;
mod scenes;
mod sections;
mod separating;
mod shapes;
mod statics;
