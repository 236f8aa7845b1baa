//! Export: the reduced model of a machine of one degree of freedom as source text without dependencies.
//!
//! Plain data and a sampler of exact functions come in; [`Export::new`] fits cells of uneven width and measures their errors, or
//! [`Export::exact`] uses the operations of the exact functions, [recorded](dwell_numerics::record) once. Each target then generates texts or
//! bytes: [`c_files`], [`rust_files`], [`fmu_files`], [`matlab_files`]. The [`Evaluator`] is the exported code in Rust, operation
//! by operation. A machine of several degrees of freedom has its equations of motion in C, by [`SeveralFreedomsExport`].
//!
//! A crank whose inertia is 2 + cos q, kg m², as C in single precision:
//!
//! ```
//! use dwell_export::{
//!     Domain, Export, FunctionSampler, MachineDescription, PartKind, Precision, ReferenceSizes, Request, c_files,
//! };
//! use std::convert::Infallible;
//!
//! struct Crank;
//!
//! impl FunctionSampler for Crank {
//!     type Error = Infallible;
//!
//!     fn sample(&mut self, _: PartKind, q: f64, curves: &mut [[f64; 2]], _: &mut [f64]) -> Result<(), Infallible> {
//!         // m and ½m′.
//!         curves.fill([2.0 + q.cos(), -0.5 * q.sin()]);
//!         Ok(())
//!     }
//! }
//!
//! let machine = MachineDescription {
//!     name: "crank".to_owned(),
//!     title: "A crank".to_owned(),
//!     scene_hash: String::new(),
//!     version: "1".to_owned(),
//!     coordinate: "q".to_owned(),
//!     is_angle: true,
//!     domain: Domain { from: 0.0, to: std::f64::consts::TAU, revolutions: 1 },
//!     initial: [0.0, 1.0],
//!     loads: vec![],
//!     reactions: vec![],
//!     points: vec![],
//!     sizes: ReferenceSizes { inertia: 2.0, length: 1.0, unit_loads: vec![] },
//!     left_out: vec![],
//! };
//! let request = Request { accuracy: 1e-5, precision: Precision::Float };
//! let export = Export::new(machine, request, &mut Crank)?;
//! assert!(export.measured.errors.max() < 1e-5);
//! let [(header, _), (source, text)] = c_files(&export);
//! assert_eq!([header, source], ["crank.h", "crank.c"]);
//! assert!(text.contains("crank_step"));
//! # Ok::<(), dwell_export::FitError<Infallible>>(())
//! ```

mod balance;
mod c;
mod counted;
mod describe;
mod error;
mod evaluator;
mod export;
mod fit;
mod fmu;
mod identifiers;
mod machine;
mod matlab;
mod part;
mod rust;
mod several_freedoms;
mod slopes;
mod template;
mod writer;

pub use c::c_files;
pub use error::FitError;
pub use evaluator::{Evaluator, MotionTerms, ReactionTerms, State, Status};
pub use export::{Errors, Export, Measured, Request, STATED_STEP, SelfTestMotion, SelfTestRow};
pub use fmu::{FmiVersion, FmuFiles, fmu_files};
pub use identifiers::Identifiers;
pub use machine::{
    Domain, Function, FunctionSampler, LoadDescription, LoadEffect, MachineDescription, Motor,
    PartKind, ReferenceSizes, Resistance,
};
pub use matlab::matlab_files;
pub use part::{Column, Part, Precision};
pub use rust::rust_files;
pub use several_freedoms::{
    FreeCoordinate, SampledState, SeveralFreedomsDescription, SeveralFreedomsErrors,
    SeveralFreedomsEvaluator, SeveralFreedomsExport, c_files_of_several_freedoms,
};
