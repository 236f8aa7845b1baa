//! The validation cases: each is computed, checked against independent computations and published numbers, and
//! reported. Three studies belong to them: series of closed forms with ever more extreme parameters ([`extremes`], in other forms [`extremes::forms`]),
//! what accuracy costs ([`work_precision`](mod@work_precision)), and what exported runs are worth ([`export_study`]).
//!
//! ```
//! use dwell_findings::all_pass;
//! use dwell_scene::PlaneScene;
//! use dwell_validation::check_case;
//! use std::path::Path;
//!
//! let folder = Path::new("../../validation/pendulum-a01");
//! let scene = PlaneScene::read(folder.join("scene.toml"))?;
//! let checked = check_case(&scene, folder)?;
//! assert!(all_pass(&checked.findings));
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! ```text
//! cases ── checked ── case_report ── overview      extremes      work_precision
//! ```
//!
//! `cases` reads the references of a case and evaluates its states, `checked` makes all findings, `case_report` writes
//! them, and `overview` is the verdict over all of them.

pub mod audit;
mod case_report;
mod cases;
mod checked;
mod error;
pub mod export_study;
pub mod extremes;
pub mod lifted;
pub mod manual;
mod overview;
pub mod report_parts;
mod spatial;
pub mod work_precision;
mod written;

pub use case_report::validate::{Validation, validate, validate_program};
pub use cases::subject::PlanSubject;
pub use checked::multibody::{FreeMotionRun, free_motion_run};
pub use checked::states::{CheckedStates, check_case};
pub use error::ValidationError;
pub use overview::{CaseResult, ValidatedCase, ValidationRun, index};
pub use spatial::{ClaimsIn, ReferencePoses, SpaceClaims, SpaceSubject, validate_in_space};
pub use work_precision::work_precision;
