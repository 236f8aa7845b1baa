//! `dwell export`: its options, and its request.

use crate::values::{Choices, choice, parse_finite, parse_table_accuracy};
use clap::Args;
use dwell_export::{FmiVersion, Precision, Request};
use dwell_report::TableFormat;
use dwell_study::{ExportRequest, ExportTarget};
use std::path::PathBuf;

const EXPORT_TARGETS: Choices<ExportTarget> = &[
    (
        "c",
        ExportTarget::C,
        "C99: a header and a source that need no library",
    ),
    (
        "rust",
        ExportTarget::Rust,
        "A crate without the standard library, allocation or unsafe code",
    ),
    (
        "fmu",
        ExportTarget::Fmu(FmiVersion::Three),
        "An FMU of FMI 3.0, for model exchange and co-simulation",
    ),
    (
        "fmu2",
        ExportTarget::Fmu(FmiVersion::Two),
        "The same of FMI 2.0",
    ),
    (
        "matlab",
        ExportTarget::Matlab,
        "A MAT-file, and functions for MATLAB and Octave",
    ),
    (
        "npz",
        ExportTarget::Rows(TableFormat::Npz),
        "The rows of `dwell reduce` as a NumPy archive",
    ),
    (
        "csv",
        ExportTarget::Rows(TableFormat::Csv),
        "The same as text",
    ),
    (
        "json",
        ExportTarget::Json,
        "The same as a list of name, unit and values of each column",
    ),
];

#[derive(Debug, Args)]
pub(crate) struct ExportArgs {
    /// The scene file, or `-` for standard input
    pub(crate) scene: PathBuf,
    /// The target
    #[arg(long, value_parser = choice(EXPORT_TARGETS), value_name = "TARGET")]
    pub(crate) to: ExportTarget,
    /// Accuracy of every function, relative to its largest value (default: 1e-9, or 1e-6 with --float)
    #[arg(long, value_parser = parse_table_accuracy, value_name = "ACCURACY", allow_hyphen_values = true)]
    accuracy: Option<f64>,
    /// Single precision; accuracies below 1e-6 have no effect
    #[arg(long)]
    float: bool,
    /// The model's own operations instead of cells, to `c` or `fmu`: exact to rounding, with square roots, sines and cosines. Not for
    /// loops that are closed by Newton's method
    #[arg(long, conflicts_with = "accuracy")]
    exact: bool,
    /// Lower end of the coordinate, in the scene's unit (default: a full period, or the range without 2 % at each end)
    #[arg(long, requires = "to_coordinate", value_parser = parse_finite, value_name = "COORDINATE", allow_hyphen_values = true)]
    from: Option<f64>,
    /// Upper end of the coordinate
    #[arg(long = "until", id = "to_coordinate", requires = "from", value_parser = parse_finite, value_name = "COORDINATE", allow_hyphen_values = true)]
    until: Option<f64>,
}

impl ExportArgs {
    /// The requested export.
    pub(crate) fn request(&self) -> ExportRequest {
        let (precision, accuracy) = if self.float {
            (Precision::Float, 1e-6)
        } else {
            (Precision::Double, 1e-9)
        };
        ExportRequest {
            request: Request {
                accuracy: self.accuracy.unwrap_or(accuracy),
                precision,
            },
            exact: self.exact,
            interval: self.from.zip(self.until),
        }
    }
}
