//! Variants of a mechanism: other dimensions in a plan whose structure stays.
//!
//! The structure of a plan (frames, tree, loops, groups, the set of vectors) is found once, for a variant whose
//! dimensions do not coincide by chance. The dimensions of all other variants are filled in. The poses of a variant
//! then show whether it is on the same assembly branch and whether its actuator turns fully.

mod branch;
mod dimensions;
mod lifted;

pub use branch::ModeGuess;
