//! Computes the reduced parameters over the range, the unit-load response and the interpolation table.

mod curves;
mod known_reactions;
mod peak;
mod reduced_scene;
mod table;
mod unit_load_curves;

#[cfg(feature = "output")]
pub(crate) use curves::coefficient_table;
pub(crate) use curves::flat;
pub use curves::{ReducedCurves, Reduction, RoundingErrors};
pub(crate) use curves::{coefficient_units, inertia_units};
pub(crate) use peak::{Peak, fast_turns, peak_between_rows};
pub use reduced_scene::{InertiaAt, ReducedScene, TabulatedScene};
pub use table::{TableRequest, Tabulation, tabulate};
pub use unit_load_curves::UnitLoadCurves;
pub(crate) use unit_load_curves::reduced_loads;
