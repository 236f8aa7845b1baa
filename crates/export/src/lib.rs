//! Out of the workbench: the reduced model of a machine of one degree of freedom as source text that needs nothing.

mod balance;
mod c;
mod describe;
mod evaluator;
mod export;
mod fit;
mod fmu;
mod identifiers;
mod machine;
mod matlab;
mod measure;
mod part;
mod real;
mod rust;
mod writer;

pub use c::c_files;
pub use evaluator::{Evaluator, MotionTerms, ReactionTerms, State, Status};
pub use export::{Export, Request};
pub use fit::{FitError, FittedPart, fit};
pub use fmu::{FmiVersion, FmuFiles, fmu_files};
pub use identifiers::Identifiers;
pub use machine::{
    Domain, Function, FunctionSampler, LoadDescription, LoadEffect, MachineDescription, Motor,
    PartKind, ReferenceSizes,
};
pub use matlab::matlab_files;
pub use measure::{Errors, Measured, STATED_STEP, SelfTestMotion, SelfTestRow, measure};
pub use part::{Column, Part, Precision};
pub use real::Real;
pub use rust::rust_files;
