//! The compiled models of a scene, which the analyses share.

mod compile;
mod drives;
mod prepared_scene;
mod solver_settings;

pub use compile::{
    build_machine, compile_model, indeterminate_reactions, loaded_model, machine_with_laws,
    pruned_machine, reduced_model, with_drive_loads,
};
pub(crate) use compile::{
    coordinate_modes, determinate_model, end_stops, exact_model, lists_reactions,
    loaded_determinate_model, requested_reaction_bodies, requested_reactions, with_loads,
};
pub(crate) use drives::{drive_states, motor_columns, motor_of};
pub use prepared_scene::PreparedScene;
pub(crate) use prepared_scene::initial_reduced_state;
pub use solver_settings::{PRESETS, SolverSettings};
