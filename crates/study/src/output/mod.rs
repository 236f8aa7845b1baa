//! What the results of all analyses share when they are written: captions, drawings, provenance.

#[cfg(feature = "output")]
mod captions;
#[cfg(feature = "output")]
mod mechanism_drawing;
#[cfg(feature = "output")]
mod outcome;
#[cfg(feature = "output")]
mod provenance;

#[cfg(feature = "output")]
pub(crate) use captions::{
    add_note, inner_range, range_caption, reaction_figure_count, reduced_provenance,
};
#[cfg(feature = "output")]
pub use captions::{caption, coordinate_label, scene_caption, symbol};
#[cfg(feature = "output")]
pub use mechanism_drawing::MechanismDrawing;
#[cfg(feature = "output")]
pub use outcome::Outcome;
#[cfg(feature = "output")]
pub(crate) use provenance::signed_gif;
#[cfg(feature = "output")]
pub use provenance::{provenance_line, signed_png};
