//! Masses, loads and the reduced model of mechanisms in space: the same two unit passes as in the plane, with the gyroscopic term,
//!
//! ```text
//! f = m a_c,     n = I ω̇ + ω × I ω         about the centre of mass, in the axes of the ground          (1)
//! m = Σ m v_c·v_c + ω·Iω,     ½m′ = Σ m v_c·a_c + ω·Iω̇                                                 (2)
//! ```
//!
//! ω × Iω does no work: of all coefficients only the reactions' b contain it.
//!
//! ```
//! use dwell_geometry::space::{Actuator, Assembly, Joint, JointKind, Mechanism, Side, vec3};
//! use dwell_geometry::{Body, JointId};
//! use dwell_kinetostatics::space::{Axes, Component, Mass, Model, Reaction};
//! use dwell_kinetostatics::{ExactModel, ReducedModel};
//!
//! // A disc on a shaft along z, tilted by its products of inertia: turning it takes a moment in the bearing.
//! let mechanism = Mechanism {
//!     bodies: ["ground", "disc"].map(Body::named).into(),
//!     ground: 0,
//!     joints: vec![Joint::new("A", [0, 1], JointKind::Revolute, [Side::default(); 2])],
//!     actuators: vec![Actuator::angle("q", 0)],
//!     couplings: Vec::new(),
//! };
//! let disc = Mass { mass: 1.0, center: vec3(0.0, 0.0, 0.0), inertia: [0.02, 0.02, 0.04, 0.0, 0.003, 0.0] };
//! let moment = |index| Reaction { joint: JointId(0), component: Component::Moment(Axes::Ground, index) };
//! let model = Model::new(&mechanism, &[Mass::default(), disc], &Assembly::at(&[0.0]), &[moment(0), moment(1)])?;
//!
//! let reduced = ExactModel::new(model).ok_or("one actuator")?;
//! let (mut workspace, mut found) = (reduced.workspace(), reduced.model().coefficient_buffer());
//! reduced.coefficients(0.0, &mut workspace, &mut found)?;
//! assert!((found.m - 0.04).abs() < 1e-15);
//! // ω × Iω = (−I_yz, I_xz, 0) ω² and I ω̇ = (I_xz, I_yz, I_zz) ω̇.
//! assert!((found.b[1] - 0.003).abs() < 1e-15 && (found.a[0] - 0.003).abs() < 1e-15);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod action;
mod compiled_loads;
mod friction;
mod idle_moments;
mod in_plane;
mod lifted_reactions;
mod load;
mod machine;
mod mass;
mod model;
mod on_fit;
mod pass;
mod recorded;
mod reduced;
mod response;
mod surface_friction;

pub use dwell_geometry::space::{Coordinate, CoordinateFunction};
pub use load::{DirectedCouple, Direction, Load, LoadKind};
pub use mass::Mass;
pub use model::{Axes, Component, Model, ModelError, Reaction, Workspace};
