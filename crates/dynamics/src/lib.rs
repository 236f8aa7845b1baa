//! The equation of motion of a reduced model: integration, events, energy and period.

pub mod driver;
pub mod equation;
pub mod error;
pub mod quadrature;
pub mod root;

pub use driver::{Method, Options, Run, State, Statistics, Until, simulate};
pub use equation::Equation;
pub use error::DynamicsError;
pub use quadrature::FreeTurn;
