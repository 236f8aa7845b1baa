//! The error of an analysis, with its locations in the scene file.

use crate::explain::SweepError;
#[cfg(feature = "output")]
use dwell_report::ReportError;
use dwell_scene::SceneError;
use thiserror::Error;

/// Why an analysis fails.
#[derive(Debug, Error)]
pub enum StudyError {
    /// An error of the scene. Boxed, because it carries the text it points into.
    #[error(transparent)]
    Scene(Box<SceneError>),
    /// The output cannot be written.
    #[cfg(feature = "output")]
    #[error(transparent)]
    Report(#[from] ReportError),
    /// A sweep fails.
    #[error(transparent)]
    Sweep(#[from] SweepError),
}

impl From<SceneError> for StudyError {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}
