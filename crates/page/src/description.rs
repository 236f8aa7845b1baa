//! The contents of a page.

use crate::drawing::Drawing;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use dwell_findings::{Finding, RecordedEvent, RecordedNumber};
use serde::Serialize;

/// A run of a command. Empty parts are omitted from the page.
///
/// It contains no date: equal runs have equal pages.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    /// The heading: the title of the scene.
    pub title: String,
    /// The name of the command.
    pub command: String,
    /// The computation in one line, such as `361 positions over one revolution of phi`.
    pub subtitle: String,
    /// A remark that is shown with all results.
    pub note: Option<String>,
    /// The scene.
    pub scene: Option<PageScene>,
    /// The version of the program.
    pub version: String,
    /// The method of computation: integrator and tolerance, or the kind of evaluation.
    pub method: String,
    /// The scene's units of angles and lengths; the numbers of a page are in SI units.
    pub units: Vec<DisplayUnit>,
    /// The column of the independent coordinate or time; `None` without rows.
    pub axis: Option<usize>,
    /// The columns, of equal lengths.
    pub columns: Vec<PageColumn>,
    /// A remark about the rows, such as that only some are included.
    pub rows_note: Option<String>,
    /// The mechanism.
    pub drawing: Option<Drawing>,
    /// The extrema of the columns.
    pub peaks: Vec<Peak>,
    /// A remark about the extrema.
    pub peaks_note: Option<String>,
    /// The results of checks.
    pub findings: Vec<Finding>,
    /// Warnings and errors, in full.
    pub messages: Vec<PageMessage>,
    /// The printed summary.
    pub printed: String,
    /// The printed numbers, with all their digits.
    pub numbers: Vec<RecordedNumber>,
    /// The events of a motion.
    pub events: Vec<RecordedEvent>,
    /// Tables of text.
    pub tables: Vec<PageTable>,
    /// Pictures, if there are no rows for curves.
    pub pictures: Vec<FileLink>,
    /// Files beside the page.
    pub files: Vec<FileLink>,
}

/// The scene of a run.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct PageScene {
    /// Its name: the base name of its files.
    pub name: String,
    /// Its text.
    pub text: String,
    /// The hash of its text, 64 hexadecimal digits.
    pub sha256: String,
}

/// A unit in which numbers of an SI unit are displayed.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DisplayUnit {
    /// The SI unit: `rad` or `m`.
    pub si: String,
    /// The unit of the scene, such as `deg` or `mm`.
    pub unit: String,
    /// Conversion factor from SI to the unit of the scene.
    pub factor: f64,
}

/// A column of numbers.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct PageColumn {
    /// Its unique name in tables.
    pub key: String,
    /// Its label in the page.
    pub label: String,
    /// Its SI unit; empty without unit.
    pub unit: String,
    /// The chart to which it belongs, such as `Reactions`.
    pub group: String,
    /// Its description.
    pub description: String,
    /// By row; NaN without value. They are stored in the block of numbers, not in the description.
    #[serde(skip)]
    pub values: Vec<f64>,
}

impl PageColumn {
    /// A column with its key as label.
    pub fn new(key: impl Into<String>, unit: impl Into<String>, values: Vec<f64>) -> Self {
        let key = key.into();
        Self {
            label: key.clone(),
            key,
            unit: unit.into(),
            values,
            ..Self::default()
        }
    }
}

/// The smallest and the largest value of a column, which may lie between two rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// The column.
    pub column: usize,
    /// The smallest and the largest value, each with the abscissa where it occurs.
    pub ends: [[f64; 2]; 2],
    /// The estimated error of the values, if known.
    pub error: Option<f64>,
}

/// A message of a command.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct PageMessage {
    /// `error` or `warning`.
    pub severity: String,
    /// The message.
    pub text: String,
    /// A suggestion.
    pub help: Option<String>,
    /// Its place in the scene's text: first byte and number of bytes.
    pub span: Option<[usize; 2]>,
}

/// A table of text.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct PageTable {
    /// Its heading.
    pub title: String,
    /// The names of its columns.
    pub header: Vec<String>,
    /// Its rows.
    pub rows: Vec<Vec<String>>,
}

/// A file beside the page, which is linked but not loaded; or an embedded picture.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct FileLink {
    /// The path relative to the page, or the embedded file.
    pub path: String,
    /// Its description.
    pub title: String,
}

impl FileLink {
    /// A PNG embedded in the page.
    pub fn embedded_png(title: &str, file: &[u8]) -> Self {
        Self {
            path: format!("data:image/png;base64,{}", STANDARD.encode(file)),
            title: title.to_owned(),
        }
    }
}
