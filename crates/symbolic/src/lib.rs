//! Closed forms of mechanisms made of dyads: positions, the generalised inertia m(q), ½m′(q), and the two
//! coefficients of a reaction, as named assignments that can be read, differentiated, evaluated and printed.
//! Derivatives are symbolic, and the coefficients of a reaction follow from the joint released as a second coordinate,
//! without the velocities, accelerations and forces of the other crates; the values therefore check the reduced model.
//!
//! ```
//! use dwell_geometry::{Actuator, AssemblyConfiguration, Body, Joint, Mechanism, Plan, Vec2, vec2};
//! use dwell_kinetostatics::Mass;
//! use dwell_symbolic::Symbolic;
//!
//! let slider_crank = Mechanism {
//!     bodies: ["ground", "crank", "rod", "slider"].map(Body::named).into(),
//!     joints: vec![
//!         Joint::revolute("O", [0, 1], [Vec2::ZERO; 2]),
//!         Joint::revolute("A", [1, 2], [vec2(1.0, 0.0), Vec2::ZERO]),
//!         Joint::revolute("B", [2, 3], [vec2(3.0, 0.0), Vec2::ZERO]),
//!         Joint::prismatic("slide", [0, 3], [Vec2::ZERO; 2], [0.0; 2]),
//!     ],
//!     actuators: vec![Actuator::angle("phi", [0, 1])],
//!     ..Mechanism::default()
//! };
//! // The slider alone has mass, 2 kg; the rod points from the crank to the right.
//! let mut masses = vec![Mass::default(); 4];
//! masses[3].mass = 2.0;
//! let assembly = AssemblyConfiguration {
//!     q: vec![1.0],
//!     initial_guess: vec![None, None, Some(-0.3), None],
//!     ..AssemblyConfiguration::default()
//! };
//! let plan = Plan::compile(&slider_crank, &assembly).unwrap();
//! let form = Symbolic::new(&slider_crank, &masses, &plan).unwrap().closed_form(None).unwrap();
//! // At a right angle the slider is as fast as the crank's pin, 1 m/s at 1 rad/s: m is its mass.
//! let values = form.evaluate(std::f64::consts::FRAC_PI_2);
//! let m = form.quantities.iter().position(|quantity| quantity.code == "m").unwrap();
//! assert!((values[m] - 2.0).abs() < 1e-12);
//! ```

mod algebra;
mod closed_form;
mod code_generation;
mod couplings;
mod dyads;
mod error;
mod format;
mod loops;
mod polar;
mod positions;
mod quantities;
mod release;
mod symbol_table;

pub use closed_form::{ClosedForm, FormulaSection, Symbolic};
pub use error::SymbolicError;
pub use format::Language;
pub use quantities::{Quantity, QuantityOrigin};
pub use symbol_table::Constant;
