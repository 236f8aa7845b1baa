//! What the results of all analyses share when they are written: captions, drawings, provenance.

mod captions;
mod mechanism_drawing;
mod outcome;
mod provenance;

pub(crate) use captions::{
    add_note, coordinate_axis, indeterminate_note, inner_range, range_caption,
    reaction_figure_count, reduced_provenance, separating_note,
};
pub use captions::{caption, chart, coordinate_label, figure, scene_caption, symbol};
pub use mechanism_drawing::MechanismDrawing;
pub use outcome::Outcome;
pub(crate) use provenance::signed_gif;
pub use provenance::{provenance_line, signed_png};
