//! Computes the points of a parameter sweep.

mod axis;
mod design;
mod point;
mod random;
mod table;

pub(crate) use axis::{Axis, VariationKind, heading};
pub(crate) use design::Design;
pub use design::Shard;
pub(crate) use point::{PointResult, RequestedQuantities, SweepQuantity};
pub(crate) use random::{normal, uniform};
pub use table::{ComputedSweep, compute_sweep};
