//! Errors of two exported kinetostatic runs of the single-dwell mechanism: the dependence of the errors of m, of a reaction
//! and of the period on the number of positions, the printed digits and the interpolation, and whether the stated errors
//! hold.
//!
//! ```text
//! compute ── report
//! ```

mod compute;
mod report;

use dwell_scene::PlaneScene;
use dwell_study::{Outcome, StudyError};

/// The case whose runs are exported.
pub const CASE: &str = "single-dwell";
/// The name of the study.
pub const NAME: &str = "exported runs";

/// The study of a scene of one revolving coordinate: `exported-runs.md`, `.txt` and the folder `exported-runs/`.
///
/// # Errors
/// [`StudyError`] if a run cannot be computed or combined.
pub fn study(scene: &PlaneScene) -> Result<Outcome, StudyError> {
    report::outcome(&compute::cells(scene)?)
}
