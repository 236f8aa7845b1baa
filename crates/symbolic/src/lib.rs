//! Closed forms of mechanisms made of dyads: positions, the generalised inertia m(q), ½m′(q), and the two
//! coefficients of a reaction, as named steps that can be read, differentiated, evaluated and printed.
//!
//! Nothing of the velocities, accelerations and forces of the other crates is used: derivatives are taken of
//! the symbols, and a reaction's coefficients come from the joint released as a second coordinate. So the
//! numbers are an independent truth for the reduced model.

mod algebra;
mod chains;
mod dyads;
mod error;
mod form;
mod listing;
mod positions;
mod print;
mod relations;
mod release;
mod sheet;

pub use error::SymbolicError;
pub use form::{Form, Of, Part, Quantity, Symbolic};
pub use print::Language;
pub use sheet::Constant;
