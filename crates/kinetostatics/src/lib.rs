//! Masses, reactions and the reduced model of a mechanism.

pub mod acts;
pub mod balance;
pub mod batch;
mod bearing;
mod channels;
#[cfg(target_arch = "x86_64")]
mod four;
mod friction;
pub mod kinetostatics;
pub mod ledger;
pub mod load;
mod magnitudes;
pub mod mass;
pub mod model;
mod reactions;
pub mod reduced;
mod rounding;
mod runs;
pub mod section;
pub mod table;
mod turns;

pub use acts::{Act, By, LoadError, LoadState};
pub use balance::{PowerBalance, Shaking, Wrench};
pub use batch::Batch;
pub use kinetostatics::KinetostaticsError;
pub use ledger::Ledger;
pub use load::{Friction, Guide, Load, LoadKind, Magnitude, Signal};
pub use magnitudes::Sense;
pub use mass::Mass;
pub use model::{Actions, Model, ModelError, Workspace};
pub use reduced::{Coefficients, Exact, ExactWork, Inertia, Reduced};
pub use section::{Distribution, LinkForces, Section};
pub use table::{Channels, Entry, Extent, Table, TableError};
