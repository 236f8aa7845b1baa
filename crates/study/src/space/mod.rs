//! Scenes of mechanisms in space: their contents, their reduced parameters, and their analyses.

mod assembled;
mod check;
mod contents;
mod explain;
mod export;
mod machine_scene;
mod motion;
#[cfg(feature = "output")]
mod pictures;
mod prepared;
mod study_scene;
mod sweep;
mod trajectory;
mod unit_runs;
mod views;

#[cfg(feature = "output")]
pub use pictures::figure_of_positions;
pub use prepared::{PreparedSpaceScene, model_with_loads};
