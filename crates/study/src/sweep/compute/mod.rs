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
mod swept_scene;
mod table;

pub(crate) use available::{Available, IndexedReaction};
pub(crate) use axis::Axis;
pub use design::Design;
pub use design::Shard;
pub(crate) use extremes::RangeCurves;
pub use family::VariantFamily;
pub(crate) use motions::{NamedUnit, STATISTICS, cycle_quantities, cycle_values, statistics};
pub use point::{RequestedQuantities, Results};
pub(crate) use point::{ResultKind, Row};
pub(crate) use random::{normal, uniform};
pub use swept_scene::SweptScene;
#[cfg(feature = "output")]
pub(crate) use table::block_length;
pub use table::{ComputedSweep, compute_sweep};
#[cfg(feature = "output")]
pub(crate) use {axis::VariationKind, point::PointResult, point::SweepQuantity};
