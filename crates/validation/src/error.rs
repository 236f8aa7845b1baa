//! Why a case cannot be validated.

use dwell_report::ReportError;
use dwell_study::StudyError;
use thiserror::Error;

/// A case that cannot be validated.
#[derive(Debug, Error)]
pub enum ValidationError {
    /// The scene cannot be computed.
    #[error(transparent)]
    Study(#[from] StudyError),
    /// A reference file cannot be read.
    #[error("{path}: {reason}")]
    Reference {
        /// The file.
        path: String,
        /// The fault.
        reason: String,
    },
}

impl From<ReportError> for ValidationError {
    fn from(error: ReportError) -> Self {
        Self::Study(error.into())
    }
}
