//! The motion of machines: integration, events, energy, period, steady cycles, equilibria, linearisation.

mod along;
mod conservative;
pub mod cycle;
pub mod drive;
pub mod driver;
pub mod equation;
pub mod equilibrium;
pub mod error;
pub mod fate;
pub mod flywheel;
pub mod follow;
mod fourier;
pub mod free;
pub mod linear;
pub mod machine;
pub mod options;
pub mod orbit;
pub mod root;
mod swing;
pub mod system;

pub use cycle::{Cycle, run_up, steady_cycle};
pub use drive::{Drive, DriveError, DriveKind, Motor, Regulator};
pub use driver::{Dense, Ended, Next, Watch, integrate};
pub use equation::Equation;
pub use equilibrium::{Equilibrium, Mode, Stability, equilibria, equilibrium_near};
pub use error::DynamicsError;
pub use fate::{Fate, fate};
pub use flywheel::{Flywheel, flywheel};
pub use follow::{Event, Occurrence, Trace, Trigger, follow};
pub use free::{Run, State, Until, simulate};
pub use linear::{Linear, linearise};
pub use machine::{Guidance, Machine, MachineError, MachineWork, Moving, Worker, all_loads};
pub use options::{Method, Options, Statistics};
pub use orbit::Orbit;
pub use system::{Point, System};
