//! Computes the points of a parameter sweep.

mod axis;
mod design;
mod point;
mod random;
mod spread;
mod table;

pub(crate) use axis::{Axis, heading};
pub(crate) use design::Design;
pub use design::Shard;
pub(crate) use point::{PointResult, RequestedQuantities, SweepQuantity};
pub(crate) use random::{normal, uniform};
pub(crate) use spread::Spread;
pub use table::{SweepTable, compute_sweep};
