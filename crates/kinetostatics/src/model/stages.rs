//! The stages of an evaluation. Each borrows the model and the workspace, represents the known quantities, and leads to the next:
//!
//! ```text
//! Model::kinematic_state(q, q̇)     → KinematicState   positions and velocities
//!   .apply_loads(t)                → LoadedState      + magnitudes of the loads; external ones can be set
//!     .inverse_dynamics(q̈)         → ForceState       + wrenches of the loads, for machines that solve for q̈
//!     .evaluate(q̈)                 → EvaluatedState   + friction, accelerations of the bodies, all forces
//! ```
//!
//! Small steps are inlined into the crates above: without that the equation of motion of a loaded machine takes a tenth longer.
//! [`Model::kinetostatics`](super::Model::kinetostatics) and [`Model::statics`](super::Model::statics) take all of them at once. A later stage can do what a
//! [`KinematicState`] can. A wrong order does not compile: inverse dynamics needs the loads,
//!
//! ```compile_fail,E0599
//! # use dwell_kinetostatics::{Model, Workspace, InverseDynamics};
//! # fn f(model: &Model, workspace: &mut Workspace<f64>, result: &mut InverseDynamics<f64>) {
//! let state = model.kinematic_state(&[0.3], &[1.0], workspace).unwrap();
//! state.evaluate(&[0.0], result).unwrap(); // no method `evaluate`: the loads are not applied
//! # }
//! ```
//!
//! and a state ends where the workspace goes on to another:
//!
//! ```compile_fail,E0499
//! # use dwell_kinetostatics::{Model, Workspace, InverseDynamics};
//! # fn f(model: &Model, workspace: &mut Workspace<f64>, result: &mut InverseDynamics<f64>) {
//! let first = model.statics(0.0, &[0.3], workspace, result).unwrap();
//! let second = model.kinematic_state(&[0.4], &[1.0], workspace).unwrap();
//! first.bodies(); // the workspace is borrowed twice
//! # }
//! ```
//!
//! In the right order:
//!
//! ```
//! # use dwell_kinetostatics::{InverseDynamics, KinetostaticsError, Model, Workspace};
//! # fn f(
//! #     model: &Model, workspace: &mut Workspace<f64>, result: &mut InverseDynamics<f64>,
//! # ) -> Result<(), KinetostaticsError> {
//! let state = model.kinematic_state(&[0.3], &[1.0], workspace)?;
//! let state = state.apply_loads(0.0)?.evaluate(&[2.0], result)?;
//! println!("{} N m, {} W", state.inverse_dynamics().tau[0], state.power_balance().loads);
//! # Ok(())
//! # }
//! ```

pub use super::{EvaluatedState, ForceState, KinematicState, LoadedState};
