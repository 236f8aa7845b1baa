//! Loads in inverse dynamics, against hand formulas, virtual work and balances.
#![allow(clippy::expect_used, reason = "tests")]

mod balances;
mod scenes;
mod sections;
mod shapes;
mod statics;
