//! Independent truths that a mechanism's results are held against.
//!
//! What is judged is a [`Subject`]: anything that answers where the bodies are, what the reduced
//! coefficients are and what the reactions are. What it is judged by is computed here from the
//! mechanism's dense constraint rows alone ([`Dense`]), never by the product's own plan, and as
//! far as possible from positions and velocities only. Each truth is a file of [`truths`] that
//! tells its equation; each yields plain [`Finding`]s, and a deliberate fault is a wrapper around
//! a subject, so that production code holds none.
//!
//! ```text
//! Case (mechanism, masses, range, positions)  +  Subject
//!         └── Bench: the mechanism closed densely at every position, the scales
//!                └── truths::… → Finding
//! ```
//!
//! [`verify_all`] does all of it, for one degree of freedom. [`judge_states`] holds kinetostatic
//! states of any number of actuators, under loads, against the equations of motion, [`judge_motion`]
//! a free motion against the full multibody equations ([`Unreduced`]), and [`rank`] says what the
//! rows of a mechanism leave free and what they say twice.
//!
//! Source: L. Jordi, E. Zayas, S. Cardona, *Reduced parameters for the dynamic study of a system
//! of one degree of freedom*, TMT 2008; cited as (Jordi, Zayas & Cardona 2008, eq. n).

mod acts;
mod all;
mod bench;
mod case;
mod closing;
mod curves;
mod dense;
mod differences;
mod free_motion;
mod judge;
mod loads;
mod motion;
mod rank;
mod rounding;
mod solve;
mod state;
mod subject;
pub mod truths;
mod unreduced;

pub use all::verify_all;
pub use bench::{Bench, Scales, Site};
pub use case::{Case, spread};
pub use closing::Closed;
pub use curves::{ErrorCurve, half_dm_curve, reaction_curve};
pub use dense::{Dense, DenseError, condition};
pub use dwell_findings::Finding;
pub use dwell_geometry::Range;
pub use free_motion::{FreeMotion, FreeMotionCase, Rung, free_motion};
pub use loads::load_acts;
pub use rank::{Rank, Ranks, rank};
pub use state::{BodyAct, State, judge_energies, judge_states};
pub use subject::{Actions, Coefficients, Subject, SubjectError};
pub use unreduced::{MotionSample, Unreduced, UnreducedError, judge_motion};
