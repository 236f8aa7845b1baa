//! What the results of all analyses share when they are written: captions, drawings, provenance.

mod captions;
mod mechanism_drawing;
mod provenance;

pub(crate) use captions::{
    add_note, coordinate_axis, indeterminate_note, inner_range, range_caption,
    reaction_figure_count, separating_note,
};
pub use captions::{caption, chart, coordinate_label, figure, scene_caption, symbol};
pub use mechanism_drawing::MechanismDrawing;
pub(crate) use provenance::signed_gif;
pub use provenance::{provenance_line, signed_png};

use dwell_findings::Finding;
use dwell_report::Files;

/// The result of an analysis, in memory: nothing is written until the caller writes the files.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Outcome {
    /// Text to print.
    pub summary: String,
    /// Files to write, relative to the output folder.
    pub files: Files,
    /// Results of checks.
    pub findings: Vec<Finding>,
}
