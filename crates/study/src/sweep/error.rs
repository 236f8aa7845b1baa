//! Why a sweep cannot be done, and what to try.

use std::path::PathBuf;
use thiserror::Error;

/// A sweep that cannot be done.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum SweepError {
    /// What is to be varied makes no sense.
    #[error("`--vary {given}`: {reason}")]
    Axis {
        /// As it was given.
        given: String,
        /// What is wrong with it.
        reason: String,
        /// What to try.
        help: String,
    },
    /// The axes together make no study.
    #[error("{0}")]
    Design(String),
    /// A result that the scene does not have.
    #[error("this scene has no result `{name}`")]
    Result {
        /// As it was asked for.
        name: String,
        /// Those it has.
        known: Vec<String>,
    },
    /// A shard that does not exist.
    #[error("`{0}` is no shard: write it as 2/8, the second of eight")]
    Shard(String),
    /// A file of another study.
    #[error("{} holds another study: {difference}", path.display())]
    Other {
        /// The file.
        path: PathBuf,
        /// What differs first.
        difference: String,
    },
    /// A file that is no store of a sweep, cannot be read or cannot be written.
    #[error("{}: {reason}", path.display())]
    Store {
        /// The file.
        path: PathBuf,
        /// What is wrong with it.
        reason: String,
    },
}

impl SweepError {
    /// What to try.
    pub fn help(&self) -> Option<String> {
        match self {
            Self::Axis { help, .. } => Some(help.clone()),
            Self::Result { known, .. } if known.is_empty() => {
                Some("it says of no motion, load or range what could be computed".to_owned())
            }
            Self::Result { known, .. } => Some(format!("it has: {}", known.join(", "))),
            Self::Other { .. } => Some(
                "give the same --vary, --samples, --seed and --want to go on with it; or another folder \
                 with --out; or move the file away"
                    .to_owned(),
            ),
            Self::Store { .. } => Some("another folder can be named with --out".to_owned()),
            Self::Design(_) | Self::Shard(_) => None,
        }
    }
}
