//! Why a file cannot be imported.

use std::sync::Arc;
use thiserror::Error;

/// The error of an import.
#[derive(Debug, Clone, Error)]
pub enum DoorError {
    /// A file cannot be read.
    #[error("`{file}` cannot be read: {reason}")]
    File {
        /// The file.
        file: String,
        /// The reason.
        reason: String,
    },
    /// The format is not recognised.
    #[error(
        "`{file}` has no format that is recognised: neither its ending nor its beginning shows one"
    )]
    Format {
        /// The file.
        file: String,
    },
    /// A part of a file is wrong, or has no meaning here.
    #[error("{}", .0.message)]
    Part(Box<Part>),
    /// The file does not say which joints drive.
    #[error("the model has {} and no drive", freedoms(*needed))]
    NoDrive {
        /// The degrees of freedom.
        needed: usize,
        /// The joints that may drive.
        joints: Vec<String>,
    },
    /// An option names a part that the model does not have.
    #[error("the model has no {what} `{name}`: it has {known}")]
    Unknown {
        /// A joint, a frame, a keyframe or a body.
        what: &'static str,
        /// The name.
        name: String,
        /// The names that the model has.
        known: String,
    },
    /// Bodies float, that is, neither a joint nor an option connects them with the ground.
    #[error("nothing holds {}: the base floats", .0.join(", "))]
    Floating(Vec<String>),
    /// A number of the model is not finite, or above 1e60.
    #[error("the model has a number that is not finite, or above 1e60, near {0}")]
    Number(String),
}

/// A number of degrees of freedom in words.
pub(crate) fn freedoms(count: usize) -> String {
    let degrees = if count == 1 { "degree" } else { "degrees" };
    format!("{count} {degrees} of freedom")
}

/// A part of a file.
#[derive(Debug, Clone)]
pub struct Part {
    /// What is wrong.
    pub message: String,
    /// What may help; may be empty.
    pub help: String,
    /// The file.
    pub file: Arc<str>,
    /// Its text.
    pub text: Arc<str>,
    /// The place: its first byte, and its length.
    pub span: (usize, usize),
}

impl DoorError {
    pub(crate) fn unknown<'n>(
        what: &'static str,
        name: &str,
        known: impl Iterator<Item = &'n str>,
    ) -> Self {
        let known = known.collect::<Vec<_>>().join(", ");
        let name = name.to_owned();
        Self::Unknown { what, name, known }
    }

    /// The part of a file that the error is about.
    pub fn part(&self) -> Option<&Part> {
        match self {
            Self::Part(part) => Some(part),
            _ => None,
        }
    }

    /// The message with its place, and what may help.
    pub fn full_message(&self) -> String {
        let place = self.part().map_or(String::new(), |part| {
            let before = part.text.get(..part.span.0).unwrap_or_default();
            format!("{}:{}: ", part.file, 1 + before.matches('\n').count())
        });
        let help = self
            .help()
            .map_or(String::new(), |help| format!(" ({help})"));
        format!("{place}{self}{help}")
    }

    /// What may help.
    pub fn help(&self) -> Option<String> {
        let help = match self {
            Self::Part(part) => part.help.clone(),
            Self::Format { .. } => "give --from mjcf, urdf, sdf, asmt or pmks".to_owned(),
            Self::NoDrive { joints, .. } => {
                format!("give --drive with some of {}", joints.join(", "))
            }
            Self::Floating(_) => "--fix BODY holds a body where it is drawn".to_owned(),
            Self::File { .. } | Self::Unknown { .. } | Self::Number(_) => String::new(),
        };
        (!help.is_empty()).then_some(help)
    }
}
