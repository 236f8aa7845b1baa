//! Computes the points of a parameter sweep.

mod axis;
mod design;
mod extremes;
mod family;
mod motions;
mod point;
mod random;
mod table;

pub(crate) use axis::Axis;
pub(crate) use design::Design;
pub use design::Shard;
pub(crate) use family::VariantFamily;
pub(crate) use point::{RequestedQuantities, Row};
pub(crate) use random::{normal, uniform};
#[cfg(feature = "output")]
pub(crate) use table::block_length;
pub use table::{ComputedSweep, compute_sweep};
#[cfg(feature = "output")]
pub(crate) use {axis::VariationKind, point::PointResult, point::SweepQuantity};
