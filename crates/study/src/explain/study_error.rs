//! The errors of analyses, with their locations in the scene file.

#[cfg(feature = "output")]
use dwell_page::PageError;
#[cfg(feature = "output")]
use dwell_report::ReportError;
use dwell_scene::SceneError;
use std::path::PathBuf;
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
    /// The page cannot be made.
    #[cfg(feature = "output")]
    #[error(transparent)]
    Page(#[from] PageError),
    /// A sweep fails.
    #[error(transparent)]
    Sweep(#[from] SweepError),
}

impl From<SceneError> for StudyError {
    fn from(error: SceneError) -> Self {
        Self::Scene(Box::new(error))
    }
}

impl From<StudyError> for SceneError {
    fn from(error: StudyError) -> Self {
        match error {
            StudyError::Scene(scene) => *scene,
            StudyError::Sweep(sweep) => Self::without_labels(sweep.to_string(), sweep.help()),
            // Further kinds are those of written files, where another crate of the program asks for them.
            #[allow(unreachable_patterns, reason = "without files there are none")]
            other => Self::without_labels(other.to_string(), None),
        }
    }
}

/// Why a sweep fails.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SweepError {
    /// An axis, a tied number or a limit is invalid.
    #[error("`{option} {given}`: {reason}")]
    Axis {
        /// The option.
        option: &'static str,
        /// The text given.
        given: String,
        /// The fault.
        reason: String,
        /// The suggestion.
        help: String,
    },
    /// The axes together are invalid.
    #[error("{0}")]
    Design(String),
    /// The scene has no such result.
    #[error("this scene has no result `{name}`")]
    Result {
        /// The requested name.
        name: String,
        /// The result that may be meant.
        near: Option<String>,
        /// The available results.
        known: Vec<String>,
    },
    /// An invalid shard.
    #[error("`{0}` is not a shard: write it as 2/8, the second of eight")]
    Shard(String),
    /// The folder or file holds another study.
    #[error("{} holds another study, {difference}", path.display())]
    DifferentStudy {
        /// The file.
        path: PathBuf,
        /// The first difference, as "with the axes `a` instead of `b`".
        difference: String,
    },
    /// A file is damaged or foreign, or cannot be read or written.
    #[error("{}: {reason}", path.display())]
    Store {
        /// The file.
        path: PathBuf,
        /// The fault.
        reason: String,
    },
}

impl SweepError {
    /// The suggestion.
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Axis { help, .. } => Some(help.clone()),
            Self::Result { known, .. } if known.is_empty() => {
                Some("it defines no motion, load or range to compute results from".to_owned())
            }
            Self::Result { near, known, .. } => {
                let near = near.as_ref();
                let near = near.map_or_else(String::new, |near| format!("did you mean `{near}`? "));
                Some(format!("{near}it has: {}", known.join(", ")))
            }
            Self::DifferentStudy { .. } => Some(
                "give the same --vary, --samples, --seed and --result to continue it, choose another folder \
                 with --out, or move it"
                    .to_owned(),
            ),
            Self::Store { .. } => Some("choose another folder with --out".to_owned()),
            Self::Design(_) | Self::Shard(_) => None,
        }
    }
}
