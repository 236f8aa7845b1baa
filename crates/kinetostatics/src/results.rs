//! Results of an evaluated state of motion: the forces and couples on every body, balances, and the internal forces of a
//! link.

mod balance;
mod free_body_forces;
mod section;

pub use balance::{PowerBalance, ShakingForce, Wrench};
pub use free_body_forces::FreeBodyForces;
pub use section::{Distribution, LinkForces, Section};
