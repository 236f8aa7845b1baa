//! The equation of motion of a reduced model: integration, events, energy and period.

pub mod atlas;
mod bridge;
pub mod drive;
pub mod driver;
pub mod equation;
pub mod error;
pub mod follow;
pub mod free;
pub mod machine;
pub mod options;
pub mod quadrature;
pub mod root;
pub mod system;

pub use atlas::{Atlas, AtlasError, Change, Chart, Journey, Leg, Site, Tracked, Why};
pub use bridge::{Bridge, BridgeError};
pub use drive::{Drive, DriveError, DriveKind, Motor, Regulator};
pub use driver::{Dense, Ended, Next, Watch, integrate};
pub use equation::Equation;
pub use error::DynamicsError;
pub use follow::{Event, Occurrence, Trace, Trigger, follow};
pub use free::{Run, State, Until, simulate};
pub use machine::{Guidance, Machine, MachineError, MachineWork, Moving, Worker, all_loads};
pub use options::{Method, Options, Statistics};
pub use quadrature::FreeTurn;
pub use system::{Point, System};
