//! The chain of four-bars of IFToMM's benchmark A02: how it is built, its closed form, and a number that counts operations.

pub mod counting_scalar;
pub mod links;
