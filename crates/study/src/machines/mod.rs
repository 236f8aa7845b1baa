//! The machine of a scene, in the plane or in space, for the analyses that need its behaviour and not its parts.

mod in_plane;
mod load_tables;
mod machine_scene;
mod scene_machine;

pub(crate) use load_tables::first_uncovered;
pub use machine_scene::{CoordinateOf, MachineScene, MotionStart};
pub use scene_machine::SceneMachine;
