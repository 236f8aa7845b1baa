//! Masses, loads, joint reactions and actuator forces of a mechanism, and its reduced model m(q) q̈ + ½m′(q) q̇² = Q. A
//! [`Model`] is constant and shared between threads; an evaluation writes into a [`Workspace`] of one thread, by
//! [stages](model::stages) that cannot be called in a wrong order.
//!
//! The reduced model of a uniform bar of 2 kg and 1 m that swings about its end: m is its moment of inertia
//! about the joint, mL²/3, and the horizontal reaction at q = 90° is −m L/2 per unit of q̈.
//!
//! ```
//! use dwell_geometry::{Actuator, AssemblyConfiguration, Body, Joint, Mechanism, Vec2, vec2};
//! use dwell_kinetostatics::{ExactModel, Mass, Model, ReducedModel};
//!
//! let mechanism = Mechanism {
//!     bodies: ["ground", "bar"].map(Body::named).into(),
//!     joints: vec![Joint::revolute("A", [0, 1], [Vec2::ZERO; 2])],
//!     actuators: vec![Actuator::angle("q", [0, 1])],
//!     ..Mechanism::default()
//! };
//! let bar = Mass { mass: 2.0, center: vec2(0.5, 0.0), inertia: 2.0 / 12.0 };
//! let start = AssemblyConfiguration { q: vec![0.0], initial_guess: vec![None; 2], ..Default::default() };
//! let model = Model::new(&mechanism, &[Mass::default(), bar], &start, &mechanism.reactions())?;
//!
//! let reduced = ExactModel::new(model).ok_or("one actuator")?;
//! let (mut workspace, mut found) = (reduced.workspace(), reduced.model().coefficient_buffer());
//! reduced.coefficients(90f64.to_radians(), &mut workspace, &mut found)?;
//! assert!((found.m - 2.0 / 3.0).abs() < 1e-15);
//! assert!((found.a[0] + 1.0).abs() < 1e-15); // A.x
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod drive;
pub mod error;
mod friction;
pub mod load;
mod mass;
pub mod model;
mod pass;
mod recorded;
pub mod reduced;
mod reducible_model;
pub mod results;
mod rounding;
pub mod space;
pub mod table;
pub mod variants;
mod varying_inertia;

pub use drive::{Drive, DriveKind, Motor, SpeedController};
pub use error::{KinetostaticsError, LoadError, ModelError};
pub use friction::FrictionState;
pub use load::{
    AppliedWrench, CompiledSignal, Direction, ForceSource, Friction, FrictionContact, Guide, Load,
    LoadCoordinate, LoadKind, LoadNames, LoadShape, LoadState, LoadSymbol, MAX_FUNCTION_SIGNALS,
    Magnitude, MagnitudeFunction, Mesh, PitchLines, PressureAngle, Signal, Strength,
};
pub use mass::Mass;
pub use model::{
    EvaluatedState, ForceState, KinematicState, LoadedState, MachineModel, Model, ModelLoad,
    Workspace,
};
pub use pass::InverseDynamics;
pub use recorded::{
    Described, RecordableModel, RecordedState, StateLayout, StateRecordingError, WantedMotion,
    signal_coordinates,
};
pub use reduced::{
    Batch, Coefficients, ExactModel, ExactWorkspace, Inertia, ReducedModel, ReducibleModel,
};
pub use results::{
    Distribution, FreeBodyForces, LinkForces, PowerBalance, Section, ShakingForce, Wrench,
};
pub use rounding::reduction_rounding_errors;
pub use table::{TableDomain, TableError, TableQuantity, TabulatedModel, UnitLoadResponses};
pub use varying_inertia::{KnownReaction, VaryingInertia};
