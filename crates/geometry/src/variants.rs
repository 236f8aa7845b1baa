//! Variants of a mechanism: other dimensions in a plan whose structure stays.
//!
//! What a plan knows of its structure (frames, tree, loops, groups, which vectors there are) is found once, for a
//! variant whose dimensions do not coincide by chance; the dimensions of all others are filled in. Whether a variant
//! is on the same assembly branch, and whether its actuator turns fully, is then seen from its own poses.

mod branch;
mod dimensions;
mod lifted;

pub use branch::ModeGuess;
