//! Errors with their locations in the scene file. All analyses use this module; it depends on none of them.

mod assembly;
mod contacts;
mod coupling;
mod labels;
mod load_table;
mod motion;
mod named_scene;
mod position;
mod study_error;
mod switching;

pub(crate) use assembly::{
    describe_gap, driven_labels, freedom_text, inconsistent, not_connected, not_one_actuator,
    wrong_actuators,
};
pub use assembly::{explain_machine, explain_model};
pub(crate) use coupling::{
    CONTINUITY_HELP, CoupledMechanism, CouplingLaw, discontinuous_coupling_error, jump_location,
    non_finite_coupling, non_finite_coupling_error, uncovered_coupling_error,
    uncovered_start_error,
};
pub use labels::scene_error;
pub(crate) use labels::{
    Labels, actuator_labels, body_labels, body_names, body_names_or_mechanism, joint_labels,
    joint_names, labels, missing_section_label, start_labels,
};
pub(crate) use load_table::{covers, off_table_error, table_of};
pub use motion::explain_motion;
pub(crate) use motion::{StepLimits, explain_any_motion, explain_max_steps};
pub use named_scene::NamedScene;
pub use position::explain_position;
pub(crate) use position::explain_position_in;
pub(crate) use position::{
    TABLE_HELP, describe_coordinate, describe_ends, describe_limit, own_coordinate, own_length,
    own_speed,
};
pub use study_error::{StudyError, SweepError};
pub(crate) use switching::explain_switching;
