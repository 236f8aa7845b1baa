//! Mechanisms in space: scenes whose points have three numbers.
//!
//! ```
//! use dwell::space::Scene;
//!
//! let rssr = Scene::read("../../validation/spatial/rssr.toml")?.assemble()?;
//! // Crank at 0.3 rad, 10 rad/s, constant speed.
//! let forces = rssr.inverse_dynamics(0.0, &[0.3], &[10.0], &[0.0])?;
//! let [x, y, z] = forces.kinematics().position("rocker.C")?; // m
//! let torque = forces.actuator_force("q")?; // N m
//! // The same from the reduced model, m q̈ + ½m′ q̇² = w F + torque, with the weight F of 9.81 N/kg.
//! let at = rssr.reduced(["B.x"])?.at(0.3)?;
//! assert!((at.half_dm * 100.0 - at.w[0] * 9.81 - torque).abs() < 1e-12);
//! # assert!(x.is_finite() && y.is_finite() && z.is_finite());
//! # Ok::<(), dwell::Error>(())
//! ```
//!
//! The calls and the units are those of mechanisms in the plane; positions, velocities, accelerations and rotations have three numbers,
//! in the axes of the ground. Scenes are written as text: there is no builder.

mod mechanism;
mod reduced;
mod scene;
mod state;

pub use mechanism::Mechanism;
pub use reduced::ReducedModel;
pub use scene::Scene;
pub use state::{InverseDynamics, Kinematics};
