//! The motion of machines: equations of motion of mechanisms under loads and drives, their integration with events,
//! conservative motion by quadrature, steady cycles, equilibria and linearisation.
//!
//! A pendulum: its small oscillation has the period 2π √(I/(m g r)), and a solver finds it as an event.
//!
//! ```
//! use dwell_dynamics::{CoordinateMode, Event, EventKind, Machine, Method, OdeState, Options, solve};
//! use dwell_geometry::body_states::CoordinateFunction;
//! use dwell_geometry::{Actuator, AssemblyConfiguration, Body, BodyId, Joint, Mechanism, Vec2, vec2};
//! use dwell_kinetostatics::{Load, LoadKind, Magnitude, Mass, Model};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let bodies = [BodyId(0), BodyId(1)];
//! let mechanism = Mechanism {
//!     bodies: ["ground", "bob"].map(Body::named).into(),
//!     joints: vec![Joint::revolute("pivot", bodies, [Vec2::ZERO; 2])],
//!     actuators: vec![Actuator::angle("q", bodies)],
//!     ..Mechanism::default()
//! };
//! // 2 kg at 0.5 m from the pivot; q is the angle from the horizontal, and the start 1e-4 rad from hanging.
//! let bob = Mass { mass: 2.0, center: vec2(0.5, 0.0), inertia: 0.0 };
//! let weight = Load {
//!     name: "gravity".to_owned(),
//!     kind: LoadKind::Gravity { direction: vec2(0.0, -1.0) },
//!     magnitude: Magnitude::Constant(9.81),
//! };
//! let q = 1e-4 - std::f64::consts::FRAC_PI_2;
//! let assembly =
//!     AssemblyConfiguration { q: vec![q], initial_guess: vec![None; 2], ..AssemblyConfiguration::default() };
//! let model = Model::new(&mechanism, &[Mass::default(), bob], &assembly, &[])?;
//! let machine = Machine::new(model, &[weight], vec![CoordinateMode::Free], &[])?;
//!
//! let start = OdeState { t: 0.0, y: machine.initial_state(&[q], &[0.0]) };
//! let reversal = Event { kind: EventKind::Reversal(CoordinateFunction::Angle(bodies)), terminal: None };
//! let options = Options::new(Method::Dop853, 1e-12);
//! let solution = solve(&machine, machine.model(), &start, 5.0, &options, &[reversal])?.completed()?;
//! let times: Vec<f64> = solution.event_occurrences.iter().map(|o| o.state.t).collect();
//! let period = times[2] - times[0];
//! assert!((period / (std::f64::consts::TAU * (0.5_f64 / 9.81).sqrt()) - 1.0).abs() < 1e-6);
//! # Ok(())
//! # }
//! ```

pub mod atlas;
mod change_point_fit;
mod close_branches;
mod conservative;
pub mod contact;
mod contact_events;
mod crossings;
pub mod cycle;
mod dop853;
mod drive;
mod eigenvalues;
pub mod equilibrium;
pub mod error;
pub mod flywheel;
pub mod integrate;
mod integration_parts;
pub mod interruption;
mod libration;
pub mod machine;
pub mod machine_ode;
mod modes;
pub mod motion_class;
pub mod ode;
pub mod options;
pub mod orbit;
mod pace;
pub mod reduced_ode;
mod repetition;
mod rotation;
mod sliding;
mod sliding_system;
pub mod solve;
pub mod state_space;
mod state_switches;
mod switch_monitor;
pub mod tabulated;
mod time_density;
mod time_pieces;

pub use atlas::{
    Atlas, AtlasError, Chart, ChartChange, ChartChangeReason, ContinuedMotion, CoordinateHistory,
    MachineDescription, Segment,
};
pub use change_point_fit::{ChangePointFit, ChangePointFitError, FitWindow};
pub use contact::{ContactEvent, ContactMode, EndStop, StopChange, YieldingStop};
pub use cycle::{Cycle, initial_transient, steady_cycle};
pub use drive::DriveError;
pub use equilibrium::{
    Equilibrium, Mode, NeutralDirection, Stability, equilibria, equilibria_from_starts,
    equilibrium_near, static_force_and_potential,
};
pub use error::DynamicsError;
pub use flywheel::{Flywheel, size_flywheel};
pub use integrate::integrate;
pub use machine::{
    CoordinateMode, EvaluatedIn, Machine, MachineError, MachineState, MachineWorkspace,
    MovingModel, NonconservativeSource, SpaceFitWindow, loads_with_drives,
};
pub use machine_ode::MachineOde;
pub use modes::{EventSide, MotionModes, SharedModes};
pub use motion_class::{MotionClass, motion_class};
pub use ode::{
    DenseOutput, OdeState, OdeSystem, ReducedState, StepControl, StepObserver, Termination,
};
pub use options::{Method, Options, Statistics};
pub use orbit::{Orbit, OrbitSequence};
pub use reduced_ode::{ReducedCoordinate, ReducedOde, ReducedOutputs, solve_reduced};
pub use sliding::Sliding;
pub use solve::{
    Event, EventKind, EventOccurrence, Observed, ObservedMachine, ObservedValue, Solution, solve,
    solve_further, solve_orbit, solve_system,
};
pub use state_space::{StateSpace, eigenvalues_about, is_equilibrium, linearise};
pub use tabulated::{TabulatedMachine, TabulatedMachineOde, TabulationError};
