//! Independent checks of a mechanism's results: each compares them with values computed from the dense constraint
//! equations of the mechanism alone, never from a compiled plan, and as far as possible from positions and velocities only.
//!
//! ```
//! use dwell_geometry::{Body, Joint, Mechanism, Vec2, vec2};
//!
//! let four_bar = Mechanism {
//!     bodies: ["ground", "crank", "coupler", "rocker"].map(Body::named).into(),
//!     joints: vec![
//!         Joint::revolute("A", [0, 1], [Vec2::ZERO, Vec2::ZERO]),
//!         Joint::revolute("B", [1, 2], [vec2(1.0, 0.0), Vec2::ZERO]),
//!         Joint::revolute("C", [2, 3], [vec2(2.0, 0.0), vec2(1.0, 0.0)]),
//!         Joint::revolute("D", [0, 3], [vec2(2.0, 0.0), Vec2::ZERO]),
//!     ],
//!     ..Mechanism::default()
//! };
//! // Frames [x, y, angle] of all bodies, m and rad: crank and rocker upright.
//! let upright = std::f64::consts::FRAC_PI_2;
//! let poses = [[0.0; 3], [0.0, 0.0, upright], [0.0, 1.0, 0.0], [2.0, 0.0, upright]];
//! let ranks = dwell_verify::rank(&four_bar, &poses).unwrap();
//! assert_eq!(ranks.joints.degrees_of_freedom(), 1);
//! assert_eq!(ranks.joints.redundant_count(), 0);
//! ```
//!
//! A [`Subject`] yields the poses, the reduced coefficients and the reactions of a mechanism with one
//! degree of freedom; [`verify_all`] checks it:
//!
//! ```text
//! Case (mechanism, masses, range, positions)  +  Subject
//!         └── CheckContext: the mechanism closed densely at every position, the scales
//!                └── checks::… → Finding
//! ```
//!
//! [`check_states`], [`check_energies`] and [`check_branch`] check kinetostatic states of any number of actuators under loads,
//! [`check_motion`] a motion against the multibody equations ([`MultibodySystem`]), [`check_free_motion`] a free motion
//! against the quadrature of its period, and [`rank()`] finds the degrees of freedom and the redundant constraints.
//! Tests wrap a subject to introduce an error: production code holds none.
//!
//! Source: L. Jordi, E. Zayas, S. Cardona, *Reduced parameters for the dynamic study of a system
//! of one degree of freedom*, TMT 2008; cited as (Jordi, Zayas & Cardona 2008, eq. n).

mod body_motion;
mod case;
pub mod checks;
mod comparison;
mod constraint_closing;
mod context;
mod curves;
mod dense;
mod description;
mod differences;
mod error;
mod forces;
mod free_motion;
mod friction;
mod inertias;
mod loads;
mod lu;
mod motion;
mod multibody;
mod placed_load;
mod pose;
mod rank;
mod redundant_rows;
mod rounding;
mod rows;
pub mod space;
mod state;
mod subject;
mod wrenches;

pub use case::{Case, CheckedMechanism, spread};
pub use checks::verify_all;
pub use comparison::{Comparison, FindingSpec, LargestDifference};
pub use constraint_closing::Configuration;
pub use context::{CheckContext, CheckedPosition, Scales};
pub use curves::{ErrorCurve, half_dm_curve, reaction_curve};
pub use dense::{DenseMechanism, condition_number};
pub use dwell_findings::Finding;
pub use dwell_geometry::Range;
pub use dwell_kinetostatics::Coefficients;
pub use error::DenseError;
pub use free_motion::{CheckedFreeMotion, FreeMotionCase, ToleranceRun, check_free_motion};
pub use inertias::Inertias;
pub use loads::{load_wrenches, magnitude_by_reactions};
pub use multibody::{MotionSample, MultibodyError, MultibodySystem, check_motion};
pub use pose::{Pose, Twist};
pub use rank::{Rank, Ranks, rank};
pub use state::{AssembledMechanism, ClaimedState, check_branch, check_energies, check_states};
pub use subject::{InverseDynamics, Subject, SubjectError};
pub use wrenches::BodyWrench;
