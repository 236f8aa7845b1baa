//! Errors of reports.

use std::path::PathBuf;

/// Why a figure, a table or a file could not be created.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReportError {
    /// The drawing backend refused an element.
    #[error("figure `{figure}` cannot be drawn: {reason}")]
    Draw {
        /// File stem of the figure.
        figure: String,
        /// The message of the backend.
        reason: String,
    },
    /// The page is too large, or has no area.
    #[error(
        "figure `{figure}` cannot be {width} by {height} pixels: draw fewer panels on one page"
    )]
    Size {
        /// File stem of the figure.
        figure: String,
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// An animation without frames.
    #[error("animation `{animation}` has no frames: draw at least one")]
    NoFrames {
        /// File stem of the animation.
        animation: String,
    },
    /// The frames of an animation are too large, or have no area.
    #[error(
        "animation `{animation}` cannot have {frames} frames of {width} by {height} pixels: draw fewer or smaller ones"
    )]
    AnimationSize {
        /// File stem of the animation.
        animation: String,
        /// Number of frames.
        frames: usize,
        /// Width in pixels.
        width: u64,
        /// Height in pixels.
        height: u64,
    },
    /// The picture could not be encoded.
    #[error("figure `{figure}` cannot be encoded: {reason}")]
    Encode {
        /// File stem of the figure.
        figure: String,
        /// The message of the encoder.
        reason: String,
    },
    /// A row of a table does not match its columns.
    #[error("row {row} of the table has {found} values for {expected} columns")]
    Row {
        /// Row, counted from 0.
        row: usize,
        /// Values in the row.
        found: usize,
        /// Number of columns.
        expected: usize,
    },
    /// A table could not be written as CSV.
    #[error("the table cannot be written as CSV: {0}")]
    Csv(#[from] csv::Error),
    /// A table could not be written as a NumPy archive.
    #[error("the table cannot be written as a NumPy archive: {0}")]
    Npz(#[from] zip::result::ZipError),
    /// A value could not be written as JSON.
    #[error("the value cannot be written as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// A file or a folder could not be written.
    #[error("cannot write `{}`: {source}", path.display())]
    File {
        /// The file or folder.
        path: PathBuf,
        /// The message of the operating system.
        source: std::io::Error,
    },
    /// Another scene has results of this name in the folder.
    #[error("`{}` has results of another scene called `{name}`: `{}`", folder.display(), other.display())]
    NameInUse {
        /// The name of both scenes.
        name: String,
        /// The folder.
        folder: PathBuf,
        /// The other scene.
        other: PathBuf,
    },
}

/// Whether every row has the expected number of values.
pub(crate) fn check_rows(rows: &[Vec<f64>], expected: usize) -> Result<(), ReportError> {
    let mut lengths = rows.iter().map(Vec::len).enumerate();
    match lengths.find(|(_, length)| *length != expected) {
        None => Ok(()),
        Some((row, found)) => Err(ReportError::Row {
            row,
            found,
            expected,
        }),
    }
}
