//! Scenes of mechanisms in space: what can be said of them before they move, and their reduced parameters.

mod check;
mod contents;
mod explain;
mod export;
mod machine_scene;
mod motion;
#[cfg(feature = "output")]
mod pictures;
mod prepared;
mod reduction;
mod sweep;
mod trajectory;
mod unit_runs;
mod views;

#[cfg(feature = "output")]
pub use check::check_in_space;
pub use check::describe_scene_in_space;
pub use export::compute_export_in_space;
#[cfg(feature = "output")]
pub use export::export_in_space;
#[cfg(feature = "output")]
pub use motion::simulate_in_space;
pub use motion::{
    FreeMotionInSpace, compute_free_motion_in_space, compute_period_in_space,
    free_motion_page_in_space,
};
#[cfg(feature = "output")]
pub use pictures::{mechanism_figure_in_space, reduce_in_space};
pub use prepared::{PreparedSpaceScene, loaded_model_in_space};
pub use reduction::{compute_reduction_in_space, reduction_page_in_space};
#[cfg(feature = "output")]
pub use trajectory::analyse_in_space;
pub use trajectory::{compute_trajectory_in_space, trajectory_page_in_space};
