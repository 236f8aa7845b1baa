//! Common parts of the output of all analyses: captions, drawings, provenance.

mod captions;
mod distinct_names;
mod mechanism_drawing;
mod page_file;
mod pictures;
mod provenance;
mod results_page;
mod summary_file;

pub(crate) use captions::{
    add_note, coordinate_axis, indeterminate_note, inner_range, range_caption,
    reaction_figure_count, separating_note,
};
pub use captions::{chart, coordinate_label, figure, scene_caption, symbol};
pub(crate) use distinct_names::DistinctNames;
pub use mechanism_drawing::MechanismDrawing;
pub(crate) use mechanism_drawing::body_color;
pub use page_file::add_page;
pub use pictures::{Picture, PictureFormat, Pictures};
pub use provenance::provenance_line;
pub(crate) use results_page::add_results_page;
pub use summary_file::{CommandResult, add_summary};

use dwell_findings::{Finding, Record};
use dwell_page::Page;
use dwell_report::{Document, Files};

/// The result of an analysis, in memory: nothing is drawn until the caller [draws](Self::draw) the pictures, and nothing
/// is written until the caller writes the files.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outcome {
    /// Text to print.
    pub summary: String,
    /// The numbers in it, with all their digits.
    pub record: Record,
    /// Files to write, relative to the output folder.
    pub files: Files,
    /// Results of checks.
    pub findings: Vec<Finding>,
    /// The available pictures.
    pub pictures: Vec<Picture>,
    /// The page that shows the results and the pictures that are drawn, with its path.
    pub page: Option<(String, Document)>,
    /// Additional contents of its one-file HTML page: rows, peaks, the moving mechanism.
    pub run: Option<Box<Page>>,
}
