//! What a page shows of a run.

use crate::drawing::Drawing;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use dwell_findings::{Finding, RecordedEvent, RecordedNumber};
use serde::Serialize;

/// A run of a command. What a command does not have stays empty, and the page leaves it out.
///
/// There is no date in it: the same run has the same page.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Page {
    /// The heading: the title of the scene.
    pub title: String,
    /// The name of the command.
    pub command: String,
    /// What was computed, in a line, such as `361 positions over one revolution of phi`.
    pub subtitle: String,
    /// A remark that is shown with all results.
    pub note: Option<String>,
    /// The scene.
    pub scene: Option<PageScene>,
    /// The version of the program.
    pub version: String,
    /// How the numbers were computed: method and tolerance, or how they were evaluated.
    pub method: String,
    /// What the scene calls its angles and lengths; everything in a page is in SI.
    pub units: Vec<DisplayUnit>,
    /// The column of the independent coordinate or time; none where there are no rows.
    pub axis: Option<usize>,
    /// The columns, of equal lengths.
    pub columns: Vec<PageColumn>,
    /// What is to be said about the rows, such as that only some of them are here.
    pub rows_note: Option<String>,
    /// The mechanism.
    pub drawing: Option<Drawing>,
    /// The extrema of the columns.
    pub peaks: Vec<Peak>,
    /// What is to be said about all of them.
    pub peaks_note: Option<String>,
    /// The results of checks.
    pub findings: Vec<Finding>,
    /// Warnings and errors, in full.
    pub messages: Vec<PageMessage>,
    /// What the command prints.
    pub printed: String,
    /// The printed numbers, with all their digits.
    pub numbers: Vec<RecordedNumber>,
    /// The events of a motion.
    pub events: Vec<RecordedEvent>,
    /// Tables of text.
    pub tables: Vec<PageTable>,
    /// Pictures, where there are no rows to draw curves of.
    pub pictures: Vec<FileLink>,
    /// Files beside the page.
    pub files: Vec<FileLink>,
}

/// The scene of a run.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct PageScene {
    /// Its name, which the names of its files begin with.
    pub name: String,
    /// Its text.
    pub text: String,
    /// The hash of its text, 64 hexadecimal digits.
    pub sha256: String,
}

/// A unit in which numbers of one unit of SI are shown.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DisplayUnit {
    /// The unit of SI: `rad` or `m`.
    pub si: String,
    /// The unit of the scene, such as `deg` or `mm`.
    pub unit: String,
    /// A number of SI times this is one in the unit of the scene.
    pub factor: f64,
}

/// Numbers along the rows.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct PageColumn {
    /// Its name in tables: no other column has it.
    pub key: String,
    /// The same for people.
    pub label: String,
    /// Its unit, of SI; empty where it has none.
    pub unit: String,
    /// What belongs in one chart, such as `Reactions`.
    pub group: String,
    /// What it is.
    pub description: String,
    /// By row; NaN where there is no value. They are in the block of numbers, not in the description.
    #[serde(skip)]
    pub values: Vec<f64>,
}

impl PageColumn {
    /// A column that is labelled by its key.
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

/// The smallest and the largest value of a column, also where they are between two rows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peak {
    /// The column.
    pub column: usize,
    /// The smallest and the largest value, each with the value of the axis where it is.
    pub ends: [[f64; 2]; 2],
    /// The estimated error of the values, where one is known.
    pub error: Option<f64>,
}

/// What a command says beside its results.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct PageMessage {
    /// `error` or `warning`.
    pub severity: String,
    /// The message.
    pub text: String,
    /// What to try.
    pub help: Option<String>,
    /// Where in the scene's text: first byte and number of bytes.
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

/// A file beside the page, which is linked, never loaded; or a picture in it.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize)]
pub struct FileLink {
    /// The path from the page, or what is in the file.
    pub path: String,
    /// What it is.
    pub title: String,
}

impl FileLink {
    /// A PNG that the page holds itself.
    pub fn embedded_png(title: &str, file: &[u8]) -> Self {
        Self {
            path: format!("data:image/png;base64,{}", STANDARD.encode(file)),
            title: title.to_owned(),
        }
    }
}
