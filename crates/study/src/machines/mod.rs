//! The machine of a scene, in the plane or in space, for the analyses that ask for what it does and not for what it is made of.

mod in_plane;
mod load_tables;
mod machine_scene;
mod scene_machine;

pub(crate) use load_tables::first_uncovered;
pub use machine_scene::{CoordinateOf, MachineScene, MotionStart};
pub use scene_machine::SceneMachine;
