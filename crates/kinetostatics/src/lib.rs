//! Masses, reactions and the reduced model of a mechanism.

pub mod load;
pub mod mass;
pub mod model;
mod reactions;
pub mod reduced;
mod runs;

pub use load::{Load, LoadKind, Magnitude, Signal};
pub use mass::Mass;
pub use model::{Actions, Model, ModelError, Workspace};
pub use reduced::{Coefficients, Exact, ExactWork, Inertia, Reduced};
