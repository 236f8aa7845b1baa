//! Planar mechanisms: bodies, joints and actuators; their structure; their positions, velocities and accelerations.
//! A [`Mechanism`] describes one, and [`Plan::compile`] assembles it and fixes the order in which it is evaluated.
//!
//! ```
//! use dwell_geometry::{Actuator, AssemblyConfiguration, Body, Joint, Mechanism, Plan, Vec2, vec2};
//!
//! // A four-bar: crank 1 m, coupler 3 m, rocker 3 m, and 3 m between the pins on the ground.
//! let four_bar = Mechanism {
//!     bodies: ["ground", "crank", "coupler", "rocker"].map(Body::named).into(),
//!     ground: 0,
//!     joints: vec![
//!         Joint::revolute("A", [0, 1], [Vec2::ZERO; 2]),
//!         Joint::revolute("B", [1, 2], [vec2(1.0, 0.0), Vec2::ZERO]),
//!         Joint::revolute("C", [2, 3], [vec2(3.0, 0.0); 2]),
//!         Joint::revolute("D", [0, 3], [vec2(3.0, 0.0), Vec2::ZERO]),
//!     ],
//!     actuators: vec![Actuator::angle("q", [0, 1])],
//!     couplings: Vec::new(),
//! };
//!
//! // Assembled with the crank along the ground; the approximate angle of the rocker selects the assembly mode.
//! let plan = Plan::compile(
//!     &four_bar,
//!     &AssemblyConfiguration {
//!         q: vec![0.0],
//!         initial_guess: vec![None, None, None, Some(1.5)],
//!         branch_hints: Vec::new(),
//!     },
//! )?;
//! let mut pose = plan.pose();
//! plan.positions(&[60_f64.to_radians()], &mut pose)?;
//! let [x, y, angle] = plan.body_frames(&four_bar, &pose)[3]; // m, m, rad
//! let c = [x + 3.0 * angle.cos(), y + 3.0 * angle.sin()]; // the pin between coupler and rocker
//! let b = [0.5, 0.75_f64.sqrt()];
//! assert!(((c[0] - b[0]).hypot(c[1] - b[1]) - 3.0).abs() < 1e-14);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod assembly;
mod body_frames;
pub mod body_states;
mod compiler;
pub mod constraint_rows;
pub mod error;
mod follow_branch;
pub mod mechanism;
pub mod mobility;
pub mod motion;
pub mod plan;
pub mod plane;
mod positions;
mod rates;
pub mod space;
pub mod structure;
mod variants;

pub use error::{AssemblyError, PositionError, StructureError};
pub use mechanism::{
    Actuator, ActuatorId, ActuatorKind, Body, BodyId, BranchHint, Component, Condition, Coordinate,
    Coupling, Guide, Joint, JointId, JointKind, Mechanism, Reaction,
};
pub use motion::{ForceBalance, Motion};
pub use plan::range::{NearBranch, Range, RangeLimit};
pub use plan::{AssemblyConfiguration, Plan, Pose};
pub use plane::{Vec2, vec2};
pub use rates::Rates;
pub use structure::{coupling, frames, groups, lower, tree};
pub use variants::ModeGuess;
