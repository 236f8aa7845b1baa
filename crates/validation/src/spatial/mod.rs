//! The cases in space: each judged by the dense equations in body coordinates, by Newton's and Euler's equations of each body with motions
//! differenced from positions, by energies and differences, in 32 digits, and by a reference of 25 digits;
//! and what the program writes of each.
//!
//! ```text
//! claims ── reference ── findings ── report
//! ```

mod claims;
mod determined;
mod findings;
mod motion;
mod reference;
mod report;
mod several;
mod states;
mod stopped_motion;
mod subject;

pub use claims::SpaceClaims;
pub(crate) use claims::all_reactions;
pub use motion::solved;
pub use reference::{ClaimedAt, SpaceReference};
pub(crate) use report::validate_in_space;
