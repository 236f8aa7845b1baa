//! The validation cases: each is computed, checked against independent computations and published numbers, and reported. Three studies
//! belong to them: series of closed forms with ever more extreme parameters ([`extremes`], in other forms [`extremes::forms`]), cost
//! against accuracy ([`work_precision`](mod@work_precision)), and errors of exported runs ([`export_study`]).
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
//! cases ── checked ─┬─ case_report ── overview      extremes      work_precision
//! spatial ──────────┘
//! ```
//!
//! `cases` reads references and evaluates the states of a case in the plane, of which `checked` makes all findings; `spatial` makes those of
//! cases in space. `case_report` writes both, and `overview` is the verdict over all of them.

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

pub use case_report::validate::Validation;
pub use cases::model_states::claimed_motion;
pub use cases::subject::PlanSubject;
pub use checked::multibody::{FreeMotionRun, free_motion_run};
pub use checked::states::{CheckedStates, check_case};
pub use error::ValidationError;
pub use overview::{ValidatedCase, ValidationRun, index};
pub use spatial::{ClaimedAt, SpaceClaims, SpaceReference, solved};
pub use work_precision::work_precision;

use case_report::validate::validate_in_plane;
use dwell_scene::Scene;
use dwell_study::Progress;
use spatial::validate_in_space;
use std::path::Path;

/// Validates the case whose scene is `scene` and whose reference, if any, is in `folder`, and the files that the program at a path writes
/// for it as a process. The files are `NAME.html`, `NAME.md`, `NAME.txt` and the folder `NAME/` with figures; in the plane also `NAME.json`
/// and tables.
///
/// # Errors
/// [`ValidationError`] when the scene or the reference cannot be used. A failed check is no error.
pub fn validate(
    scene: &Scene,
    folder: &Path,
    program: Option<&Path>,
    progress: Progress<'_>,
) -> Result<Validation, ValidationError> {
    match scene {
        Scene::Plane(scene) => validate_in_plane(scene, folder, program, progress),
        Scene::Space(scene) => validate_in_space(scene, folder, program),
    }
}
