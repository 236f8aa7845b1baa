//! Computes the points of a parameter sweep.

mod available;
mod axis;
mod design;
mod extremes;
mod family;
mod family_forces;
mod in_plane;
mod motions;
mod point;
mod random;
mod scene_results;
mod signals;
mod swept_scene;
mod table;
mod targets;
mod tied;

pub(crate) use available::IndexedReaction;
pub(crate) use axis::{Axis, VariationKind};
pub use design::Design;
pub use design::Shard;
pub(crate) use extremes::{ExtremeValues, RangeCurves};
pub(crate) use family::AffineNumbers;
pub use family::VariantFamily;
pub(crate) use motions::NamedUnit;
pub use point::{RequestedQuantities, Results};
pub(crate) use point::{ResultKind, Row};
pub(crate) use random::{normal, uniform};
pub(crate) use scene_results::result_names;
pub(crate) use signals::{signal_along, signal_of};
pub use swept_scene::SweptScene;
#[cfg(feature = "output")]
pub(crate) use table::block_length;
pub(crate) use table::compute_rows;
pub use table::{ComputedSweep, SweepRequest, compute_request, compute_sweep};
#[cfg(feature = "output")]
pub(crate) use {point::LEFT_OUT, point::PointResult, point::SweepQuantity};
